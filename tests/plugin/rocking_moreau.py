"""A small engine of another package: Moreau's time stepping of a planar block on two corners.

Positions move half a step, impulses change the velocity there, positions move the other half (J. J.
Moreau 1988). The impulses are exact: of the ways in which two corners can hold, slide or be open,
the one is taken that contradicts nothing. An impact is plastic, friction is Coulomb's.
"""

import itertools
import math
import operator
from dataclasses import dataclass

from engines.declaration import Citation, Engine, Help, Preset, Stepping
from engines.factors import factor, level
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


def dot(one, other):
    return one[0] * other[0] + one[1] * other[1] + one[2] * other[2]


def plus(one, factor, other):
    a, b, c = one
    return a + factor * other[0], b + factor * other[1], c + factor * other[2]


def solved(rows):
    """Return what solves linear equations, each a row whose last number is its right side."""
    (pivot, *first), *others = sorted(rows, key=lambda row: -abs(row[0]))
    rest = [[a - row[0] / pivot * b for a, b in zip(row[1:], first, strict=True)] for row in others]
    known = solved(rest) if rest else []
    return [(first[-1] - sum(map(operator.mul, first, known))) / pivot, *known]


class MoreauWorld:
    moment = Moment.END

    def __init__(self, scene, settings: MoreauSettings, dt_s):
        (body,) = scene.bodies
        at = body.at
        self._s, self._way = settings, ((0, 1), 0)
        self._place = [at.x, at.z, at.theta]
        self._velocity = [at.velocity_x, at.velocity_z, at.rate]
        self._light = 1.0 / body.mass, 1.0 / body.mass, 1.0 / body.inertia[1]
        x, z = 0.5 * body.width, 0.5 * body.height
        self._corners = ((-x, -z), (x, -z))

    def step(self, step):
        middle = plus(self._place, 0.5 * step.dt_s, self._velocity)
        free = plus(self._velocity, step.dt_s, (step.pull_x, step.pull_z, 0.0))
        self._velocity = self._after_contact(middle, free, step.dt_s)
        self._place = plus(middle, 0.5 * step.dt_s, self._velocity)

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
            ups.append((0.0, 1.0, -x))  # times the velocity: a corner's, up
            alongs.append((1.0, 0.0, z))  # and along the base
            gap = place[1] + z
            least.append(0.0 if gap <= 0.0 else -gap / dt_s if self._s.closing else -math.inf)
        tried, slack = [], SLACK * max(map(abs, free))
        for way in (self._way, *WAYS):
            velocity, contradiction = self._go(way, free, ups, alongs, least)
            tried.append((contradiction, way, velocity))
            if contradiction <= slack:
                break
        _, self._way, velocity = min(tried, key=lambda trial: trial[0])
        return velocity

    def _go(self, way, free, ups, alongs, least):
        """Return the velocity if the corners go a way, and by how much that contradicts itself."""
        touching, slides = way
        wanted, mu = [least[k] for k in touching], self._s.friction
        if -math.inf in wanted:
            return free, math.inf
        velocity, limits = free, [0.0]
        if touching:
            told, along = [ups[k] for k in touching], alongs[touching[0]]
            pushes = [plus(ups[k], -slides * mu, alongs[k]) for k in touching]
            if not slides:  # two corners stick by one force along the base
                told = pushes = [*told, along]
                wanted.append(0.0)
            heavy = [list(map(operator.mul, push, self._light)) for push in pushes]
            impulses = solved(
                [
                    [*(dot(row, each) for each in heavy), goal - dot(row, free)]
                    for row, goal in zip(told, wanted, strict=True)
                ]
            )
            for impulse, each in zip(impulses, heavy, strict=True):
                velocity = plus(velocity, impulse, each)
            press = impulses[: len(touching)]
            held = (
                slides * dot(along, velocity)
                if slides
                else (mu * sum(press) - abs(impulses[-1])) * self._light[0]
            )
            limits = [held, *(push * self._light[0] for push in press)]
        free_of = (dot(up, velocity) - low for up, low in zip(ups, least, strict=True))
        return velocity, -min(0.0, *limits, *free_of)


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
        Preset(name="tuned", settings=TUNED, step=5e-4),
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
