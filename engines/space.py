"""A cylinder in space, on a plane at rest: what an engine is given of it, and its run.

An engine that holds one says what builds its `SpaceWorld` (`engines.declaration.Engine.builders`).
"""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from time import perf_counter
from types import SimpleNamespace
from typing import Any, ClassVar, NamedTuple, Protocol, cast

import numpy as np

from analytic.checks import positive
from analytic.motion import FloatArray
from analytic.response import Problem, Reason
from engines.layouts import BASE, LOWER, Ability, Contact, Layout
from engines.registry import find
from engines.run.drive import LOOK_AROUND, build
from engines.scene import Scene

Point = tuple[float, float, float]

TAKEN = 1e-5
"""To which part the start must read back as it was set, in single precision, too."""

DEEPEST = 0.2
"""A cylinder whose lowest point is below the plane by more than this part of its radius has sunk.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cylinder:
    """A homogeneous cylinder, its axis vertical where it is not turned.

    Attributes
    ----------
    radius, height : float
        Full height [m].
    density : float
        [kg/m3].
    place, velocity : tuple of float
        Of its centre, from a point of the plane on [m], [m/s].
    turn : tuple of float
        Its rotation from upright, a unit quaternion (w, x, y, z).
    spin : tuple of float
        Angular velocity [rad/s] in the axes of space.
    """

    radius: float
    height: float
    density: float
    place: Point
    turn: tuple[float, float, float, float]
    velocity: Point
    spin: Point

    @property
    def width(self) -> float:
        """Size [m] across, along both axes, as that of a box."""
        return 2.0 * self.radius

    depth = width

    @property
    def home(self) -> tuple[float, float]:
        """Where its centre would be upright, along the base and above it [m]."""
        return 0.0, 0.5 * self.height

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return self.density * math.pi * self.radius**2 * self.height

    @property
    def inertia(self) -> Point:
        """Moments of inertia [kg m2] about the centre, the last one about the axis."""
        across = self.mass * (0.25 * self.radius**2 + self.height**2 / 12.0)
        return across, across, 0.5 * self.mass * self.radius**2


@dataclass(frozen=True, slots=True, kw_only=True)
class SpaceScene:
    """A cylinder on a plane at rest, and how it is to be simulated.

    The options are those of `engines.scene.Scene`; a step is one over 1/p.

    Attributes
    ----------
    cylinder : Cylinder
    gravity, p : float
        [m/s2]; frequency parameter [rad/s] as it rocks on its rim, as that of a block.
    duration, every : float
        For how long it is simulated, and after which time its state is kept, about [s].
    """

    cylinder: Cylinder
    gravity: float
    p: float
    duration: float
    every: float
    preset: str | None = None
    friction: float | None = None
    step: float | None = None
    time_limit_s: float | None = None
    max_steps: int = 5_000_000
    settings: Mapping[str, Any] = field(default_factory=dict)

    frame: ClassVar[str] = "base"

    def __post_init__(self) -> None:
        for name in ("gravity", "duration", "every", "step", "time_limit_s", "max_steps"):
            if getattr(self, name) is not None:
                object.__setattr__(self, name, positive(name, getattr(self, name)))

    @property
    def system(self) -> SimpleNamespace:
        """Sizes [m] and rates by which settings are scaled, as those of a block."""
        it = self.cylinder
        return SimpleNamespace(
            **{"width": it.width, "height": it.height, "gravity": self.gravity, "p": self.p},
            **{"R": math.hypot(it.radius, 0.5 * it.height)},
            alpha=math.atan2(it.width, it.height),
        )

    @property
    def density(self) -> float:
        """Of the cylinder [kg/m3]."""
        return self.cylinder.density

    @property
    def bodies(self) -> tuple[Cylinder]:
        """The cylinder alone."""
        return (self.cylinder,)

    @property
    def layout(self) -> Layout:
        """One body that touches the base, and does not rock in a plane."""
        touching = (Contact(0, LOWER, BASE),)
        return Layout(cast(Any, self.bodies), touching, 0, (Ability.CYLINDER,))

    def choose(self, settings: Any) -> Any:
        """Return an engine's settings with this scene's own in their place."""
        return Scene.choose(cast(Any, self), settings)


class SpaceWorld(Protocol):
    """A cylinder that was built."""

    def step(self) -> None:
        """Advance by the step that it was built for."""

    def state(self) -> tuple[Any, Any, Any, Any]:
        """Read back its place [m], turn (w, x, y, z), velocity [m/s] and spin [rad/s] in space."""

    def fault(self) -> str:
        """Say what the engine knows to have gone wrong, or return an empty string."""

    def close(self) -> None:
        """Release the engine's memory."""


class Track(NamedTuple):
    """What became of a cylinder.

    Attributes
    ----------
    times : ndarray (n,)
        [s], each the end of a step.
    states : ndarray (n, 13)
        Place, turn, velocity and spin, as of `SpaceWorld.state`.
    steps : int
    wall_s, setup_s : float
        Time [s] that the steps took, and the building before.
    problem : Problem or None
        Why there is no usable result.
    preset : str
        Name of the preset that was used.
    """

    times: FloatArray
    states: FloatArray
    steps: int
    wall_s: float
    setup_s: float
    problem: Problem | None
    preset: str


