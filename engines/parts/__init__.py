"""What adapters share: shapes of block and base, units of length, silence."""

import contextlib
import itertools
import math
import os
import sys
import warnings
from collections.abc import Iterator
from importlib import import_module
from typing import Any

from engines.scene import LOWER, Body, Scene

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


class Counted:
    """Settings of an engine that need not count lengths in metres from the base.

    In single precision it matters: numbers are told apart by a part of themselves, and a rounding
    of the pivot's height is a velocity in a short step.

    Attributes
    ----------
    units : float or None
        Units of length in the height of the block; None counts in metres.
    centred : bool
        Count heights from where the block's centre is at rest, not from the base.
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
    """Return lengths in an engine's units.

    Parameters
    ----------
    lengths : (float, float, float), [m]
    unit : float, how many units are in a metre
    """
    x, y, z = lengths
    return x * unit, y * unit, z * unit


@contextlib.contextmanager
def silence() -> Iterator[None]:
    """Let nothing reach the process's output and error streams while the context lasts."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    kept = {number: os.dup(number) for number in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in kept:
            os.dup2(nowhere, number)
        yield
    finally:
        os.close(nowhere)
        for number, copy in kept.items():
            os.dup2(copy, number)
            os.close(copy)


def imported(library: str) -> Any:
    """Import a library without what it writes past Python, and without its warnings."""
    if library in sys.modules:
        return sys.modules[library]
    with silence(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return import_module(library)
