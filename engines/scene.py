"""What is simulated: bodies that touch one another and a shaken base, and how.

A system is a class of `analytic`, with its sizes; an engine sees boxes, where they begin, and which
faces touch. A further system is one more function here, and one line of `LAYOUTS`.
"""

import itertools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType
from typing import Any, NamedTuple

from analytic.block import RigidBlock, Upright
from analytic.checks import check_tilt, finite, positive, start_of
from analytic.frame import Rocker, RockingFrame
from analytic.motion import SEGMENT_COLUMNS, BothWays, Motion, Still
from analytic.slide import SlidingBlock
from engines.settings import one_of

Start = tuple[float, float]

BASE = -1
"""Number of the base, where a contact names the body below."""

LOWER, UPPER = -1, 1
"""Faces of a body."""

SPACING, BEAM_DEPTH = 2.0, 0.2
"""Distance of a frame's columns and depth of its beam, both in their heights."""


class Beginning(NamedTuple):
    """Place [m, rad] and velocities [m/s, rad/s] of a body's centre at t = 0, from the base's."""

    x: float
    z: float
    theta: float
    velocity_x: float
    velocity_z: float
    rate: float

    @property
    def at_rest(self) -> bool:
        """Whether the body stands upright and still."""
        return self.theta == 0.0 == self.rate == self.velocity_x


@dataclass(frozen=True, slots=True)
class Body:
    """A box, upright where its rotation is zero: sizes [m] along x, z and y, density in kg/m3.

    Its middle is at `home` at rest and begins `at`; the mass is `offset` [m] to its right, with a
    moment of inertia over mass of `square` [m2], None where it is spread evenly.
    """

    width: float
    height: float
    depth: float
    density: float
    home: tuple[float, float]
    at: Beginning
    offset: float = 0.0
    square: float | None = None

    @property
    def mass_at(self) -> Beginning:
        """Where its mass begins, and how fast."""
        at, right = self.at, self.offset * math.cos(self.at.theta)
        down = self.offset * math.sin(at.theta)
        along, up = at.velocity_x - at.rate * down, at.velocity_z - at.rate * right
        return Beginning(at.x + right, at.z - down, at.theta, along, up, at.rate)

    @property
    def about_middle(self) -> float:
        """Moment of inertia [kg m2] about the middle and the axis y."""
        return self.inertia[1] + self.mass * self.offset**2

    @property
    def is_homogeneous(self) -> bool:
        """Whether its mass is spread evenly."""
        return self.offset == 0.0 and self.square is None

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.density * self.width * self.height * self.depth

    @property
    def inertia(self) -> tuple[float, float, float]:
        """Moments of inertia [kg m2] about the centre of mass and the axes x, y, z."""
        x, y, z = self.width, self.depth, self.height
        # a moment that is stated widens x and z alike, so that some body has all three
        wide = 1.0 if self.square is None else 12.0 * self.square / (x * x + z * z)
        twelfth = self.mass / 12.0
        turning = twelfth * (x * x + z * z) if self.square is None else self.mass * self.square
        return (twelfth * (y * y + wide * z * z), turning, twelfth * (wide * x * x + y * y))


class Contact(NamedTuple):
    """Corners of a body's face, `LOWER` or `UPPER`, that touch another body's or the `BASE`."""

    body: int
    face: int
    on: int


class Layout(NamedTuple):
    """What stands on what; the first ones, `rocking`, rock as the system's equation says."""

    bodies: tuple[Body, ...]
    contacts: tuple[Contact, ...]
    rocking: int

    def faces(self, body: int) -> list[int]:
        """Return by which of its faces' corners a body touches others."""
        return [contact.face for contact in self.contacts if contact.body == body]

    def rests(self, body: int) -> bool:
        """Say whether a body rests on the corners of others."""
        return any(contact.on == body for contact in self.contacts)

    def carried(self, contact: Contact) -> float:
        """Return the mass [kg] that a contact carries; several below carry a body alike."""
        tops = [top for top in self.contacts if top[:2] == (contact.body, UPPER)]
        shares = [sum(each.on == top.on for each in self.contacts) for top in tops]
        loads = [self.bodies[top.on].mass / n for top, n in zip(tops, shares, strict=True)]
        return sum(loads, self.bodies[contact.body].mass if contact.face == LOWER else 0.0)


