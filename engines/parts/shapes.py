"""Shapes of block and base that every engine builds in its own words."""

import itertools
import math

from engines.layouts import LOWER, Body
from engines.scene import Scene

Point = tuple[float, float, float]

NO_JAM = 1.3
"""Friction just below 4/3, from which on a corner of a homogeneous block may jam (Painlevé's
paradox): a solver by impulses finds no force then, and lets the corner through the base."""

MOST_ITERATIONS = 2**31 - 1
"""What fits into a library's own integer."""

FLOOR_HEIGHTS = 100.0
"""Half of the extent of a base that is a box, in heights of the block and in its depths."""


def fall(scene: Scene, dt_s: float) -> float:
    """Return (alpha p dt)^2 H [m], by which the gap grows in a step dt that opens at a pivot.

    Parameters
    ----------
    scene : Scene
    dt_s : float, dt [s]
    """
    return (scene.system.alpha * scene.system.p * dt_s) ** 2 * scene.system.height


def iterations_for(scene: Scene, iterations: int | None, sweeps: float | None) -> int | None:
    """Return how often a solver goes through the contacts; None leaves that to it.

    The impulses of the two corners on which a block stands converge the more slowly, the more
    slender it is: sweeps / sin^2(alpha) iterations, rounded up, serve every block equally well.

    Parameters
    ----------
    scene : Scene
    iterations : int or None, what is asked for, which is returned then
    sweeps : float or None
    """
    if iterations is not None or sweeps is None:
        return iterations
    return min(math.ceil(sweeps / math.sin(scene.system.alpha) ** 2), MOST_ITERATIONS)


def half_size(body: Body) -> Point:
    """Return half of a body's size [m] along x, y and z."""
    return (0.5 * body.width, 0.5 * body.depth, 0.5 * body.height)


def corner_spheres(body: Body, radius: float, *, planar: bool, face: int = LOWER) -> list[Point]:
    """Return the centres [m] of spheres at the corners of a body's face, those at -x first.

    They are relative to the body's centre.

    Parameters
    ----------
    body : Body
    radius : float, [m]
    planar : bool, whether there are two in the middle plane, or four at the edges
    face : int, optional, LOWER or UPPER
    """
    x, y, z = half_size(body)
    depths = (0.0,) if planar else (-y, y)
    return [(side, depth, face * (z - radius)) for side in (-x, x) for depth in depths]


def touching_spheres(scene: Scene, body: int, radius: float, *, planar: bool) -> list[Point]:
    """Return the centres [m] of spheres at all corners by which a body touches others.

    Parameters
    ----------
    scene : Scene
    body : int, its number
    radius, planar
        As for `corner_spheres`.
    """
    return [
        corner
        for face in scene.layout.faces(body)
        for corner in corner_spheres(scene.bodies[body], radius, planar=planar, face=face)
    ]


def hull_points(body: Body) -> list[Point]:
    """Return the eight corners of a body [m], relative to its centre."""
    x, y, z = half_size(body)
    return list(itertools.product((-x, x), (-y, y), (-z, z)))


def floor_half_size(scene: Scene) -> Point:
    """Return half of the size [m] of a base that is a box; its top is at its own half height."""
    height, depth = scene.bodies[0].height, scene.bodies[0].depth
    return (FLOOR_HEIGHTS * height, FLOOR_HEIGHTS * depth, height)
