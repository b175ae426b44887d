"""A sphere dropped on a plane in PyBullet: its coefficient of restitution."""

from typing import Any

from engines.parts.drop import Bouncing, Drop, rebound
from engines.parts.quiet import imported
from engines.pybullet.settings import LIBRARY_BREAKING_THRESHOLD

AT_ALL_SPEEDS = {"restitutionVelocityThreshold": 0.0}
TOUCHING = {**AT_ALL_SPEEDS, "contactBreakingThreshold": 1e-9}
"""The solver slows what is nearer than this gap, and gives it back of its slower speed."""
UNCORRECTED = {**TOUCHING, "contactERP": 0.0}
"""A depth that is corrected adds to the speed."""


FAST = {"restitution_threshold": 0.0}
NEAR = {"breaking_threshold": 1e-9}
"""The same for a block."""


def _dropped(drop: Drop, base: float, **engine: Any) -> float:
    """Drop a sphere; base is the plane's coefficient, the rest engine parameters."""
    p = imported("pybullet")
    client = p.connect(p.DIRECT)
    try:
        p.setTimeStep(drop.dt_s, physicsClientId=client)
        p.setGravity(0.0, 0.0, -drop.gravity, physicsClientId=client)
        if engine:
            p.setPhysicsEngineParameter(**engine, physicsClientId=client)
        plane = p.createCollisionShape(p.GEOM_PLANE, physicsClientId=client)
        ball = p.createCollisionShape(p.GEOM_SPHERE, radius=drop.radius, physicsClientId=client)
        floor = p.createMultiBody(0.0, plane, physicsClientId=client)
        place = (0.0, 0.0, drop.radius + drop.height)
        body = p.createMultiBody(drop.mass, ball, basePosition=place, physicsClientId=client)
        p.changeDynamics(floor, -1, restitution=base, physicsClientId=client)
        p.changeDynamics(
            body, -1, restitution=drop.restitution, linearDamping=0.0, physicsClientId=client
        )
        p.resetBaseVelocity(body, (0.0, 0.0, -drop.speed), physicsClientId=client)

        def step() -> tuple[float, float]:
            p.stepSimulation(physicsClientId=client)
            height = p.getBasePositionAndOrientation(body, physicsClientId=client)[0][2]
            velocity = p.getBaseVelocity(body, physicsClientId=client)[0][2]
            return height - drop.radius, velocity

        return rebound(drop, step)
    finally:
        # the library holds this one for the whole process
        p.setPhysicsEngineParameter(
            contactBreakingThreshold=LIBRARY_BREAKING_THRESHOLD, physicsClientId=client
        )
        p.disconnect(client)


def _sphere(drop: Drop) -> str:
    return f"changeDynamics(sphere, -1, restitution={drop.restitution:g}, linearDamping=0)"


def _both(drop: Drop) -> str:
    return f"changeDynamics(plane, -1, restitution=1), {_sphere(drop)}"


def _engine(**engine: Any) -> str:
    return f"setPhysicsEngineParameter({', '.join(f'{k}={v:g}' for k, v in engine.items())})"


BOUNCING = (
    Bouncing(
        name="e on the body alone",
        setting=_sphere,
        dropped=lambda drop: _dropped(drop, 0.0),
    ),
    Bouncing(
        name="e on the body, 1 on the plane",
        setting=_both,
        dropped=lambda drop: _dropped(drop, 1.0),
        block=lambda e: {"restitution": e},
    ),
    Bouncing(
        name="and at all speeds",
        setting=lambda drop: f"{_both(drop)}, {_engine(**AT_ALL_SPEEDS)}",
        dropped=lambda drop: _dropped(drop, 1.0, **AT_ALL_SPEEDS),
        block=lambda e: {"restitution": e, **FAST},
    ),
    Bouncing(
        name="and where they touch alone",
        setting=lambda drop: f"{_both(drop)}, {_engine(**TOUCHING)}",
        dropped=lambda drop: _dropped(drop, 1.0, **TOUCHING),
        block=lambda e: {"restitution": e, **FAST, **NEAR},
    ),
    Bouncing(
        name="and no depth is corrected",
        setting=lambda drop: f"{_both(drop)}, {_engine(**UNCORRECTED)}",
        dropped=lambda drop: _dropped(drop, 1.0, **UNCORRECTED),
        block=lambda e: {"restitution": e, **FAST, **NEAR, "contact_erp": 0.0},
    ),
)
"""The library takes the product of two bodies' coefficients; each way adds to the one before."""
