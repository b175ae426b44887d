"""Newton: bodies that rest on others, each on its own or on a plane, which may be kinematic."""

import math
from typing import Any

import numpy as np

from engines.declaration import Precision
from engines.newton.settings import NewtonSettings
from engines.parts import half_size, imported, silence, touching_spheres
from engines.scene import Body, Scene
from engines.settings import disagreement
from engines.world import FloatArray, Moment, Pose, Step

MOST_CONTACTS = 16
"""Room for so many contacts where two faces meet; by its own estimate the library takes more."""


class NewtonStacks:
    """Boxes in space, of which some rest on others, and a step of them that is recorded."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: NewtonSettings, dt_s: float) -> None:
        self._scene, self._s, self._dt = scene, settings, dt_s
        self._newton, self._warp = imported("newton"), imported("warp")
        self._warp.config.log_level = self._warp.LOG_ERROR
        self._moving = scene.frame == "world"
        if self._moving:
            self.lag_m = 0.0
        with silence():
            self._model = self._built()
            self._solver = self._solving()
            self._now, self._after = self._model.state(), self._model.state()
            self._advance()  # compiles its kernels
            with self._warp.ScopedCapture(device="cpu") as recorded:
                self._advance()
            self._solver.reset(self._now)
        self._graph, now = recorded.graph, self._now
        self._force, self._place = now.body_f.numpy(), now.body_q.numpy()  # views, on the CPU
        self._velocity, self._rail = (
            now.body_qd.numpy(),
            (now.joint_q.numpy(), now.joint_qd.numpy()),
        )
        for number, body in enumerate(scene.bodies):
            self._put(number, body)
        if self._moving:
            self._place[-1, 0] = 0.0
        self._state = np.zeros((len(scene.bodies), len(Pose._fields)))
        self._fault = self._read_back()

    def step(self, step: Step) -> None:
        """Advance by a step, of which all are equal."""
        if step.dt_s != self._dt:
            self._fault = self._fault or "its steps are recorded, and all of one length"
        for number, body in enumerate(self._scene.bodies):
            self._force[number, 0] = body.mass * step.pull_x
            self._force[number, 2] = body.mass * (step.pull_z + self._scene.system.gravity)
        if self._moving:
            speed = step.base_velocity if self._s.floor == "velocity" else 0.0
            place, rate = self._rail
            place[-1], rate[-1] = step.base_x, speed
        self._warp.capture_launch(self._graph)
        if self._moving:
            self.lag_m = max(self.lag_m, abs(float(self._place[-1, 0]) - step.base_x))

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        moved = float(self._place[-1, 0]) if self._moving else 0.0
        for number, row in enumerate(self._state):
            x, _, z, _, turn_y, _, turn_w = self._place[number].tolist()
            rate = float(self._velocity[number, 4])
            row[:] = x - moved, z, 2.0 * math.atan2(turn_y, turn_w), rate
        return self._state

    def fault(self) -> str:
        """Say which setting was not taken, or that a step was not the one that is recorded."""
        return self._fault

    def close(self) -> None:
        """Leave the engine's memory to who collects it."""

    def _built(self) -> Any:
        newton, wp, scene = self._newton, self._warp, self._scene
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, -scene.system.gravity))
        if self._s.solver != "xpbd":
            newton.solvers.SolverKamino.register_custom_attributes(builder)
        builder.default_shape_cfg.mu = float(self._s.friction)
        shape, upright = builder.default_shape_cfg.copy(), (0.0, 0.0, 0.0, 1.0)
        shape.density = 0.0
        for number, body in enumerate(scene.bodies):
            first, second, third = body.inertia
            turning = wp.mat33(first, 0.0, 0.0, 0.0, second, 0.0, 0.0, 0.0, third)
            at = wp.transform((body.home[0], 0.0, body.home[1]), upright)
            own = builder.add_body(xform=at, mass=body.mass, inertia=turning, lock_inertia=True)
            if self._s.geometry == "box" or scene.layout.rests(number):
                x, y, z = half_size(body)
                builder.add_shape_box(own, hx=x, hy=y, hz=z, cfg=shape)
                continue
            radius = self._s.corner_radius * body.width
            for corner in touching_spheres(scene, number, radius, planar=False):
                there = wp.transform(corner, upright)
                builder.add_shape_sphere(own, xform=there, radius=radius, cfg=shape)
        if self._moving:
            floor = builder.add_link(mass=1.0, inertia=wp.mat33(*np.eye(3).flat), is_kinematic=True)
            builder.add_shape_plane(body=floor, width=0.0, length=0.0, cfg=shape)
            rail = builder.add_joint_prismatic(parent=-1, child=floor, axis=newton.Axis.X)
            builder.add_articulation([rail])
        else:
            builder.add_ground_plane()
        model = builder.finalize(device="cpu")
        model.rigid_contact_max = MOST_CONTACTS * len(scene.layout.contacts)
        return model

    def _solving(self) -> Any:
        """Return the solver, and make what finds contacts."""
        newton, model, s = self._newton, self._model, self._s
        most = model.rigid_contact_max
        self._pipeline = newton.CollisionPipeline(model, rigid_contact_max=most)
        self._contacts = self._pipeline.contacts()
        if s.solver == "xpbd":
            return newton.solvers.SolverXPBD(model, **s.of_xpbd())
        kamino = newton.solvers.SolverKamino
        config = kamino.Config.from_model(model, dynamics_solver=s.solver)
        if s.baumgarte is not None:
            config.constraints.gamma = s.baumgarte
        if s.depth is not None:
            config.constraints.delta = s.depth * self._scene.system.width
        if s.solver == "padmm" and s.iterations is not None:
            config.padmm.max_iterations = s.iterations
        if s.solver == "padmm" and s.tolerance is not None:
            config.padmm.primal_tolerance = config.padmm.dual_tolerance = s.tolerance
            config.padmm.compl_tolerance = s.tolerance
        return kamino(model, config=config)

    def _advance(self) -> None:
        now, after = self._now, self._after
        if self._moving:
            only = self._newton.BodyFlags.KINEMATIC
            self._newton.eval_fk(self._model, now.joint_q, now.joint_qd, now, body_flag_filter=only)
        self._pipeline.collide(now, self._contacts)
        self._solver.step(now, after, None, self._contacts, self._dt)
        now.assign(after)

    def _put(self, number: int, body: Body) -> None:
        """Let a body set out from where the scene begins."""
        at, half = body.at, 0.5 * body.at.theta
        self._place[number] = (at.x, 0.0, at.z, 0.0, math.sin(half), 0.0, math.cos(half))
        self._velocity[number] = (at.velocity_x, 0.0, at.velocity_z, 0.0, at.rate, 0.0)

    def _read_back(self) -> str:
        mass, inertia = self._model.body_mass.numpy(), self._model.body_inertia.numpy()
        friction = min(self._model.shape_material_mu.numpy().tolist())
        pairs = {"friction": (self._s.friction, friction)}
        for number, body in enumerate(self._scene.bodies):
            pairs[f"mass {number}"] = (body.mass, float(mass[number]))
            pairs[f"moment {number}"] = (body.inertia[1], float(inertia[number, 1, 1]))
        return disagreement(pairs, Precision.SINGLE.value)
