"""A small engine of another package: Moreau's time stepping of a planar block on two corners.

Positions move half a step, impulses change the velocity there, positions move the other half (J. J.
Moreau 1988). The impulses are exact: of the ways in which two corners can hold, slide or be open,
the one is taken that contradicts nothing. An impact is plastic, friction is Coulomb's.
"""

import itertools
from dataclasses import dataclass

import numpy as np

from engines.declaration import Engine, Help, Preset, Stepping
from engines.factors import factor, level
from engines.parts.settings import check, setting
from engines.scene import Scene
from engines.world import Moment, Pose, Step

SLACK = 1e-12
"""What rounding may contradict, relative to the velocities."""

WAYS = (((), 0), *itertools.product(((0,), (1,), (0, 1)), (0, 1, -1)))
"""Which corners touch, and whether they stick (0) or slide, to which side."""


@dataclass(frozen=True, slots=True, kw_only=True)
class MoreauSettings:
    """friction, and whether a corner may close its gap within a step, or else meets it late."""

    friction: float = setting(1.0, least=0.0)
    closing: bool = False

    def __post_init__(self) -> None:
        check(self)


class MoreauWorld:
    moment = Moment.END

    def __init__(self, scene: Scene, settings: MoreauSettings, dt_s: float) -> None:
        at = scene.beginning
        self._s, self._way = settings, ((0, 1), 0)
        self._place = np.array([at.x, at.z, at.theta])
        self._velocity = np.array([at.velocity_x, at.velocity_z, at.rate])
        self._light = 1.0 / np.array([scene.mass, scene.mass, scene.inertia[1]])
        x, z = 0.5 * scene.block.width, 0.5 * scene.block.height
        self._corners = np.array([[-x, -z], [x, -z]])

    def step(self, step: Step) -> None:
        self._place += 0.5 * step.dt_s * self._velocity
        free = self._velocity + step.dt_s * np.array([step.pull_x, step.pull_z, 0.0])
        self._velocity = self._after_contact(free, step.dt_s)
        self._place += 0.5 * step.dt_s * self._velocity

    def pose(self) -> Pose:
        return Pose(*self._place.tolist(), float(self._velocity[2]))

    def fault(self) -> str:
        return ""

    def close(self) -> None:
        pass

    def _after_contact(self, free: np.ndarray, dt_s: float) -> np.ndarray:
        """Return the velocity that the corners leave of `free`."""
        sine, cosine = np.sin(self._place[2]), np.cos(self._place[2])
        x, z = np.array([[cosine, sine], [-sine, cosine]]) @ self._corners.T
        zero, one = np.zeros(2), np.ones(2)
        ups = np.stack([zero, one, -x], axis=1)  # times the velocity: a corner's, up
        alongs = np.stack([one, zero, z], axis=1)  # and along the base
        gaps = self._place[1] + z
        least = np.where(gaps > 0.0, -gaps / dt_s if self._s.closing else -np.inf, 0.0)
        slack, tried = SLACK * float(np.abs(free).max()), []
        for way in (self._way, *WAYS):
            velocity, contradiction = self._go(way, free, ups, alongs, least)
            tried.append((contradiction, way, velocity))
            if contradiction <= slack:
                break
        _, self._way, velocity = min(tried, key=lambda trial: trial[0])
        return velocity

    def _go(
        self,
        way: tuple[tuple[int, ...], int],
        free: np.ndarray,
        ups: np.ndarray,
        alongs: np.ndarray,
        least: np.ndarray,
    ) -> tuple[np.ndarray, float]:
        """Return the velocity if the corners go a way, and by how much that contradicts itself."""
        touching, slides = list(way[0]), way[1]
        if not np.isfinite(least[touching]).all():
            return free, np.inf
        velocity, limits = free, []
        if touching:
            told, wanted, mu = ups[touching], least[touching], self._s.friction
            pushes = told - slides * mu * alongs[touching]
            if not slides:  # two corners stick by one force along the base
                told = pushes = np.vstack([told, alongs[touching[0]]])
                wanted = np.append(wanted, 0.0)
            changes = pushes * self._light
            impulses = np.linalg.solve(told @ changes.T, wanted - told @ free)
            velocity = free + impulses @ changes
            press, slip = impulses[: len(touching)], float(alongs[touching[0]] @ velocity)
            grip = slides * slip if slides else mu * press.sum() - abs(impulses[-1])
            limits = [*(press * self._light[0]), grip if slides else grip * self._light[0]]
        return velocity, -min(*limits, *(ups @ velocity - least), 0.0)


TUNED = MoreauSettings(friction=10.0, closing=True)

ENGINE = Engine(
    name="moreau",
    title="Moreau",
    library="numpy",
    packages=("rocking-moreau",),
    install="rocking-moreau",
    build=MoreauWorld,
    presets=(
        Preset(
            name="naive",
            title="gaps closed late",
            settings=MoreauSettings(),
            step_s=2e-3,
            step_source="a choice of its own",
        ),
        Preset(name="fixed", title="best at a fixed step", settings=TUNED, step=2.5e-4),
        Preset(
            name="landing",
            title="steps that land on impacts",
            settings=TUNED,
            stepping=Stepping.LANDING,
            helped_by={Help.STEPS: None},
        ),
    ),
    frames=("base",),
    geometries=("corners",),
    factors=(factor("closing"), factor("friction", level("1", friction=1.0))),
)
