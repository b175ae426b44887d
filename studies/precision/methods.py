"""Every method that yields a peak, each along the setting that trades time for accuracy."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

from engines import ENGINES, PRESETS


@dataclass(frozen=True, slots=True, kw_only=True)
class Method:
    """A source with one of its options left open.

    Attributes
    ----------
    source : str
        Name of the source.
    setting : str
        Name of the open option; empty for a model in closed form, which has none.
    values : tuple
        What the option runs through, from cheap to dear.
    stepping : bool
        Whether the setting is a step, of which the error is a power.
    options : mapping
        The other options.
    """

    source: str
    setting: str = ""
    values: tuple[float, ...] = (0.0,)
    stepping: bool = False
    options: Mapping[str, Any] = field(default_factory=dict)

    def options_at(self, value: float) -> dict[str, Any]:
        """Return the options with the open one at a value."""
        if not self.setting:
            return dict(self.options)
        if self.setting in ENGINE_SETTINGS:
            return {**self.options, "settings": {self.setting: int(value)}}
        return {**self.options, self.setting: value}


ENGINE_SETTINGS = ("iterations",)
"""Open options that are settings of an engine."""

TOLERANCES = tuple(10.0**-n for n in range(2, 13))
STEPS = (0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
ENGINE_STEPS = (0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)
ITERATIONS = (2.0, 5.0, 10.0, 50.0, 200.0)


def _along_step(source: str, **options: Any) -> Method:
    steps = STEPS if options else ENGINE_STEPS
    return Method(source=source, setting="step", values=steps, stepping=True, options=options)


METHODS = {
    "Taylor series": Method(
        source="exact", setting="tolerance", values=(*TOLERANCES, 1e-14, 1e-16)
    ),
    **{
        f"SciPy {name}": Method(source=name.lower(), setting="rtol", values=TOLERANCES)
        for name in ("RK45", "DOP853", "Radau", "LSODA")
    },
    "RK4": _along_step("rk4", event_tolerance=1e-13),
    "RK4, contact to 1e-6": _along_step("rk4", event_tolerance=1e-6),
    "average acceleration": _along_step("average-acceleration", event_tolerance=1e-13),
    **{
        f"{name}, closed form": Method(source=name)
        for name in ("housner", "modified", "onset-matched")
    },
    **{
        f"{engine} {preset}": _along_step(f"{engine}:{preset}")
        for engine in ENGINES
        for preset in PRESETS
    },
    **{
        f"{engine} fixed, iterations": Method(
            source=f"{engine}:fixed",
            setting="iterations",
            values=ITERATIONS,
            options={"step": 1e-3},
        )
        for engine in ENGINES
    },
}
"""Name -> method."""
