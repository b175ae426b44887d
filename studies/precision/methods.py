"""Every method that yields a peak, each along the setting that trades time for accuracy."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

from engines import ENGINES
from engines.declaration import Preset
from studies.measures.presets import uses_of


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
        What the open option runs through, from cheap to dear; a step is p dt.
    of_engine : bool
        Whether the setting is one of an engine's own.
    options : mapping
        The other options.
    """

    source: str
    setting: str = ""
    values: tuple[float, ...] = (0.0,)
    of_engine: bool = False
    options: Mapping[str, Any] = field(default_factory=dict)

    @property
    def stepping(self) -> bool:
        """Whether the setting is a step, of which the error is a power."""
        return self.setting == "step"

    def options_at(self, value: float) -> dict[str, Any]:
        """Return the options with the open one at a value."""
        if not self.setting:
            return dict(self.options)
        if self.of_engine:
            whole = int(value) if float(value).is_integer() else value
            return {**self.options, "settings": {self.setting: whole}}
        return {**self.options, self.setting: value}


TOLERANCES = tuple(10.0**-n for n in range(2, 13))
STEPS = (0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)
ENGINE_STEPS = (0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4)
ITERATIONS = (2.0, 5.0, 10.0, 50.0, 200.0)


def _along_step(source: str, event_tolerance: float) -> Method:
    options = {"event_tolerance": event_tolerance}
    return Method(source=source, setting="step", values=STEPS, options=options)


def _of_preset(engine: str, preset: Preset) -> Method:
    setting, values = preset.accuracy_knob or ("step", ENGINE_STEPS)
    source, own = f"{engine}:{preset.name}", preset.accuracy_knob is not None
    return Method(source=source, setting=setting, values=values, of_engine=own)


def _of_iterations(engine: str, preset: Preset) -> Method:
    options, source = {"step": 1e-3}, f"{engine}:{preset.name}"
    return Method(
        source=source, setting="iterations", values=ITERATIONS, of_engine=True, options=options
    )


OF_NO_ENGINE = {
    "Taylor series": Method(
        source="exact", setting="tolerance", values=(*TOLERANCES, 1e-14, 1e-16)
    ),
    **{
        f"SciPy {name}": Method(source=name.lower(), setting="rtol", values=TOLERANCES)
        for name in ("RK45", "DOP853", "Radau", "LSODA")
    },
    "RK4": _along_step("rk4", 1e-13),
    "RK4, contact to 1e-6": _along_step("rk4", 1e-6),
    "average acceleration": _along_step("average-acceleration", 1e-13),
    **{
        f"{name}, closed form": Method(source=name)
        for name in ("housner", "modified", "onset-matched")
    },
}


def methods_of(engines: Iterable[str]) -> dict[str, Method]:
    """Return every method by its name, with the presets of some engines."""
    uses = [(engine, preset) for engine in engines for preset in uses_of(engine)]
    return {
        **OF_NO_ENGINE,
        **{f"{engine} {preset.name}": _of_preset(engine, preset) for engine, preset in uses},
        **{
            f"{engine} fixed, iterations": _of_iterations(engine, preset)
            for engine, preset in uses
            if preset.name == "fixed" and preset.takes(iterations=1)
        },
    }


METHODS = methods_of(ENGINES)
"""Name -> method, of all engines."""