System = Rocker | SlidingBlock
"""What can be posed; its width, height, alpha, p and gravity are those of what rocks or slides."""


def tilted(width: float, height: float, side: float, theta: float, rate: float) -> Beginning:
    """Return where a box's centre is, and how fast, that turns about a corner (-1, 1), or 0."""
    half_width, half_height = 0.5 * side * width, 0.5 * height
    sine, cosine = math.sin(theta), math.cos(theta)
    return Beginning(
        x=half_width * (1.0 - cosine) + half_height * sine,
        z=half_width * sine + half_height * cosine,
        theta=theta,
        velocity_x=rate * (half_width * sine + half_height * cosine),
        velocity_z=rate * (half_width * cosine - half_height * sine),
        rate=rate,
    )


def _standing(system: Any, density: float, depth: float | None, start: Start, home: float) -> Body:
    """Return a box of the system's size that rocks, its centre at rest at `home` [m]."""
    theta, rate = start
    side = math.copysign(1.0, theta or rate) if theta or rate else 0.0
    at = tilted(system.width, system.height, side, theta, rate)
    out = system.width if depth is None else depth
    there = home, 0.5 * system.height
    return Body(system.width, system.height, out, density, there, at._replace(x=home + at.x))


def one_block(system: Upright, density: float, depth: float | None, start: Start) -> Layout:
    """Return one block on the base."""
    block = _standing(system, density, depth, start, 0.0)
    if isinstance(system, RigidBlock):
        block = replace(block, offset=system.offset, square=system.inertia)
    return Layout((block,), (Contact(0, LOWER, BASE),), 1)


def frame(system: RockingFrame, density: float, depth: float | None, start: Start) -> Layout:
    """Return columns on the base about x = 0, and a beam that moves with their heads."""
    count, apart = system.columns, SPACING * system.height
    homes = [(number - 0.5 * (count - 1)) * apart for number in range(count)]
    columns = [_standing(system, density, depth, start, home) for home in homes]
    first, thick = columns[0], BEAM_DEPTH * system.height
    level = system.height + 0.5 * thick
    at = first.at
    rides = Beginning(
        # a corner at the top of a column moves twice as far as its centre
        x=2.0 * (at.x - first.home[0]),
        z=level + 2.0 * (at.z - first.home[1]),
        theta=0.0,
        velocity_x=2.0 * at.velocity_x,
        velocity_z=2.0 * at.velocity_z,
        rate=0.0,
    )
    width = (count - 1) * apart + 2.0 * system.width
    dense = system.load * count * first.mass / (width * thick * first.depth)
    beam = Body(width, thick, first.depth, dense, (0.0, level), rides)
    below = [Contact(number, LOWER, BASE) for number in range(count)]
    above = [Contact(number, UPPER, count) for number in range(count)]
    return Layout((*columns, beam), (*below, *above), count)


def sliding(system: SlidingBlock, density: float, depth: float | None, start: Start) -> Layout:
    """Return one block on the base that begins at a place with a velocity."""
    place, velocity = start
    block = _standing(system, density, depth, (0.0, 0.0), 0.0)
    at = block.at._replace(x=place, velocity_x=velocity)
    return Layout((replace(block, at=at),), (Contact(0, LOWER, BASE),), 0)


LAYOUTS: Mapping[type, Callable[[Any, float, float | None, Start], Layout]] = {
    RigidBlock: one_block,
    RockingFrame: frame,
    SlidingBlock: sliding,
}
"""Class of a system -> what makes its layout of it, a density [kg/m3], a depth [m] and a start."""


def layout_of(system: Any, density: float, depth: float | None, start: Start) -> Layout:
    """Return the layout of a system of `LAYOUTS`; TypeError if it is of another class."""
    made = LAYOUTS.get(type(system))
    if made is None:
        known = ", ".join(kind.__name__ for kind in LAYOUTS)
        raise TypeError(f"system is a {type(system).__name__}; it must be one of {known}")
    return made(system, density, depth, start)


