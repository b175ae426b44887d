"""What is simulated, and the few calls a physics engine must answer."""

import enum
import itertools
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any, NamedTuple, Protocol, TypeVar

from analytic.block import RigidBlock
from analytic.checks import finite, positive
from analytic.motion import Motion
from engines.hints import TRUE, Hints

PRESETS = ("naive", "fixed", "landing")
"""How an engine is used: as it comes out of the box, tuned with a fixed step, or tuned with steps
that land on impacts, the best there is."""

FRAMES = ("base", "world")
"""Where the base moves: not at all, its motion being a body force, or in the world."""

ACCURACIES = {"loose": 40, "standard": 200, "tight": 800}
"""Name of an accuracy -> steps of the preset "landing" in a time 1/p."""

GEOMETRIES = ("box", "corners", "hull")
"""What touches the base: the whole block, small spheres at its corners, or the whole block as the
convex hull of its corners."""

SettingsT = TypeVar("SettingsT")


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """One block on one shaken base, and how it is to be simulated.

    Parameters
    ----------
    block : RigidBlock
        Its restitution is not used: the impact is the engine's own.
    motion : Motion
        Horizontal motion of the base.
    preset : str, optional
        One of `PRESETS`.
    accuracy : str, optional
        One of `ACCURACIES`, for the preset "landing".
    frame : str, optional
        "base": the base is at rest and the block carries the body force -m u_g''; "world": the
        base moves.
    density : float, optional
        [kg/m3].
    depth : float, optional
        Size of the block out of the plane [m]; its width by default.
    friction : float, optional
        Coefficient between block and base; the preset's by default.
    step : float, optional
        p dt, the ordinary step in units of 1/p; the preset's by default.
    duration : float, optional
        Observe until this time [s], at least the motion's own duration. By default the
        observation ends as soon as peak and outcome are decided.
    times : sequence of float, optional
        Increasing ground times [s] at which the response is sampled.
    time_limit_s : float, optional
        Wall-clock time after which a run is given up.
    max_steps : int, optional
        Number of steps after which a run is given up.
    settings : mapping, optional
        Settings of the engine by name that replace those of the preset.
    hints : Hints, optional
        What the steps of the preset "landing" expect; the truth by default. False ones are for
        measuring what the steps lean on.

    Raises
    ------
    ValueError
        If a value is not allowed; the message says what is.
    """

    block: RigidBlock
    motion: Motion
    preset: str = "landing"
    accuracy: str = "standard"
    frame: str = "base"
    density: float = 1000.0
    depth: float | None = None
    friction: float | None = None
    step: float | None = None
    duration: float | None = None
    times: Sequence[float] | None = None
    time_limit_s: float | None = None
    max_steps: int = 5_000_000
    settings: Mapping[str, Any] = field(default_factory=dict)
    hints: Hints = TRUE

    def __post_init__(self) -> None:
        one_of("preset", self.preset, PRESETS)
        one_of("accuracy", self.accuracy, tuple(ACCURACIES))
        one_of("frame", self.frame, FRAMES)
        for name in ("density", "depth", "friction", "step", "time_limit_s", "max_steps"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive(name, getattr(self, name)))
        object.__setattr__(self, "max_steps", int(self.max_steps))
        if self.duration is not None:
            object.__setattr__(self, "duration", self._checked_duration(self.duration))
        if self.times is not None:
            object.__setattr__(self, "times", _increasing("times", self.times))
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))

    def _checked_duration(self, value: float) -> float:
        duration = finite("duration", value)
        if duration < self.motion.duration:
            raise ValueError(
                f"duration is {value!r}; it must be at least the motion's {self.motion.duration!r}"
            )
        return duration

    @property
    def depth_m(self) -> float:
        """Size of the block out of the plane [m]."""
        return self.block.width if self.depth is None else self.depth

    @property
    def mass(self) -> float:
        """Mass of the block [kg]."""
        return self.density * self.block.width * self.block.height * self.depth_m

    @property
    def inertia(self) -> tuple[float, float, float]:
        """Moments of inertia [kg m2] about the centre of mass and the axes x, y, z."""
        x, y, z = self.block.width, self.depth_m, self.block.height
        twelfth = self.mass / 12.0
        return (twelfth * (y * y + z * z), twelfth * (x * x + z * z), twelfth * (x * x + y * y))

    def ordinary_step(self, preset_step: float | None, library_s: float) -> float:
        """Return the ordinary step [s].

        preset_step is the p dt of a preset, or None to leave the library's own step `library_s`.
        """
        step = preset_step if self.step is None else self.step
        if step is not None:
            return step / self.block.p
        if self.preset == "landing":
            return 1.0 / (ACCURACIES[self.accuracy] * self.block.p)
        return library_s

    def choose(self, preset: SettingsT) -> SettingsT:
        """Return the settings of a preset with this scene's own in their place.

        Raises
        ------
        ValueError
            If a setting is not one of the engine's.
        """
        names = [item.name for item in fields(preset)]  # type: ignore[arg-type]
        for name in self.settings:
            one_of("setting", name, names)
        chosen = dict(self.settings)
        if self.friction is not None:
            chosen["friction"] = self.friction
        return replace(preset, **chosen)  # type: ignore[type-var]


