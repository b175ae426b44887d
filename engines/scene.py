"""What is simulated: bodies on a shaken base, and how."""

import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from difflib import get_close_matches
from types import MappingProxyType
from typing import Any, TypeVar

from analytic.checks import finite, positive, sized
from analytic.motion import SEGMENT_COLUMNS, Motion
from engines.layouts import Body, Layout, System, layout_of

FRAMES = ("base", "world")
"""Where the base moves: not at all, its motion being a body force, or in the world."""

MOST_HALF_CYCLES = 10**6
"""Half cycles of which an engine's process holds the times in half a GB."""
ACCURACIES = {"loose": 40, "standard": 200, "tight": 800}
"""Name of an accuracy -> ordinary steps in a time 1/p, where steps are not all equal."""

GEOMETRIES = ("box", "corners", "hull")
"""What touches the base: the whole block, small spheres at its corners, or the whole block as the
convex hull of its corners."""

SettingsT = TypeVar("SettingsT")


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Bodies on one shaken base, and how they are to be simulated.

    Parameters
    ----------
    system : RigidBlock, or another of `engines.layouts.LAYOUTS`
        What stands on the base. Its restitution is not used: the impact is the engine's own.
    motion : Motion
        Horizontal motion of the base.
    start : pair of float, optional
        theta [rad] and theta' [rad/s] at t = 0; by default the block is at rest. A block that
        leans stands on its corner on the side of its lean; upright, it turns about the corner
        towards which it moves.
    preset : str or None, optional
        Name of one of the engine's presets; its best by default.
    accuracy : str, optional
        One of `ACCURACIES`, for presets whose steps land on impacts or are the engine's own.
    frame : str, optional
        "base": the base is at rest and the block carries the body force -m u_g''; "world": the
        base moves. By default as the preset does it.
    density : float, optional
        [kg/m3].
    depth : float, optional
        Size of the block out of the plane [m]; its width by default.
    friction : float, optional
        Coefficient between block and base; by default the system's, where it has one, or the
        preset's. Where it is 0 the block is meant to slide, and a slide is no failure.
    step : float, optional
        p dt, the ordinary step in units of 1/p; the preset's by default.
    duration : float, optional
        Observe until this time [s], at least the motion's own duration. By default the
        observation ends as soon as peak and outcome are decided.
    times : sequence of float, optional
        Increasing ground times [s] at which the response is sampled, as long as it is observed.
    time_limit_s : float, optional
        Wall-clock time after which a run is given up.
    max_steps : int, optional
        Number of steps after which a run is given up.
    settings : mapping, optional
        Settings of the engine by name that replace those of the preset.
    compiled : bool, optional
        Step from a compiled loop where the engine has one; else each step from Python. Both give
        the same response to the bit.

    Raises
    ------
    ValueError
        If a value is not allowed; the message says what is.

    Examples
    --------
    >>> from analytic import RigidBlock, SinePulse
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> scene = Scene(system=block, motion=SinePulse.in_g(0.4, omega=6.0))
    >>> len(scene.bodies), scene.accuracy
    (1, 'standard')
    """

    system: System
    motion: Motion
    start: tuple[float, float] = (0.0, 0.0)
    preset: str | None = None
    accuracy: str = "standard"
    frame: str | None = None
    density: float = 1000.0
    depth: float | None = None
    friction: float | None = None
    step: float | None = None
    duration: float | None = None
    times: Sequence[float] | None = None
    time_limit_s: float | None = None
    max_steps: int = 5_000_000
    settings: Mapping[str, Any] = field(default_factory=dict)
    compiled: bool = True

    def __post_init__(self) -> None:
        one_of("accuracy", self.accuracy, tuple(ACCURACIES))
        if (count := getattr(self.motion, "half_cycles", 1)) > MOST_HALF_CYCLES:
            allowed = f"at most {MOST_HALF_CYCLES}, as an engine holds the times of all in memory"
            raise ValueError(f"half_cycles is {count!r}; it must be {allowed}")
        if self.frame is not None:
            one_of("frame", self.frame, FRAMES)
        for name in ("density", "depth", "step", "time_limit_s", "max_steps"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive(name, getattr(self, name)))
        object.__setattr__(self, "start", self._checked_start(self.start))
        if self.friction is None:
            object.__setattr__(self, "friction", getattr(self.system, "friction", None))
        else:
            object.__setattr__(self, "friction", _not_negative("friction", self.friction))
        object.__setattr__(self, "max_steps", int(self.max_steps))
        if self.duration is not None:
            object.__setattr__(self, "duration", self._checked_duration(self.duration))
        if self.times is not None:
            object.__setattr__(self, "times", _increasing("times", self.times))
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    def _checked_start(self, start: Sequence[float]) -> tuple[float, float]:
        try:
            theta, rate = start
        except (TypeError, ValueError):
            words = "it must be theta [rad] and theta' [rad/s]"
            raise ValueError(f"start is {start!r}; {words}") from None
        theta, rate = sized("theta of the start", theta), sized("rate of the start", rate)
        if not layout_of(self.system, self.density, self.depth, (theta, rate)).rocking:
            return theta, rate  # of what slides: place [m] and velocity [m/s]
        if abs(theta) >= 0.5 * math.pi:
            words = "it must be between -pi/2 and pi/2 rad"
            raise ValueError(f"theta of the start is {theta!r}; {words}")
        if abs(theta) == self.system.alpha and rate == 0.0 and not _moves(self.motion):
            words = "it must not be the unstable equilibrium where nothing moves"
            raise ValueError(f"start is {start!r}; {words}")
        return theta, rate

    def _checked_duration(self, value: float) -> float:
        duration = finite("duration", value)
        if duration < self.motion.duration:
            raise ValueError(
                f"duration is {value!r}; it must be at least the motion's {self.motion.duration!r}"
            )
        return duration

    @property
    def layout(self) -> Layout:
        """Which bodies there are, what touches what, and which of them rock."""
        return layout_of(self.system, self.density, self.depth, self.start)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The bodies, in the order of a world's state."""
        return self.layout.bodies

    @property
    def side(self) -> float:
        """Corner about which what rocks turns at first: -1 or 1, or 0 if it is at rest."""
        theta, rate = self.start
        turns = self.layout.rocking and (theta or rate)
        return math.copysign(1.0, theta or rate) if turns else 0.0

    def choose(self, settings: SettingsT) -> SettingsT:
        """Return an engine's settings with this scene's own in their place.

        Raises
        ------
        ValueError
            If a setting is not one of the engine's.
        """
        names = [item.name for item in fields(settings)]  # type: ignore[arg-type]
        for name in self.settings:
            one_of("setting", name, names)
        chosen = dict(self.settings)
        if self.friction is not None:
            chosen["friction"] = self.friction
        return replace(settings, **chosen)  # type: ignore[type-var]


