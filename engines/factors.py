"""What a contact can be set to: factors of an engine's presets, and values to try of each."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

BEST, DEFAULT = BOTH = ("tuned", "default")
"""The presets from which one factor at a time is varied."""

AS_BEST, BY_DEFAULT = "as in the best", "default"
"""Names of the values that these two take from each other."""

LEFT_OUT, OWN_STEPS, OWN_STEP = "left out", "step", "the library's own"
"""Factors of what a preset is helped by, without one of them at a time, and of the defaults at
their own step, its level; elsewhere the step is the same for all."""

Settings = Mapping[str, Any]


@dataclass(frozen=True, slots=True, kw_only=True)
class Level:
    """A value of a factor, tried from some presets; a trap says why it silently goes wrong."""

    name: str
    settings: Settings
    presets: tuple[str, ...] = (BEST,)
    trap: str = ""
    scene: Settings = field(default_factory=dict)


def level(name: str, presets: tuple[str, ...] = (BEST,), trap: str = "", **settings: Any) -> Level:
    """Return a value of a factor that is a matter of the engine's settings alone."""
    return Level(name=name, settings=settings, presets=presets, trap=trap)


@dataclass(frozen=True, slots=True)
class Factor:
    """Settings that belong together, and what they could be.

    Each of the two presets is tried with the other's values of them, the best one only if they are
    `by_default` to be tried so, and with the levels. traps: preset -> why it goes wrong with the
    other's values, where it does.
    """

    name: str
    settings: tuple[str, ...]
    levels: tuple[Level, ...] = ()
    by_default: bool = field(default=True, kw_only=True)
    traps: Mapping[str, str] = field(default_factory=dict, kw_only=True)


def factor(
    settings: str | tuple[str, ...], *levels: Level, name: str = "", **options: Any
) -> Factor:
    """Return a factor of one setting or more, called as the first; options are of `Factor`."""
    together = (settings,) if isinstance(settings, str) else settings
    return Factor(name or together[0].replace("_", " "), together, levels, **options)


def moving_base(*floors: str) -> Factor:
    """Return the factor of a base that moves, in ways of `floor`, first the tuned presets'."""
    unmoved = "a base without a velocity: friction does not feel it"
    levels = [
        Level(
            name="by position alone" if floor == "position" else f"by {floor}",
            settings={"floor": floor},
            trap=unmoved if floor == "position" else "",
            scene={"frame": "world"},
        )
        for floor in floors
    ]
    return factor("floor", *levels, name="moving base", by_default=False)


ASLEEP = factor(
    "sleeping",
    level("on", trap="a block asleep: gravity that turns wakes nothing", sleeping=True),
    by_default=False,
)
"""A block that was put to sleep, which tuned presets forbid (setting `sleeping`)."""
