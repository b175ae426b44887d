"""Newton (Warp): how a scene is built, set, stepped and read back, on the CPU.

A step is a hundred short kernels: they are recorded once, with the step's length, and replayed.
The library compiles them when they are first used on a machine, for minutes, and keeps them there.
"""

import math
from typing import Any

from engines.adapters.newton_settings import FACTORS, TUNED, XPBD, NewtonSettings
from engines.declaration import Engine, Precision, Preset
from engines.parts.quiet import imported, silence
from engines.parts.readback import disagreement
from engines.parts.settings import given
from engines.parts.shapes import corner_spheres, half_size
from engines.scene import Scene
from engines.world import Moment, Pose, Step

MOST_CONTACTS = 8
"""Room for so many contacts; by its own estimate the library solves for hundreds in every step."""


class NewtonWorld:
    """A block in space, on a plane that does not move."""

    moment = Moment.MIDDLE

    def __init__(self, scene: Scene, settings: NewtonSettings, dt_s: float) -> None:
        self._s, self._dt = settings, dt_s
        self._mass, self._gravity = scene.mass, scene.block.gravity
        self._newton, self._warp = imported("newton"), imported("warp")
        self._warp.config.log_level = self._warp.LOG_ERROR
        with silence():
            self._build(scene)
            self._graph = self._record()
        self._fault = self._read_back(scene)

    def step(self, step: Step) -> None:
        """Advance by a step, of which all are equal; see `engines.world.SteppedWorld`."""
        if step.dt_s != self._dt:
            self._fault = self._fault or "its steps are recorded, and all of one length"
        self._force[0, 0] = self._mass * step.pull_x
        self._force[0, 2] = self._mass * (step.pull_z + self._gravity)
        self._warp.capture_launch(self._graph)

    def pose(self) -> Pose:
        """Read the block's pose back."""
        x, _, z, _, turn_y, _, turn_w = self._place[0].tolist()
        theta = 2.0 * math.atan2(turn_y, turn_w)
        return Pose(x, z, theta, float(self._velocity[0, 4]))

    def fault(self) -> str:
        """Say which setting was not taken, or that a step was not the one that is recorded."""
        return self._fault

    def close(self) -> None:
        """Release the engine's memory."""
        self._graph = None

    def _build(self, scene: Scene) -> None:
        newton, s = self._newton, self._s
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, -self._gravity))
        if s.solver != XPBD:
            newton.solvers.SolverKamino.register_custom_attributes(builder)
        builder.default_shape_cfg.mu = s.friction
        builder.add_ground_plane()
        self._add_block(scene, builder)
        self._model = builder.finalize(device="cpu")
        self._model.rigid_contact_max = MOST_CONTACTS
        self._pipeline = newton.CollisionPipeline(self._model, rigid_contact_max=MOST_CONTACTS)
        self._contacts = self._pipeline.contacts()
        self._solver = self._add_solver(scene)
        self._now, self._next = self._model.state(), self._model.state()
        start = scene.beginning
        # on the CPU these are views of the library's own memory
        self._force = self._now.body_f.numpy()
        self._place, self._velocity = self._now.body_q.numpy(), self._now.body_qd.numpy()
        self._velocity[0] = (start.velocity_x, 0.0, start.velocity_z, 0.0, start.rate, 0.0)

    def _add_block(self, scene: Scene, builder: Any) -> None:
        s, start, (x, y, z) = self._s, scene.beginning, half_size(scene)
        turn = (0.0, math.sin(0.5 * start.theta), 0.0, math.cos(0.5 * start.theta))
        at = self._warp.transform((start.x, 0.0, start.z), turn)
        shape = builder.default_shape_cfg.copy()
        if s.geometry == "box":
            shape.density = scene.density
            builder.add_shape_box(builder.add_body(xform=at), hx=x, hy=y, hz=z, cfg=shape)
            return
        shape.density = 0.0
        inertia = self._warp.mat33(*(v for row in _diagonal(scene.inertia) for v in row))
        body = builder.add_body(xform=at, mass=scene.mass, inertia=inertia, lock_inertia=True)
        radius = s.corner_radius * scene.block.width
        for corner in corner_spheres(scene, radius, planar=False):
            place = self._warp.transform(corner, (0.0, 0.0, 0.0, 1.0))
            builder.add_shape_sphere(body, xform=place, radius=radius, cfg=shape)

    def _add_solver(self, scene: Scene) -> Any:
        s, solvers = self._s, self._newton.solvers
        if s.solver == XPBD:
            wanted = {
                "iterations": s.iterations,
                "rigid_contact_relaxation": s.relaxation,
                "rigid_contact_con_weighting": s.weighting,
            }
            return solvers.SolverXPBD(self._model, **given(wanted))
        config = solvers.SolverKamino.Config.from_model(self._model, dynamics_solver=s.solver)
        depth = None if s.depth is None else s.depth * scene.block.width
        own = {"gamma": s.baumgarte, "delta": depth}
        for name, value in given(own).items():
            setattr(config.constraints, name, value)
        if s.solver == "padmm":
            config.padmm.max_iterations = s.iterations
            if s.tolerance is not None:
                for kind in ("primal", "dual", "compl"):
                    setattr(config.padmm, f"{kind}_tolerance", s.tolerance)
        return solvers.SolverKamino(self._model, config=config)

    def _record(self) -> Any:
        """Record a step, after one that compiles its kernels and is undone."""
        beginning = self._place.copy(), self._velocity.copy()
        self._advance()
        with self._warp.ScopedCapture(device="cpu") as recorded:
            self._advance()
        self._place[:], self._velocity[:] = beginning
        return recorded.graph

    def _advance(self) -> None:
        self._pipeline.collide(self._now, self._contacts)
        self._solver.step(self._now, self._next, None, self._contacts, self._dt)
        self._now.assign(self._next)

    def _read_back(self, scene: Scene) -> str:
        frictions = self._model.shape_material_mu.numpy().tolist()
        pairs = {
            "mass": (scene.mass, float(self._model.body_mass.numpy()[0])),
            "moment": (scene.inertia[1], float(self._model.body_inertia.numpy()[0, 1, 1])),
            "friction": (self._s.friction, min(frictions)),
        }
        return disagreement(pairs, Precision.SINGLE.value)


def _diagonal(values: tuple[float, float, float]) -> list[list[float]]:
    return [[value if i == j else 0.0 for j in range(3)] for i, value in enumerate(values)]


ENGINE = Engine(
    name="newton",
    title="Newton",
    library="newton",
    packages=("newton", "warp-lang"),
    install="rocking[newton]",
    build=NewtonWorld,
    presets=(
        Preset(
            name="naive",
            title="the library's example",
            settings=NewtonSettings(),
            step_s=2e-3,
            step_source="the library's own example basic_shapes, 5 substeps of 1/100 s",
        ),
        Preset(name="fixed", settings=TUNED, step=1e-3),
    ),
    frames=("base",),
    geometries=("box", "corners"),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    factors=FACTORS,
    compiles=True,
)
