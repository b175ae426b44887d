"""Bodies and contacts: what each system that can be posed is, to an engine.

A system is a class of `analytic`, with its sizes; an engine sees boxes, where they begin, and which
faces touch. A further system is one more function here.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from enum import Enum
from typing import Any, NamedTuple

from analytic.block import RigidBlock, Rocker, Upright
from analytic.frame import MOST_COLUMNS, RockingFrame
from analytic.slide import SlidingBlock

Start = tuple[float, float]
"""How a system begins: theta [rad] and theta' [rad/s], or what its own class says."""

BASE = -1
"""Number of the base, where a contact names the body below."""

LOWER, UPPER = -1, 1
"""Faces of a body."""


SPACING = 2.0
"""Distance of a frame's columns, in their heights."""

BEAM_DEPTH = 0.2
"""Depth of its beam, likewise."""


class Ability(Enum):
    """What a scene may ask of an engine beyond one body; the value is what a reader is told."""

    SEVERAL = "several bodies on one base"
    STACKED = "bodies that rest on other bodies"


class Beginning(NamedTuple):
    """Place [m, rad] and velocities [m/s, rad/s] of a body's centre at t = 0.

    They are relative to the base, which is at rest then.
    """

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
    """A homogeneous box, upright where its rotation is zero.

    Attributes
    ----------
    width, height, depth : float
        Full sizes [m] along x, z and y, which is out of the plane.
    density : float
        [kg/m3].
    home : (float, float)
        Where its centre is at rest, along the base and above it [m].
    at : Beginning
        Where it begins.
    """

    width: float
    height: float
    depth: float
    density: float
    home: tuple[float, float]
    at: Beginning

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.density * self.width * self.height * self.depth

    @property
    def inertia(self) -> tuple[float, float, float]:
        """Moments of inertia [kg m2] about the centre of mass and the axes x, y, z."""
        x, y, z = self.width, self.depth, self.height
        twelfth = self.mass / 12.0
        return (twelfth * (y * y + z * z), twelfth * (x * x + z * z), twelfth * (x * x + y * y))


class Contact(NamedTuple):
    """Corners of a body's face, which touch the flat face of another body or the base.

    body and on are numbers of bodies, on may be `BASE`; face is `LOWER` or `UPPER`.
    """

    body: int
    face: int
    on: int


class Layout(NamedTuple):
    """What stands on what.

    Attributes
    ----------
    bodies : tuple of Body
    contacts : tuple of Contact
    rocking : int
        How many bodies, from the first on, rock about their lower corners as the system's one
        equation says; 0 where nothing rocks.
    """

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
        """Return the mass [kg] that a contact carries: what its lower body's share is of all above.

        A body that rests on others is carried by all of them alike.
        """
        tops = [top for top in self.contacts if top[:2] == (contact.body, UPPER)]
        shares = [sum(each.on == top.on for each in self.contacts) for top in tops]
        loads = [self.bodies[top.on].mass / n for top, n in zip(tops, shares, strict=True)]
        return sum(loads, self.bodies[contact.body].mass if contact.face == LOWER else 0.0)

    @property
    def asks(self) -> tuple[Ability, ...]:
        """What an engine must be able to do for it, the most particular last."""
        several = (Ability.SEVERAL,) if len(self.bodies) > 1 else ()
        stacked = any(contact.on != BASE for contact in self.contacts)
        return (*several, *((Ability.STACKED,) if stacked else ()))


@dataclass(frozen=True, slots=True, kw_only=True)
class SideBySide:
    """Equal blocks that stand apart on one base: each rocks as it would alone.

    Parameters
    ----------
    block : RigidBlock
    count : int, optional
        How many, from 1 to 100.
    """

    block: RigidBlock
    count: int = 2

    def __post_init__(self) -> None:
        if not 1 <= self.count <= MOST_COLUMNS or self.count != int(self.count):
            allowed = f"a whole number from 1 to {MOST_COLUMNS}"
            raise ValueError(f"count is {self.count!r}; it must be {allowed}")

    def __getattr__(self, name: str) -> Any:
        return getattr(self.block, name)


System = Rocker | SlidingBlock | SideBySide
"""What can be posed; its width, height, alpha, p and gravity are those of what rocks or slides."""


def tilted(width: float, height: float, side: float, theta: float, rate: float) -> Beginning:
    """Return where the centre of a box is, and how fast, that turns about its corner at a side.

    Parameters
    ----------
    width, height : float
        Of the box [m].
    side : float
        -1 or 1, the corner that stays on the base; 0 where both do.
    theta, rate : float
        Rotation [rad] and angular velocity [rad/s].
    """
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
    """Return one block on the base.

    Parameters
    ----------
    system, density, depth, start
        As for `layout_of`.
    """
    block = _standing(system, density, depth, start, 0.0)
    return Layout((block,), (Contact(0, LOWER, BASE),), 1)


def side_by_side(system: SideBySide, density: float, depth: float | None, start: Start) -> Layout:
    """Return equal blocks apart on the base, the first one at its middle."""
    apart = 4.0 * system.height
    homes = [apart * number for number in range(system.count)]
    bodies = tuple(_standing(system, density, depth, start, home) for home in homes)
    contacts = tuple(Contact(number, LOWER, BASE) for number in range(system.count))
    return Layout(bodies, contacts, system.count)


def frame(system: RockingFrame, density: float, depth: float | None, start: Start) -> Layout:
    """Return columns on the base and a beam on their tops, all of them about x = 0.

    The beam moves with the heads of the columns and does not turn (EQUATIONS.md, "The rocking
    frame"). The parameters are those of `layout_of`.
    """
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
    SideBySide: side_by_side,
}
"""Class of a system -> what makes its layout of it, a density [kg/m3], a depth [m] and a start."""


def layout_of(system: Any, density: float, depth: float | None, start: Start) -> Layout:
    """Return the layout of a system.

    Parameters
    ----------
    system : RigidBlock, or another of LAYOUTS
    density : float, [kg/m3]
    depth : float or None, size out of the plane [m]; None is the width
    start : (float, float), theta [rad] and theta' [rad/s]; of a box that slides, place [m] and
        velocity [m/s]

    Raises
    ------
    TypeError
        If no layout is known for its class.
    """
    made = LAYOUTS.get(type(system))
    if made is None:
        known = ", ".join(kind.__name__ for kind in LAYOUTS)
        raise TypeError(f"system is a {type(system).__name__}; it must be one of {known}")
    return made(system, density, depth, start)
