"""A small engine of another package: Moreau's time stepping of a planar block on two corners.

Positions move half a step, impulses change the velocity there, positions move the other half (J. J.
Moreau 1988). The impulses are exact: of the ways in which two corners can hold, slide or be open,
the one is taken that contradicts nothing. An impact is plastic, friction is Coulomb's.
"""

import itertools
import math
from collections.abc import Sequence
from dataclasses import dataclass

from engines.declaration import Citation, Engine, Help, Preset, Stepping, factor, level
from engines.scene import Scene
from engines.settings import check, setting
from engines.world import Moment, Pose, Step

SLACK = 1e-12
"""What rounding may contradict, relative to the velocities."""

WAYS = (((), 0), *itertools.product(((0,), (1,), (0, 1)), (0, 1, -1)))
"""Which corners touch, and whether they stick (0) or slide, to which side."""


Triple = tuple[float, float, float]
"""Along the base, up, and about the corner: plain numbers, as so few are faster than arrays."""


def dot(a: Sequence[float], b: Sequence[float]) -> float:
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]


def moved(a: Triple, by: float, b: Sequence[float]) -> Triple:
    return a[0] + by * b[0], a[1] + by * b[1], a[2] + by * b[2]


def solved(matrix: list[list[float]], right: list[float]) -> list[float]:
    """Solve up to three linear equations, by elimination with the largest pivots."""
    rows = [[*row, value] for row, value in zip(matrix, right, strict=True)]
    for i in range(len(rows)):
        rows[i:] = sorted(rows[i:], key=lambda row: -abs(row[i]))
        for j in range(len(rows)):
            if j != i:
                part = rows[j][i] / rows[i][i]
                rows[j] = [a - part * b for a, b in zip(rows[j], rows[i], strict=True)]
    return [row[-1] / row[i] for i, row in enumerate(rows)]


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
        (body,) = scene.bodies
        at = body.at
        self._s, self._way = settings, ((0, 1), 0)
        self._place = (at.x, at.z, at.theta)
        self._velocity = (at.velocity_x, at.velocity_z, at.rate)
        self._light = (1.0 / body.mass, 1.0 / body.mass, 1.0 / body.inertia[1])
        x, z = 0.5 * body.width, 0.5 * body.height
        self._corners = ((-x, -z), (x, -z))

    def step(self, step: Step) -> None:
        self._place = moved(self._place, 0.5 * step.dt_s, self._velocity)
        free = moved(self._velocity, step.dt_s, (step.pull_x, step.pull_z, 0.0))
        self._velocity = self._after_contact(free, step.dt_s)
        self._place = moved(self._place, 0.5 * step.dt_s, self._velocity)

    def state(self) -> list[Pose]:
        return [Pose(*self._place, self._velocity[2])]

    def fault(self) -> str:
        return ""

    def close(self) -> None:
        pass

    def _after_contact(self, free: Triple, dt_s: float) -> Triple:
        """Return the velocity that the corners leave of `free`."""
        sine, cosine = math.sin(self._place[2]), math.cos(self._place[2])
        ups, alongs, least = [], [], []
        for across, upward in self._corners:
            x, z = cosine * across + sine * upward, cosine * upward - sine * across
            ups.append((0.0, 1.0, -x))  # times the velocity: a corner's, up
            alongs.append((1.0, 0.0, z))  # and along the base
            gap = self._place[1] + z
            late = -gap / dt_s if self._s.closing else -math.inf
            least.append(late if gap > 0.0 else 0.0)
        slack, tried = SLACK * max(map(abs, free)), []
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
        free: Triple,
        ups: list[Triple],
        alongs: list[Triple],
        least: list[float],
    ) -> tuple[Triple, float]:
        """Return the velocity if the corners go a way, and by how much that contradicts itself."""
        touching, slides = way
        wanted = [least[i] for i in touching]
        if -math.inf in wanted:
            return free, math.inf
        velocity, limits = free, [0.0]
        if touching:
            told, along, mu = [ups[i] for i in touching], alongs[touching[0]], self._s.friction
            pushes = [moved(ups[i], -slides * mu, alongs[i]) for i in touching]
            if not slides:  # two corners stick by one force along the base
                told = pushes = [*told, along]
                wanted.append(0.0)
            heavy = [[a * b for a, b in zip(push, self._light, strict=True)] for push in pushes]
            impulses = solved(
                [[dot(one, other) for other in heavy] for one in told],
                [least - dot(one, free) for one, least in zip(told, wanted, strict=True)],
            )
            for impulse, change in zip(impulses, heavy, strict=True):
                velocity = moved(velocity, impulse, change)
            press = impulses[: len(touching)]
            limits += [impulse * self._light[0] for impulse in press]
            if slides:
                limits.append(slides * dot(along, velocity))
            else:
                limits.append((mu * sum(press) - abs(impulses[-1])) * self._light[0])
        limits += [dot(up, velocity) - needed for up, needed in zip(ups, least, strict=True)]
        return velocity, -min(limits)


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
            documented=(Citation("step", "0.002 s", "a choice of its own"),),
        ),
        Preset(name="fixed", settings=TUNED, step=2.5e-4),
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
