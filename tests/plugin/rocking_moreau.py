"""A small engine of another package: Moreau's time stepping of a planar block on two corners.

Positions move half a step, impulses change the velocity there, positions move the other half (J. J.
Moreau 1988). The impulses are exact: of the ways in which two corners can hold, slide or be open,
the one is taken that contradicts nothing. An impact is plastic, friction is Coulomb's.
"""

import itertools
import math
from dataclasses import dataclass

import numpy as np

from engines.declaration import Citation, Engine, Help, Preset, Stepping, factor, level
from engines.settings import check, setting
from engines.world import Moment

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

    def __init__(self, scene, settings: MoreauSettings, dt_s):
        (body,) = scene.bodies
        at = body.at
        self._s, self._way = settings, ((0, 1), 0)
        self._place = np.array([at.x, at.z, at.theta])
        self._velocity = np.array([at.velocity_x, at.velocity_z, at.rate])
        self._light = 1.0 / np.array([body.mass, body.mass, body.inertia[1]])
        x, z = 0.5 * body.width, 0.5 * body.height
        self._corners = ((-x, -z), (x, -z))

    def step(self, step):
        middle = self._place + 0.5 * step.dt_s * self._velocity
        free = self._velocity + step.dt_s * np.array([step.pull_x, step.pull_z, 0.0])
        self._velocity = self._after_contact(middle, free, step.dt_s)
        self._place = middle + 0.5 * step.dt_s * self._velocity

    def state(self):
        return [(*self._place, self._velocity[2])]

    def fault(self):
        return ""

    close = fault

    def _after_contact(self, place, free, dt_s):
        """Return the velocity that the corners leave of `free`."""
        sine, cosine = math.sin(place[2]), math.cos(place[2])
        ups, alongs, least = [], [], []
        for across, upward in self._corners:
            x, z = cosine * across + sine * upward, cosine * upward - sine * across
            ups.append([0.0, 1.0, -x])  # times the velocity: a corner's, up
            alongs.append([1.0, 0.0, z])  # and along the base
            gap = place[1] + z
            least.append(0.0 if gap <= 0.0 else -gap / dt_s if self._s.closing else -math.inf)
        known, tried = (free, np.array(ups), np.array(alongs), np.array(least)), []
        for way in (self._way, *WAYS):
            velocity, contradiction = self._go(way, *known)
            tried.append((contradiction, way, velocity))
            if contradiction <= SLACK * abs(free).max():
                break
        _, self._way, velocity = min(tried, key=lambda trial: trial[0])
        return velocity

    def _go(self, way, free, ups, alongs, least):
        """Return the velocity if the corners go a way, and by how much that contradicts itself."""
        touching, slides = list(way[0]), way[1]
        wanted, mu = least[touching], self._s.friction
        if -math.inf in wanted:
            return free, math.inf
        velocity, limits = free, np.array([0.0])
        if touching:
            told, along = ups[touching], alongs[touching[0]]
            pushes = told - slides * mu * alongs[touching]
            if not slides:  # two corners stick by one force along the base
                told = pushes = np.vstack((told, along))
                wanted = np.append(wanted, 0.0)
            heavy = pushes * self._light
            impulses = np.linalg.solve(told @ heavy.T, wanted - told @ free)
            velocity = free + impulses @ heavy
            press = impulses[: len(touching)]
            held = (
                slides * along @ velocity
                if slides
                else ((mu * press.sum() - abs(impulses[-1])) * self._light[0])
            )
            limits = np.append(press * self._light[0], held)
        return velocity, -min(0.0, *limits, *(ups @ velocity - least))


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
            name="default",
            title="gaps closed late",
            settings=MoreauSettings(),
            step_s=2e-3,
            documented=(Citation("step", "0.002 s", "a choice of its own"),),
        ),
        Preset(name="tuned", settings=TUNED, step=2.5e-4),
        Preset(
            name="landing",
            settings=TUNED,
            stepping=Stepping.LANDING,
            helped_by={Help.STEPS: None},
        ),
    ),
    frames=("base",),
    factors=(factor("closing"), factor("friction", level("1", friction=1.0))),
)
