"""Shapes of block and base, as adapters give them to a library, and units of length."""

import itertools

import numpy as np

from engines.scene import LOWER, Body, Scene
from engines.settings import Settings

Point = tuple[float, float, float]

FLOOR_HEIGHTS = 10.0
"""To where a base that is a box goes on, in heights and depths of what stands on it. In single
precision it decides contacts: with 100 Rapier's recommended settings err by 6.3 %, not by 3.6 %."""


def half_size(body: Body) -> Point:
    """Return half of a body's size [m] along x, y and z."""
    return (0.5 * body.width, 0.5 * body.depth, 0.5 * body.height)


def corner_spheres(body: Body, radius: float, *, planar: bool, face: int = LOWER) -> list[Point]:
    """Return centres [m] of spheres at a face's corners, at -x first: two if planar, or four."""
    x, y, z = half_size(body)
    depths = (0.0,) if planar else (-y, y)
    return [(side, depth, face * (z - radius)) for side in (-x, x) for depth in depths]


def touching_spheres(scene: Scene, body: int, radius: float, *, planar: bool) -> list[Point]:
    """Return the `corner_spheres` at all corners by which a body, of a number, touches others."""
    return [
        corner
        for face in scene.layout.faces(body)
        for corner in corner_spheres(scene.bodies[body], radius, planar=planar, face=face)
    ]


def hull_points(body: Body) -> list[Point]:
    """Return the eight corners of a body [m], relative to its centre."""
    x, y, z = half_size(body)
    return list(itertools.product((-x, x), (-y, y), (-z, z)))


def floor_reach(scene: Scene) -> float:
    """Return half of the length [m] of a base, on which a block that slides or is thrown stays."""
    farthest = max(abs(body.home[0]) for body in scene.layout.bodies)
    far = FLOOR_HEIGHTS * scene.bodies[0].height + farthest
    if scene.layout.rocking or not scene.friction:
        return far
    (place, velocity), end = scene.start, scene.motion.duration
    speed = abs(velocity) + float(np.ptp(scene.motion.velocity(np.linspace(0.0, end, 1000))))
    slide = speed * (end + 0.5 * speed / (scene.friction * scene.system.gravity))
    return max(far, 2.0 * (abs(place) + slide))


def floor_half_size(scene: Scene) -> Point:
    """Return half of the size [m] of a base that is a box; its top is at its own half height."""
    return floor_reach(scene), FLOOR_HEIGHTS * scene.bodies[0].depth, scene.bodies[0].height


class Counted(Settings):
    """Settings of an engine whose lengths are in parts of a block's height, `units`, or in metres.

    In single precision it matters; heights are `centred` that are counted from the centre at rest.
    """

    __slots__ = ()

    units: float | None
    centred: bool

    def unit_of(self, scene: Scene) -> float:
        """Return the units of length in a metre."""
        return 1.0 if self.units is None else self.units / scene.system.height

    def sunk_of(self, scene: Scene) -> float:
        """Return how far below the origin the base is, in units of length."""
        return 0.5 * scene.system.height * self.unit_of(scene) if self.centred else 0.0


def counted(lengths: Point, unit: float) -> Point:
    """Return lengths [m] in an engine's units, of which there are so many in a metre."""
    x, y, z = lengths
    return x * unit, y * unit, z * unit
