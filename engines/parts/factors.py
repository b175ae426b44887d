"""What the contact of an engine can be set to, in the library's own words: data for studies."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

BEST, DEFAULT = "fixed", "naive"
"""The presets from which one factor at a time is varied."""

AS_BEST, BY_DEFAULT = "as in the best", "default"
"""Names of the values that these two take from each other."""

LEFT_OUT = "left out"
"""Name of the factor of what a preset is helped by: without one of them at a time."""

OWN_STEPS, OWN_STEP = "step", "the library's own"
"""Factor and level of the defaults at their own step, which elsewhere is the same for all."""

BOTH = (BEST, DEFAULT)

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
    """Return a value of a factor that is a matter of the engine's settings alone.

    Parameters
    ----------
    name, presets, trap
        As of `Level`.
    **settings
        Settings of the engine by name.
    """
    return Level(name=name, settings=settings, presets=presets, trap=trap)


@dataclass(frozen=True, slots=True)
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
    by_default: bool = field(default=True, kw_only=True)
    traps: Mapping[str, str] = field(default_factory=dict, kw_only=True)


def factor(setting: str, *levels: Level, name: str = "", **options: Any) -> Factor:
    """Return a factor that is a matter of one setting.

    Parameters
    ----------
    setting : str, its name
    *levels : Level
    name : str, optional, of the factor; by default the setting's
    **options
        by_default and traps of `Factor`.
    """
    return Factor(name or setting.replace("_", " "), (setting,), levels, **options)


@dataclass(frozen=True, slots=True)
class Rule:
    """What a user of a library should do, and the variant of a preset that shows what it is worth.

    Attributes
    ----------
    words : str
        In the library's own words, as an order.
    preset, factor, level : str
        The variant, as a study of contacts calls it.
    kept : bool
        Whether it is the variant that keeps the rule, and the preset that does not.
    """

    words: str
    preset: str
    factor: str
    level: str
    kept: bool = False


UNMOVED = "a base without a velocity: friction does not feel it"

BY_POSITION = "by position alone"
MOVING_BASE = "moving base"
"""Name of the factor of how a base that moves is moved, and of the way that no friction feels."""


def moving_base(*floors: str) -> Factor:
    """Return the factor of a base that moves in the world, in ways of the setting `floor`.

    The first one is that of the tuned presets; "position" is the base moved by position alone.
    """
    levels = [
        Level(
            name=BY_POSITION if floor == "position" else f"by {floor}",
            settings={"floor": floor},
            trap=UNMOVED if floor == "position" else "",
            scene={"frame": "world"},
        )
        for floor in floors
    ]
    return Factor(MOVING_BASE, ("floor",), tuple(levels), by_default=False)


ASLEEP = Factor(
    "sleeping",
    ("sleeping",),
    (
        Level(
            name="on",
            settings={"sleeping": True},
            trap="a block asleep: gravity that turns wakes nothing",
        ),
    ),
    by_default=False,
)
"""A block that was put to sleep, which tuned presets forbid (setting `sleeping`)."""

SLEEP = (BEST, ASLEEP.name, ASLEEP.levels[0].name)
"""What a rule about it is shown by."""

UNMOVED_BASE = (BEST, MOVING_BASE, BY_POSITION)
"""What a rule about such a base is shown by."""
