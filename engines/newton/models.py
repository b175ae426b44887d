"""Newton's models, each with a step that is recorded once and replayed, run after run.

To make one takes as long as hundreds of its steps: it is kept for the next run of the same block,
which sets out from where its own scene begins.
"""

from collections import OrderedDict
from typing import Any, NamedTuple

from engines.newton.settings import XPBD, NewtonSettings
from engines.parts.shapes import corner_spheres, half_size
from engines.scene import Scene

MOST_CONTACTS = 4
"""Room for so many contacts, a block having four corners at its base; by its own estimate the
library solves for hundreds in every step."""

MOST_IDLE = 8
"""Models kept for later runs."""


class Made(NamedTuple):
    """What a model and its step are made of."""

    settings: NewtonSettings
    dt_s: float
    size: tuple[float, float, float]
    density: float
    gravity: float


class Recorded:
    """A model, its solver, and a step of it.

    Parameters
    ----------
    newton, warp : module
    scene : Scene
    settings : NewtonSettings
    dt_s : float
        Length of the step [s].
    """

    def __init__(
        self, newton: Any, warp: Any, scene: Scene, settings: NewtonSettings, dt_s: float
    ) -> None:
        self.made_of = made_of(scene, settings, dt_s)
        self.settings, self._dt = settings, dt_s
        self._newton, self._warp = newton, warp
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, -scene.block.gravity))
        if settings.solver != XPBD:
            newton.solvers.SolverKamino.register_custom_attributes(builder)
        builder.default_shape_cfg.mu = settings.friction
        builder.add_ground_plane()
        self._add_block(scene, builder)
        self.model = builder.finalize(device="cpu")
        self.model.rigid_contact_max = MOST_CONTACTS
        self._pipeline = newton.CollisionPipeline(self.model, rigid_contact_max=MOST_CONTACTS)
        self._contacts = self._pipeline.contacts()
        self._solver = self._add_solver(scene)
        self._now, self._next = self.model.state(), self.model.state()
        # on the CPU these are views of the library's own memory
        self.force = self._now.body_f.numpy()
        self.place, self.velocity = self._now.body_q.numpy(), self._now.body_qd.numpy()
        self._advance()  # so that its kernels are compiled
        with warp.ScopedCapture(device="cpu") as recorded:
            self._advance()
        self.graph = recorded.graph

    def put_back(self) -> None:
        """Let the solver forget the last run; the block is put where it begins by who takes it."""
        self._solver.reset(self._now)

    def _advance(self) -> None:
        self._pipeline.collide(self._now, self._contacts)
        self._solver.step(self._now, self._next, None, self._contacts, self._dt)
        self._now.assign(self._next)

    def _add_block(self, scene: Scene, builder: Any) -> None:
        s, (x, y, z) = self.settings, half_size(scene)
        at = self._warp.transform((0.0, 0.0, z), (0.0, 0.0, 0.0, 1.0))
        shape = builder.default_shape_cfg.copy()
        if s.geometry == "box":
            shape.density = scene.density
            builder.add_shape_box(builder.add_body(xform=at), hx=x, hy=y, hz=z, cfg=shape)
            return
        shape.density = 0.0
        first, second, third = scene.inertia
        inertia = self._warp.mat33(first, 0.0, 0.0, 0.0, second, 0.0, 0.0, 0.0, third)
        body = builder.add_body(xform=at, mass=scene.mass, inertia=inertia, lock_inertia=True)
        radius = s.corner_radius * scene.block.width
        for corner in corner_spheres(scene, radius, planar=False):
            place = self._warp.transform(corner, (0.0, 0.0, 0.0, 1.0))
            builder.add_shape_sphere(body, xform=place, radius=radius, cfg=shape)

    def _add_solver(self, scene: Scene) -> Any:
        s, solvers = self.settings, self._newton.solvers
        wanted = s.of_solver(scene)
        if s.solver == XPBD:
            return solvers.SolverXPBD(self.model, **wanted)
        config = solvers.SolverKamino.Config.from_model(self.model, dynamics_solver=s.solver)
        for name, value in wanted.items():
            part, _, number = name.partition(".")
            setattr(getattr(config, part), number, value)
        return solvers.SolverKamino(self.model, config=config)


idle: "OrderedDict[Made, Recorded]" = OrderedDict()
"""Models of this process whose run has ended, by what they are made of."""


def made_of(scene: Scene, settings: NewtonSettings, dt_s: float) -> Made:
    """Return what the model of a scene is made of; where the scene begins is none of it."""
    return Made(settings, dt_s, half_size(scene), scene.density, scene.block.gravity)


def taken(newton: Any, warp: Any, scene: Scene, settings: NewtonSettings, dt_s: float) -> Recorded:
    """Return a model that no other run uses, as good as new."""
    recorded = idle.pop(made_of(scene, settings, dt_s), None)
    recorded = recorded or Recorded(newton, warp, scene, settings, dt_s)
    recorded.put_back()
    return recorded


def given_back(recorded: Recorded) -> None:
    """Keep a model for the next run."""
    idle[recorded.made_of] = recorded
    if len(idle) > MOST_IDLE:
        idle.popitem(last=False)
