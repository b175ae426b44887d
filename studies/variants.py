"""One factor at a time: from the best setting of an engine, and from its library's defaults."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from importlib import import_module
from typing import Any

from engines import ENGINES

BEST, DEFAULT = "fixed", "naive"
"""The presets from which one factor at a time is varied."""

AS_BEST, BY_DEFAULT = "as in the best", "default"
"""Names of the values that the presets take from each other."""

ROUGH: dict[str, Any] = {"friction": 1.0}
"""What the defaults are given here besides: with PyBullet's own friction, 0.5, a block of H/B = 2
slides before it rocks, and no setting of its contact would show."""

OWN_STEP = "step: the library's own"

Settings = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Level:
    """A value of a factor.

    Attributes
    ----------
    name : str
    settings : mapping
        Settings of the engine.
    presets : tuple of str
        From which it is tried.
    trap : str
        Why it goes wrong without a word, where it does.
    scene : mapping
        Options of the scene.
    """

    name: str
    settings: Settings
    presets: tuple[str, ...] = (BEST,)
    trap: str = ""
    scene: Settings = field(default_factory=dict)


def level(name: str, presets: tuple[str, ...] = (BEST,), trap: str = "", **settings: Any) -> Level:
    """Return a value of a factor that is a matter of the engine's settings alone."""
    return Level(name=name, settings=settings, presets=presets, trap=trap)


@dataclass(frozen=True, slots=True, kw_only=True)
class Factor:
    """Settings that belong together, and what they could be.

    Each of the two presets is tried with the other's values of them, where these differ, and with
    the levels.

    Attributes
    ----------
    name : str
    settings : tuple of str
        Their names.
    levels : tuple of Level
    by_default : bool
        Whether to try the best setting with the library's default of them.
    traps : mapping
        Preset -> why it goes wrong with the other's values, where it does.
    """

    name: str
    settings: tuple[str, ...]
    levels: tuple[Level, ...] = ()
    by_default: bool = True
    traps: Mapping[str, str] = field(default_factory=dict)


@dataclass(frozen=True, slots=True, kw_only=True)
class Variant:
    """One way to set an engine: a preset and what differs from it; factor is empty if nothing."""

    engine: str
    preset: str
    factor: str
    level: str
    settings: Settings = field(default_factory=dict)
    scene: Settings = field(default_factory=dict)
    trap: str = ""

    @property
    def name(self) -> str:
        """The factor and its value."""
        return f"{self.factor}: {self.level}" if self.factor else self.level


def variants(engine: str, factors: Sequence[Factor]) -> Iterator[Variant]:
    """Yield every way to set an engine, each preset as it is before what differs from it.

    The library's defaults are rough, lest blocks slide, wherever friction is not what differs.
    """
    for variant in _plain_variants(engine, factors):
        if variant.preset == DEFAULT:
            yield replace(variant, settings={**ROUGH, **variant.settings})
        else:
            yield variant


def _plain_variants(engine: str, factors: Sequence[Factor]) -> Iterator[Variant]:
    names = {BEST: "best at a fixed step", DEFAULT: "the library's defaults, friction 1"}
    yield Variant(engine=engine, preset="landing", factor="", level="steps that land on impacts")
    for preset, name in names.items():
        yield Variant(engine=engine, preset=preset, factor="", level=name)
        if preset == DEFAULT:
            factor, _, own = OWN_STEP.partition(": ")
            yield Variant(engine=engine, preset=preset, factor=factor, level=own)
        for factor_ in factors:
            yield from _exchanged(engine, preset, factor_)
            yield from _levels(engine, preset, factor_)


def preset_values(engine: str, preset: str, names: Sequence[str]) -> dict[str, Any]:
    """Return what a preset of an engine sets the named settings to."""
    chosen = import_module(ENGINES[engine]).PRESETS[preset]
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
