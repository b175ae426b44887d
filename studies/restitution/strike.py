"""A block that turns about one corner and strikes its base with the other: what it keeps.

At the impact an impulse acts on the striking corner alone. Held by friction, that corner goes on
without sliding, and upwards with e times the speed 2 b omega of its approach, b being half the
width. The moment of momentum about it is kept:

    (4/3) m R^2 omega = (4/3) m R^2 omega' + 2 m b^2 (1 + e) omega

so that omega'/omega = 1 - (3/2) (1 + e) sin(alpha)^2, which for e = 0 is Housner's. The other
corner leaves the base with 2 b omega (omega'/omega + e), upwards as long as sin(alpha)^2 < 2/3, so
that there is no impulse on it.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple, cast

from analytic.block import RigidBlock
from analytic.checks import positive
from analytic.motion import SinePulse
from engines.declaration import Engine
from engines.run.drive import build
from engines.scene import Scene
from engines.world import ContactPhase, Pose, Step, SteppedWorld
from studies.restitution.ways import Way

AHEAD = 20
"""Whole steps from the start to the step of the impact."""

PATIENCE = 40
"""Steps after the impact within which the corner must come off the base again; else it stays."""

RISING = 0.01
"""A corner that comes off with less than this part of the speed of its approach stays."""

STILL = SinePulse(amplitude=0.0, omega=1.0, half_cycles=1)


@dataclass(frozen=True, slots=True, kw_only=True)
class Strike:
    """A block that strikes its base with a corner.

    Attributes
    ----------
    restitution : float
        Speed of the corner after over before that is wanted, from 0 to 1.
    rate : float
        Angular rate at the impact, over p alpha.
    height : float
        [m].
    aspect : float
        H/B.
    step : float
        p dt.
    phase : float
        Part of a step after which the corner meets the base.

    Raises
    ------
    ValueError
        If a value is not allowed.
    """

    restitution: float
    rate: float = 0.5
    height: float = 1.0
    aspect: float = 2.0
    step: float = 1e-3
    phase: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 <= self.restitution <= 1.0:
            raise ValueError(f"restitution is {self.restitution!r}; it must be from 0 to 1")
        for name in ("rate", "height", "aspect", "step"):
            positive(name, getattr(self, name))
        if self._rate_squared(self.start_tilt) <= 0.0:
            raise ValueError(f"rate is {self.rate!r}; it must be larger at a step of {self.step!r}")

    @property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=self.height / self.aspect, height=self.height)

    @property
    def dt_s(self) -> float:
        """Step [s]."""
        return self.step / self.block.p

    @property
    def omega(self) -> float:
        """Angular rate at the impact [rad/s]."""
        return self.rate * self.block.p * self.block.alpha

    @property
    def start_tilt(self) -> float:
        """Tilt [rad] from which it sets out, some steps before the impact."""
        return (AHEAD + self.phase) * self.rate * self.block.alpha * self.step

    @property
    def kept(self) -> float:
        """Angular rate after over before the impact, by the moment of momentum."""
        return 1.0 - 1.5 * (1.0 + self.restitution) * math.sin(self.block.alpha) ** 2

    def scene(self, way: Way) -> Scene:
        """Return the scene at the start, in the preset "fixed" but for what the way sets."""
        tilt = self.start_tilt
        return Scene(
            system=self.block,
            motion=STILL,
            start=(-tilt, math.sqrt(self._rate_squared(tilt))),
            preset="fixed",
            step=self.step,
            settings=way.settings(self.restitution, self.dt_s),
        )

    def at_level(self, pose: Pose) -> float:
        """Return the rate [rad/s] that a block had at zero tilt if it has turned about a corner."""
        block, tilt = self.block, abs(pose.theta)
        fall = math.cos(block.alpha - tilt) - math.cos(block.alpha)
        return math.sqrt(pose.rate**2 + 2.0 * block.p**2 * fall)

    def _rate_squared(self, tilt: float) -> float:
        """Return the squared rate [rad2/s2] at a tilt before the impact."""
        block = self.block
        rise = math.cos(block.alpha - tilt) - math.cos(block.alpha)
        return self.omega**2 - 2.0 * block.p**2 * rise


class Struck(NamedTuple):
    """What came of a strike; all nan where the library says that it went wrong.

    Angular rate after over before; speeds of the striking corner, upwards and along the base, over
    that of its approach.
    """

    rate_ratio: float
    corner_ratio: float
    slide_ratio: float


def strike(engine: Engine, asked: Strike, way: Way) -> Struck:
    """Let a block strike its base in an engine's preset "fixed".

    Where the corner comes off, the block flies, and its rate is read there; where it stays, the
    block turns about it, and its rate is taken back to the impact.

    Parameters
    ----------
    engine : Engine
    asked : Strike
    way : Way
        How its coefficient is asked for.

    Raises
    ------
    NotAvailableError
        If the library is not installed.
    """
    scene = asked.scene(way)
    world = cast(SteppedWorld, build(engine, scene))
    try:
        found = _watched(world, asked, scene)
        return Struck(math.nan, math.nan, math.nan) if world.fault() else found
    finally:
        world.close()


def _watched(world: SteppedWorld, asked: Strike, scene: Scene) -> Struck:
    half_width, half_height = 0.5 * scene.system.width, 0.5 * scene.system.height
    dt = asked.dt_s
    approach = 2.0 * half_width * asked.omega

    def corner(pose: Pose) -> tuple[float, float]:
        """Return where the striking corner is along and above the base [m]."""
        sine, cosine = math.sin(pose.theta), math.cos(pose.theta)
        along = pose.x + half_width * cosine - half_height * sine
        return along, pose.z - half_width * sine - half_height * cosine

    pose, kick, slide = Pose(*world.state()[0]), world.moment.value * dt, 0.0
    for number in range(AHEAD + 1 + PATIENCE):
        (x, z), end = corner(pose), (number + 1) * dt
        pull = -scene.system.gravity * kick / dt
        world.step(Step(dt, end, kick, 0.0, pull, 0.0, 0.0, 0.0, ContactPhase.SWING, 0.0))
        pose, kick = Pose(*world.state()[0]), dt
        new_x, new_z = corner(pose)
        rise, slide = (new_z - z) / dt / approach, (new_x - x) / dt / approach
        if z > 0.0 and rise > RISING:
            return Struck(pose.rate / asked.omega, rise, slide)
    return Struck(math.copysign(asked.at_level(pose), pose.rate) / asked.omega, 0.0, slide)
