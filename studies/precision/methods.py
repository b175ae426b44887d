"""The methods of which error and run time are measured, each along one setting of its own."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from engines import ENGINES
from studies.measures.costs import EXACT
from studies.measures.presets import uses_of

TOLERANCES = tuple(10.0**-n for n in range(2, 13))
TIGHT = {"event_tolerance": 1e-13}
STEPS = (0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)


@dataclass(frozen=True, slots=True)
class Method:
    """A source with one of its options left open; `values` go from cheap to dear, a step is p dt.

    A model in closed form has none. `own` says whether it is among an engine's own settings.
    """

    source: str
    setting: str = ""
    values: tuple[float, ...] = (0.0,)
    options: Mapping[str, Any] = field(default_factory=dict)
    own: bool = False

    def options_at(self, value: float) -> dict[str, Any]:
        """Return the options with the open one at a value."""
        if self.own:
            whole = int(value) if float(value).is_integer() else value
            return {**self.options, "settings": {self.setting: whole}}
        return {**self.options, **({self.setting: value} if self.setting else {})}


PLAIN = {
    EXACT: Method("exact", "tolerance", (*TOLERANCES, 1e-14, 1e-16)),
    **{
        f"SciPy {name}": Method(name.lower(), "rtol", TOLERANCES)
        for name in ("RK45", "DOP853", "Radau", "LSODA")
    },
    "RK4": Method("rk4", "step", STEPS, TIGHT),
    "RK4, contact to 1e-6": Method("rk4", "step", STEPS, {"event_tolerance": 1e-6}),
    "average acceleration": Method("average-acceleration", "step", STEPS, TIGHT),
    **{f"{name}, closed form": Method(name) for name in ("housner", "modified", "onset-matched")},
}
"""Name -> method, of all that are no engines."""


def methods_of(sources: Iterable[str]) -> dict[str, Method]:
    """Return the methods of sources by their names; of an engine without a preset those of all."""
    names = list(sources)
    found = {name: method for name, method in PLAIN.items() if method.source in names}
    iterated = {}
    for engine, _, preset in (name.partition(":") for name in names):
        if engine not in ENGINES:
            continue
        for use in [ENGINES[engine].preset(preset)] if preset else uses_of(engine):
            source, knob = f"{engine}:{use.name}", use.accuracy_knob
            setting, values = knob or ("step", STEPS[1:-1])
            found[f"{engine} {use.name}"] = Method(source, setting, values, own=knob is not None)
            if use.name == "fixed" and use.takes(iterations=1):
                values = (2.0, 5.0, 10.0, 50.0, 200.0)
                method = Method(source, "iterations", values, {"step": 1e-3}, own=True)
                iterated[f"{engine} fixed, iterations"] = method
    return found | iterated


def known_methods() -> dict[str, Method]:
    """Return every method by its name, of all engines."""
    return methods_of([*(method.source for method in PLAIN.values()), *ENGINES])