class Grip(enum.Enum):
    """What a step is for, by which an adapter may choose how firmly a contact holds."""

    REST = "the block is at rest"
    SWING = "the block turns about a corner"
    APPROACH = "one of the shorter steps before an impact"
    STRIKE = "one of the shortest steps through an impact"


class Step(NamedTuple):
    """A step of a policy.

    dt_s [s] is how far it goes; kick_s [s] is for how long forces act on the velocity before, and
    base_kick [m/s] is the change of the base's velocity meanwhile; grip says what the step is for,
    and side about which corner the block turns: -1 or 1, or 0 where it is held by both.
    """

    dt_s: float
    kick_s: float
    base_kick: float
    grip: Grip
    side: float


class Pose(NamedTuple):
    """Where the block is, relative to its base, as the engine reports it.

    x, z [m] are the horizontal and vertical position of the centre of mass, zero under the
    centre of the block at rest and at the level of the base; theta [rad] is positive when the
    block leans towards +x; rate [rad/s] is the angular velocity of the step that led here.
    """

    x: float
    z: float
    theta: float
    rate: float


class World(Protocol):
    """A built scene: what a stepping policy asks of an engine.

    The engines integrate by semi-implicit Euler steps, so that a velocity belongs to the middle
    of the step through which it has carried the block. A step is therefore told two durations:
    from the middle of the last step to the middle of this one, and from its start to its end.
    """

    dt_s: float
    """Ordinary step [s]."""

    def step(self, step: Step) -> None:
        """Advance by a step."""

    def pose(self) -> Pose:
        """Read the block's pose back."""

    def fault(self) -> str:
        """Say what the engine knows to have gone wrong, or an empty string."""

    def close(self) -> None:
        """Release the engine's memory."""


def one_of(name: str, value: str, allowed: Sequence[str]) -> None:
    """Raise ValueError unless `value` is one of those allowed."""
    if value not in allowed:
        raise ValueError(f"{name} is {value!r}; it must be one of {', '.join(allowed)}")


def disagreement(pairs: Mapping[str, tuple[Any, Any]]) -> str:
    """Name the first setting that reads back as something else, or return an empty string.

    Each pair is what was set and what was read; numbers may differ by rounding.
    """
    for name, (wanted, found) in pairs.items():
        if not math.isclose(wanted, found, rel_tol=1e-9):
            return f"{name} was set to {wanted!r} but reads {found!r}"
    return ""


def _increasing(name: str, values: Sequence[float]) -> tuple[float, ...]:
    times = tuple(finite(name, value) for value in values)
    if not times or times[0] < 0.0 or any(b <= a for a, b in itertools.pairwise(times)):
        raise ValueError(f"{name} is {values!r}; they must increase from 0 or later")
    return times
