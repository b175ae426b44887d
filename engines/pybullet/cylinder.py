"""PyBullet: a cylinder in space, whose rim is the true one."""

from typing import Any

from engines.pybullet.build import given_back, held_for_all, taken
from engines.pybullet.calls import Call, Constant, base_call, body_call, engine_call
from engines.pybullet.settings import BulletSettings


class BulletCylinder:
    """A body with one shape, on a plane."""

    def __init__(self, scene: Any, s: BulletSettings, dt_s: float) -> None:
        it = scene.cylinder
        self._p, self._client = taken()
        with held_for_all:
            self._make(engine_call(scene, s, dt_s))
            self._p.setTimeStep(dt_s, physicsClientId=self._client)
            self._p.setGravity(0.0, 0.0, -scene.gravity, physicsClientId=self._client)
            plane = self._shape("GEOM_PLANE", planeNormal=(0.0, 0.0, 1.0))
            # a base that is a multibody, as of blocks
            base = self._make(Call("createMultiBody", {"baseCollisionShapeIndex": plane}))
            round_ = self._shape("GEOM_CYLINDER", radius=it.radius, height=it.height)
            w, *xyz = it.turn
            body = {
                "baseMass": it.mass,
                "baseCollisionShapeIndex": round_,
                "basePosition": it.place,
                "baseOrientation": (*xyz, w),
                "useMaximalCoordinates": not s.multibody,
            }
            self._body = self._make(Call("createMultiBody", body))
            self._make(base_call(s, base))
            self._make(body_call(scene, 0, s, self._body))
            speeds = {"linearVelocity": it.velocity, "angularVelocity": it.spin}
            self._make(Call("resetBaseVelocity", {"objectUniqueId": self._body, **speeds}))

    def step(self) -> None:
        """Advance by a step."""
        self._p.stepSimulation(physicsClientId=self._client)

    def state(self) -> Any:
        """Read the state back."""
        at = self._p.getBasePositionAndOrientation(self._body, physicsClientId=self._client)
        place, (x, y, z, w) = at
        return place, (w, x, y, z), *self._p.getBaseVelocity(self._body, self._client)

    def fault(self) -> str:
        """Say nothing: what the library is told is what blocks are held to."""
        return ""

    def close(self) -> None:
        """Release the engine's memory."""
        given_back(self._p, self._client)

    def _shape(self, kind: str, **sizes: Any) -> Any:
        return self._make(Call("createCollisionShape", {"shapeType": Constant(kind), **sizes}))

    def _make(self, call: Call) -> Any:
        told = {
            name: getattr(self._p, value) if isinstance(value, Constant) else value
            for name, value in call.arguments.items()
        }
        return getattr(self._p, call.name)(**told, physicsClientId=self._client)