LIKENESS = 0.7
"""How like another word one must be for it to be named as what was meant."""


def one_of(name: str, value: str, allowed: Sequence[str]) -> None:
    """Raise ValueError unless `value` is one of those allowed.

    Parameters
    ----------
    name : str, what the value is of, for the message
    value : str
    allowed : sequence of str; the message names them, and before them one that is like the value
    """
    if value not in allowed:
        near = perhaps(value, allowed)
        raise ValueError(f"{name} is {value!r}{near}; it must be one of {', '.join(allowed)}")


def perhaps(value: str, allowed: Sequence[str]) -> str:
    """Return the words that name the one of those allowed which a value is like, if one is."""
    near = get_close_matches(str(value).lower(), allowed, 1, LIKENESS)
    return f", perhaps {near[0]!r}" if near else ""


def _moves(motion: Motion) -> bool:
    accelerating = [SEGMENT_COLUMNS.index(name) for name in ("amplitude", "offset", "slope")]
    return bool(motion.segments()[:, accelerating].any())


def _not_negative(name: str, value: float) -> float:
    if finite(name, value) < 0.0:
        raise ValueError(f"{name} is {value!r}; it must not be negative")
    return finite(name, value)


def _increasing(name: str, values: Sequence[float]) -> tuple[float, ...]:
    times = tuple(finite(name, value) for value in values)
    if not times or times[0] < 0.0 or any(b <= a for a, b in itertools.pairwise(times)):
        raise ValueError(f"{name} is {values!r}; they must increase from 0 or later")
    return times
