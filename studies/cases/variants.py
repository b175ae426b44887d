"""One factor at a time: from the best setting of an engine, and from its library's defaults."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

from engines import ENGINES
from engines.declaration import AT_REST
from engines.parts.factors import (
    AS_BEST,
    BEST,
    BOTH,
    BY_DEFAULT,
    DEFAULT,
    LEFT_OUT,
    OWN_STEP,
    OWN_STEPS,
    Factor,
)

STILL = f"{OWN_STEP}, on a base at rest"
"""The defaults at their own step once more, in the other frame."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """One way to set an engine: a preset and what differs from it.

    Attributes
    ----------
    engine, preset : str
    factor, level : str
        What differs, and how; of a preset as it is no factor, and its title.
    settings, scene : mapping
        Settings of the engine, and options of the `Scene`, that replace the preset's.
    trap : str
        Why it goes wrong without a word, where it does.
    """

    engine: str
    preset: str
    factor: str
    level: str
    settings: Mapping[str, Any] = field(default_factory=dict)
    scene: Mapping[str, Any] = field(default_factory=dict)
    trap: str = ""

    @property
    def source(self) -> str:
        """Who is asked: the engine's preset."""
        return f"{self.engine}:{self.preset}"

    @property
    def name(self) -> str:
        """The factor and its value."""
        return f"{self.factor}: {self.level}" if self.factor else self.level


def variants(engine: str) -> Iterator[Variant]:
    """Yield every way to set an engine, each preset as it is before what differs from it."""
    declared = ENGINES[engine]
    presets = {preset.name: preset.title for preset in declared.presets}
    for name in [name for name in presets if name not in (*BOTH, AT_REST)]:
        yield Variant(engine=engine, preset=name, factor="", level=presets[name])
        yield from _left_out(engine, name)
    for name in [name for name in BOTH if name in presets]:
        yield Variant(engine=engine, preset=name, factor="", level=presets[name])
        if name == DEFAULT:
            own = Variant(engine=engine, preset=name, factor=OWN_STEPS, level=OWN_STEP)
            yield own
            if declared.preset(name).frame == "world":
                yield replace(own, level=STILL, scene={"frame": "base"})
        for factor_ in declared.factors:
            if set(BOTH) <= presets.keys():
                yield from _exchanged(engine, name, factor_)
            yield from _levels(engine, name, factor_)


def preset_values(engine: str, preset: str, names: Sequence[str]) -> dict[str, Any]:
    """Return what a preset of an engine sets the named settings to.

    Parameters
    ----------
    engine, preset : str
    names : sequence of str
        Fields of the engine's settings, as `Factor.settings` names them.

    Returns
    -------
    dict
        Name -> value, in the unit of that setting.

    Raises
    ------
    AttributeError
        If the engine has no such setting.
    """
    chosen = ENGINES[engine].preset(preset).settings
    return {name: getattr(chosen, name) for name in names}


def _exchanged(engine: str, preset: str, factor: Factor) -> Iterator[Variant]:
    other = DEFAULT if preset == BEST else BEST
    wanted = preset_values(engine, other, factor.settings)
    if wanted == preset_values(engine, preset, factor.settings):
        return
    if preset == DEFAULT or factor.by_default:
        yield Variant(
            engine=engine,
            preset=preset,
            factor=factor.name,
            level=AS_BEST if preset == DEFAULT else BY_DEFAULT,
            settings=wanted,
            trap=factor.traps.get(preset, ""),
        )


def _left_out(engine: str, preset: str) -> Iterator[Variant]:
    for help_, settings in ENGINES[engine].preset(preset).helped_by.items():
        if settings is not None:
            level = help_.name.lower()
            yield Variant(
                engine=engine, preset=preset, factor=LEFT_OUT, level=level, settings=settings
            )


def _levels(engine: str, preset: str, factor: Factor) -> Iterator[Variant]:
    for item in factor.levels:
        if preset in item.presets:
            yield Variant(
                engine=engine,
                preset=preset,
                factor=factor.name,
                level=item.name,
                settings=item.settings,
                scene=item.scene,
                trap=item.trap,
            )