FREE_ROCKING = 8.0
"""How long free rocking is followed after the motion, in units of 1/p: a few impacts."""


def free_rocking_window(system: System, motion: Motion) -> float:
    """Return the time [s] of an observation: the motion and `FREE_ROCKING`."""
    return motion.duration + FREE_ROCKING / system.p


FRAMES = ("base", "world")
"""Where the base moves: not at all, its motion being a body force, or in the world."""

MOST_HALF_CYCLES = 10**6
"""Half cycles of which an engine's process holds the times in half a GB."""

ACCURACIES = {"loose": 40, "standard": 200, "tight": 800}
"""Name of an accuracy -> ordinary steps in a time 1/p, where steps are not all equal."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Scene:
    """Bodies on one shaken base, and how they are to be simulated.

    Parameters
    ----------
    system : RigidBlock, or another of `engines.scene.LAYOUTS`
        What stands on the base. Its restitution is not used: the impact is the engine's own.
    motion : Motion
        Horizontal motion of the base; of a `RigidBlock` a `BothWays`, which moves it upwards too.
    start : pair of float
        theta [rad] and theta' [rad/s] at t = 0; by default the block is at rest. A block that
        leans stands on its corner on the side of its lean; upright, it turns about the corner
        towards which it moves.
    preset : str or None
        Name of one of the engine's presets; its best by default.
    accuracy : str
        One of `ACCURACIES`, for presets whose steps land on impacts or are the engine's own.
    frame : str or None
        "base": the base is at rest and the block carries the body force -m u_g''; "world": the
        base moves. By default as the preset does it.
    density, depth : float
        [kg/m3], and the size of the block out of the plane [m], by default its width.
    friction : float or None
        Coefficient between block and base; by default the system's, where it has one, or the
        preset's. Where it is 0 the block is meant to slide, and a slide is no failure.
    step : float or None
        p dt, the ordinary step in units of 1/p; the preset's by default.
    duration : float or None
        Observe until this time [s], at least the motion's own duration. By default what `watched`
        says, and until peak and outcome are decided.
    rest_s : float or None
        The ground is at rest for so long [s] before the motion, in which nothing is observed; by
        default as the preset does it. 0 where the block does not begin at rest.
    times : sequence of float or None
        Increasing ground times [s] at which the response is sampled, as long as it is observed.
    time_limit_s, max_steps : float, int
        Wall-clock time, and number of steps, after which a run is given up.
    settings : mapping
        Settings of the engine by name that replace those of the preset.
    compiled : bool
        Look at it by compiled code where there is more of it than a few steps; both forms give the
        same response to the bit.

    Examples
    --------
    >>> from analytic import RigidBlock, SinePulse
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> Scene(system=block, motion=SinePulse(amplitude=4.0, omega=6.0), preset="tuned").stacked
    False
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
    rest_s: float | None = None
    times: Sequence[float] | None = None
    time_limit_s: float | None = None
    max_steps: int = 5_000_000
    settings: Mapping[str, Any] = field(default_factory=dict)
    compiled: bool = True

    def __post_init__(self) -> None:
        one_of("accuracy", self.accuracy, tuple(ACCURACIES))
        if self.heaves and not (isinstance(self.system, RigidBlock) and self.lightest > 0.0):
            words = "engines take it of a RigidBlock that it presses on its base all the time"
            raise ValueError(f"vertical is given; {words}")
        if (count := getattr(self.motion, "half_cycles", 1)) > MOST_HALF_CYCLES:
            allowed = f"at most {MOST_HALF_CYCLES}, as an engine holds the times of all in memory"
            raise ValueError(f"half_cycles is {count!r}; it must be {allowed}")
        if self.frame is not None:
            one_of("frame", self.frame, FRAMES)
        put = partial(object.__setattr__, self)
        sizes = ("density", "depth", "step", "time_limit_s", "max_steps")
        for name in (*sizes, "friction", "duration", "rest_s"):
            if (value := getattr(self, name)) is not None:
                put(name, positive(name, value) if name in sizes else finite(name, value))
        put("start", self._checked_start(self.start))
        if self.friction is None:
            put("friction", getattr(self.system, "friction", None))
        elif self.friction < 0.0:
            raise ValueError(f"friction is {self.friction!r}; it must not be negative")
        put("max_steps", int(self.max_steps))
        if self.duration is not None and self.duration < (least := self.motion.duration):
            words = f"it must be at least the motion's {least!r}"
            raise ValueError(f"duration is {self.duration!r}; {words}")
        if self.rest_s and (self.rest_s < 0.0 or not self.begins_at_rest):
            words = "it must be 0 where the block does not begin at rest, and never negative"
            raise ValueError(f"rest_s is {self.rest_s!r}; {words}")
        put("times", _increasing("times", self.times))
        put("settings", MappingProxyType(dict(self.settings)))

    def _checked_start(self, start: tuple[float, float]) -> tuple[float, float]:
        theta, rate = start_of(start)
        # of what slides they are place [m] and velocity [m/s]
        if layout_of(self.system, self.density, self.depth, (theta, rate)).rocking:
            check_tilt(theta, rate, self.alphas[theta < 0.0], lambda: not _moves(self.motion))
        return theta, rate

    @property
    def layout(self) -> Layout:
        """Which bodies there are, what touches what, and which of them rock."""
        return layout_of(self.system, self.density, self.depth, self.start)

    @property
    def bodies(self) -> tuple[Body, ...]:
        """The bodies, in the order of a world's state."""
        return self.layout.bodies

    @property
    def begins_at_rest(self) -> bool:
        """Whether every body begins upright and still."""
        return all(body.at.at_rest for body in self.bodies)

    @property
    def heaves(self) -> bool:
        """Whether the base moves vertically too."""
        return isinstance(self.motion, BothWays)

    @property
    def lightest(self) -> float:
        """The least that the base's acceleration upwards leaves of gravity [m/s2]."""
        lowest = self.motion.lowest if isinstance(self.motion, BothWays) else 0.0
        return self.system.gravity + min(lowest, 0.0)

    @property
    def shaking(self) -> list[list[float]]:
        """The base's motion, a row of `SEGMENT_COLUMNS` each: the rest before it is one as well."""
        return self._rows(getattr(self.motion, "level", self.motion))

    @property
    def heaving(self) -> list[list[float]]:
        """Its motion upwards, likewise."""
        return self._rows(getattr(self.motion, "upward", Still()))

    def _rows(self, motion: Motion) -> list[list[float]]:
        rows: list[list[float]] = motion.segments().tolist()
        rest = [-self.rest_s, *[0.0] * (len(rows[0]) - 1)] if self.rest_s else []
        return [rest, *rows] if rest else rows

    @property
    def stacked(self) -> bool:
        """Whether bodies rest on others."""
        return len(self.bodies) > 1

    @property
    def alphas(self) -> tuple[float, float]:
        """Rotations [rad] from which its weight no longer brings it back, to the right and left."""
        right, left = getattr(self.system, "sides", (self.system, self.system))
        return right.alpha, left.alpha

    @property
    def watched(self) -> float:
        """Until when it is observed at least [s].

        Where energy falls no later turning point is larger, but of columns that part: 8/p more
        change no outcome of 200 of the paper's cases, and no peak by more than 4e-8 of alpha.
        """
        if self.duration is not None:
            return self.duration
        if self.stacked:
            return free_rocking_window(self.system, self.motion)
        return self.motion.duration

    @property
    def side(self) -> float:
        """Corner about which what rocks turns at first: -1 or 1, or 0 if it is at rest."""
        theta, rate = self.start
        turns = self.layout.rocking and (theta or rate)
        return math.copysign(1.0, theta or rate) if turns else 0.0


def _moves(motion: Motion) -> bool:
    accelerating = [SEGMENT_COLUMNS.index(name) for name in ("amplitude", "offset", "slope")]
    return bool(motion.segments()[:, accelerating].any())


def _increasing(name: str, values: Sequence[float] | None) -> tuple[float, ...] | None:
    if values is None:
        return None
    times = tuple(finite(name, value) for value in values)
    if not times or times[0] < 0.0 or any(b <= a for a, b in itertools.pairwise(times)):
        raise ValueError(f"{name} is {values!r}; they must increase from 0 or later")
    return times