def roll(name: str, scene: SpaceScene) -> Track:
    """Simulate a cylinder with an engine, in equal steps.

    Parameters
    ----------
    name : str, of the engine
    scene : SpaceScene

    Raises
    ------
    NotAvailableError
        If the engine or its preset cannot do it, or its library is not installed.
    ValueError
        If the engine is unknown, or a preset or setting is not one of the engine's.
    """
    began, engine, posed = perf_counter(), find(name), cast(Scene, scene)
    preset = engine.used_for(posed)
    world, dt_s = cast(Any, build(engine, posed)), preset.ordinary_step_s(posed)
    built = perf_counter()
    try:
        track = _run(world, scene, dt_s, _untaken(world, scene.cylinder))
    finally:
        world.close()
    return track._replace(setup_s=built - began, preset=preset.name)


def _untaken(world: SpaceWorld, it: Cylinder) -> Problem | None:
    """Return what of the start reads back as something else."""
    wanted = {"place": it.place, "turn": it.turn, "velocity": it.velocity, "spin": it.spin}
    for (name, value), found in zip(wanted.items(), world.state(), strict=True):
        if not np.allclose(value, found, rtol=TAKEN, atol=TAKEN * (1.0 + np.abs(value).max())):
            words = f"{name} was set to {value} but reads {np.asarray(found).tolist()}"
            return Problem(Reason.FAULT, words)
    return None


def _run(world: SpaceWorld, scene: SpaceScene, dt_s: float, problem: Problem | None) -> Track:
    steps = max(round(scene.duration / dt_s), 1)
    every = max(round(scene.every / dt_s), 1)
    times, states, taken = [0.0], [_row(world)], 0
    limit, began = scene.time_limit_s or math.inf, perf_counter()
    while taken < steps and not problem:
        if taken >= scene.max_steps or perf_counter() - began > limit:
            words = f"not decided within {taken} steps of {steps}"
            problem = Problem(Reason.UNDECIDED, words)
            break
        count = min(every - taken % every, steps - taken, LOOK_AROUND)
        for _ in range(count):
            world.step()
        taken += count
        if taken % every == 0 or taken == steps:
            times.append(taken * dt_s)
            states.append(_row(world))
            problem = _wrong(world, states[-1], scene.cylinder)
    wall_s = perf_counter() - began
    return Track(np.array(times), np.array(states), taken, wall_s, 0.0, problem, "")


def _row(world: SpaceWorld) -> FloatArray:
    return np.concatenate([np.asarray(part, dtype=np.float64) for part in world.state()])


def _wrong(world: SpaceWorld, row: FloatArray, it: Cylinder) -> Problem | None:
    if not np.isfinite(row).all():
        return Problem(Reason.DIVERGED, "the state is not finite")
    low = lowest(row[None], it)[0]
    if low < -DEEPEST * it.radius:
        return Problem(Reason.SANK, f"the rim sank {-low:.3g} m into the plane")
    return Problem(Reason.FAULT, words) if (words := world.fault()) else None


def axes(states: FloatArray) -> FloatArray:
    """Return the unit vectors (n, 3) along a cylinder's axis, from its lower face up."""
    w, x, y, z = (states[:, 3:7] / np.linalg.norm(states[:, 3:7], axis=1)[:, None]).T
    across = np.stack((2.0 * (x * z + w * y), 2.0 * (y * z - w * x)), axis=1)
    return np.column_stack((across, 1.0 - 2.0 * (x * x + y * y)))


def lowest(states: FloatArray, it: Cylinder) -> FloatArray:
    """Return the height [m] of a cylinder's lowest point above the plane, (n,).

    Parameters
    ----------
    states : ndarray (n, 13), as of `Track`
    it : Cylinder
    """
    up = axes(states)[:, 2]
    rim = it.radius * np.sqrt(np.maximum(1.0 - up * up, 0.0))
    return np.asarray(states[:, 2] - 0.5 * it.height * np.abs(up) - rim)


def energies(states: FloatArray, it: Cylinder, gravity: float) -> FloatArray:
    """Return the energy [J] of height, velocity and spin, (n,).

    With the moments of inertia A and C of EQUATIONS.md, "The rolling cylinder".

    Parameters
    ----------
    states : ndarray (n, 13), as of `Track`
    it : Cylinder
    gravity : float, [m/s2]
    """
    velocity, spin = states[:, 7:10], states[:, 10:13]
    along = np.einsum("ij,ij->i", spin, axes(states))
    across, _, axial = it.inertia
    turning = across * (np.einsum("ij,ij->i", spin, spin) - along**2) + axial * along**2
    moving = it.mass * np.einsum("ij,ij->i", velocity, velocity)
    return np.asarray(it.mass * gravity * states[:, 2] + 0.5 * (moving + turning))


def rotated(turn: Any, vector: Any, *, back: bool = False) -> FloatArray:
    """Return a vector of a body in the axes of space, or one of space in those of the body.

    Parameters
    ----------
    turn : array_like (4,), rotation of the body, a unit quaternion (w, x, y, z)
    vector : array_like (3,)
    back : bool, whether the vector is one of space
    """
    axis = -np.asarray(turn[1:]) if back else np.asarray(turn[1:])
    across = 2.0 * np.cross(axis, vector)
    return np.asarray(vector + turn[0] * across + np.cross(axis, across))


def turn_vector(turn: Any) -> FloatArray:
    """Return a rotation's axis times its angle [rad], of a quaternion (w, x, y, z)."""
    along = np.asarray(turn[1:])
    part = float(np.linalg.norm(along))
    return along * (2.0 * math.atan2(part, turn[0]) / part if part else 2.0)
