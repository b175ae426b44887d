"""Newton (Warp): how a scene is set, stepped and read back, on the CPU.

A step is dozens of short kernels: they are recorded once, with the step's length, and replayed.
The library compiles them when they are first used on a machine, for minutes, and keeps them there.
"""

import math

from engines.declaration import Precision
from engines.newton.models import given_back, numbers, prepared, taken, values
from engines.newton.settings import NewtonSettings
from engines.parts import imported, silence
from engines.run.export import Notes
from engines.scene import Scene
from engines.settings import disagreement
from engines.world import Moment, Pose, Script, Step


class NewtonWorld:
    """A block in space, on a plane that does not move, or on a kinematic one."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: NewtonSettings, dt_s: float) -> None:
        self._s, self._dt = settings, dt_s
        self._mass, self._gravity = scene.bodies[0].mass, scene.system.gravity
        newton, self._warp = imported("newton"), imported("warp")
        self._warp.config.log_level = self._warp.LOG_ERROR
        with silence():
            self._recorded = taken(newton, self._warp, scene, settings, dt_s)
        self._graph, self._force = self._recorded.graph, self._recorded.force
        self._place, self._velocity = self._recorded.place, self._recorded.velocity
        self._moving = scene.frame == "world"
        if self._moving:
            self.lag_m = 0.0
        self._put(scene)
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step, of which all are equal."""
        if step.dt_s != self._dt:
            self._fault = self._fault or "its steps are recorded, and all of one length"
        self._force[0, 0] = self._mass * step.pull_x
        self._force[0, 2] = self._mass * (step.pull_z + self._gravity)
        if self._moving:
            speed = step.base_velocity if self._s.floor == "velocity" else 0.0
            self._recorded.joint_q[-1], self._recorded.joint_qd[-1] = step.base_x, speed
        self._warp.capture_launch(self._graph)
        if self._moving:
            self.lag_m = max(self.lag_m, abs(float(self._place[1, 0]) - step.base_x))

    def state(self) -> tuple[Pose]:
        """Read the block's pose back."""
        x, _, z, _, turn_y, _, turn_w = self._place[0].tolist()
        if self._moving:
            x -= float(self._place[1, 0])
        theta = 2.0 * math.atan2(turn_y, turn_w)
        return (Pose(x, z, theta, float(self._velocity[0, 4])),)

    def fault(self) -> str:
        """Say which setting was not taken, or that a step was not the one that is recorded."""
        return self._fault

    def close(self) -> None:
        """Leave the engine's memory to the next run of the same block."""
        given_back(self._recorded)

    def _put(self, scene: Scene) -> None:
        """Let the block set out from where the scene begins."""
        at = scene.bodies[0].at
        half = 0.5 * at.theta
        self._place[0] = (at.x, 0.0, at.z, 0.0, math.sin(half), 0.0, math.cos(half))
        self._velocity[0] = (at.velocity_x, 0.0, at.velocity_z, 0.0, at.rate, 0.0)
        if self._moving:
            self._place[1, 0] = 0.0

    def _read_back(self, scene: Scene) -> str:
        model, (body,) = self._recorded.model, scene.bodies
        pairs = {
            "mass": (body.mass, float(model.body_mass.numpy()[0])),
            "moment": (body.inertia[1], float(model.body_inertia.numpy()[0, 1, 1])),
            "friction": (self._s.friction, min(model.shape_material_mu.numpy().tolist())),
        }
        return disagreement(pairs, Precision.SINGLE.value)


def script(scene: Scene, settings: NewtonSettings, dt_s: float) -> Script:
    """Return a scene as calls of Newton; see `engines.run.export`."""
    if scene.stacked:
        raise ValueError("Newton's bodies that rest on others are not written out")
    n, at, notes = numbers(scene, settings), scene.bodies[0].at, Notes()
    newton, warp = (notes.of(imported(name), name) for name in ("newton", "warp"))
    with silence():
        made = prepared(newton, warp, n, values(scene, settings, dt_s))
    names = "model", "solver", "pipeline", "contacts", "now", "after"
    notes.name(**dict(zip(names, made, strict=True)))
    led = ("    newton.eval_fk(model, now.joint_q, now.joint_qd, now, body_flag_filter=kinematic)",)
    half = 0.5 * at.theta
    place = at.x, 0.0, at.z, 0.0, math.sin(half), 0.0, math.cos(half)
    views = {"force": "body_f", "place": "body_q", "velocity": "body_qd"}
    views |= {"joint_q": "joint_q", "joint_qd": "joint_qd"} if n.moving else {}
    return Script(
        imports=("import newton", "import warp"),
        settings=notes.quoted("Solver", "default_shape_cfg.", "config", "rigid_contact_max"),
        build=(
            *notes.lines(),
            *("kinematic = newton.BodyFlags.KINEMATIC",) * n.moving,
            *("", "", "def advance():", '    """Take a step."""', *led * n.moving),
            "    pipeline.collide(now, contacts)",
            f"    solver.step(now, after, None, contacts, {dt_s!r})",
            *("    now.assign(after)", "", ""),
            "advance()  # compiles its kernels",
            'with warp.ScopedCapture(device="cpu") as recorded:',
            "    advance()",
            *(f"{name} = now.{view}.numpy()" for name, view in views.items()),
            "solver.reset(now)",
            f"place[0] = {place}",
            f"velocity[0] = {(at.velocity_x, 0.0, at.velocity_z, 0.0, at.rate, 0.0)}",
        ),
        step=(
            f"force[0, 0] = {n.mass!r} * pull_x",
            f"force[0, 2] = {n.mass!r} * (pull_z + GRAVITY)",
            *("joint_q[-1], joint_qd[-1] = base_x, base_velocity",) * n.moving,
            "warp.capture_launch(recorded.graph)",
        ),
        pose=(
            "theta = 2.0 * math.atan2(float(place[0, 4]), float(place[0, 6]))",
            "rate = float(velocity[0, 4])",
        ),
        place="float(place[0, 0])" + " - float(place[1, 0])" * n.moving,
    )
