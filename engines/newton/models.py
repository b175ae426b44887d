"""Newton's models, each with a step that is recorded once and replayed, run after run.

To make one takes as long as hundreds of its steps: it is kept for the next run of the same block,
which sets out from where its own scene begins.
"""

from collections import OrderedDict
from types import SimpleNamespace
from typing import Any, NamedTuple

from engines.newton.settings import NewtonSettings
from engines.parts import corner_spheres, half_size
from engines.scene import Scene

MOST_CONTACTS = 4
"""Room for so many contacts, a block having four corners at its base; by its own estimate the
library solves for hundreds in every step."""

MOST_IDLE = 8
"""Models kept for later runs."""


class Made(NamedTuple):
    """What a model and its step are made of.

    Attributes
    ----------
    settings : NewtonSettings
    dt_s : float
        The step [s].
    size : (float, float, float)
        Half of the block's along x, y and z [m].
    density, gravity : float
        [kg/m3], [m/s2].
    moving : bool
        Whether the base moves.
    """

    settings: NewtonSettings
    dt_s: float
    size: tuple[float, float, float]
    density: float
    gravity: float
    moving: bool


def numbers(scene: Scene, s: NewtonSettings) -> SimpleNamespace:
    """Return the numbers of a block, wherever it begins.

    Parameters
    ----------
    scene : Scene, of one body
    s : NewtonSettings

    Returns
    -------
    SimpleNamespace
        What `build` takes as n:

        - x, y, z: half sizes [m]; radius: of corner spheres [m]; corners (4, 3): about the centre
          [m];
        - mass [kg], density [kg/m3], inertia (9,) by rows [kg m2]; weight: gravity along z [m/s2],
          < 0;
        - most: room for contacts; moving: whether the base does.
    """
    (body,) = scene.bodies
    (x, y, z), radius = half_size(body), s.corner_radius * body.width
    first, second, third = body.inertia
    return SimpleNamespace(
        **{"x": x, "y": y, "z": z, "radius": radius, "most": MOST_CONTACTS},
        moving=scene.frame == "world",
        **{"mass": body.mass, "density": scene.density, "weight": -scene.system.gravity},
        inertia=(first, 0.0, 0.0, 0.0, second, 0.0, 0.0, 0.0, third),
        corners=corner_spheres(body, radius, planar=False),
    )


def values(scene: Scene, s: NewtonSettings, dt_s: float) -> SimpleNamespace:
    """Return settings as the library is given them, for steps of dt_s [s].

    Parameters
    ----------
    scene : Scene
    s : NewtonSettings
    dt_s : float, the step [s]

    Returns
    -------
    SimpleNamespace
        What `build` takes as s: dt is the step [s], delta the depth that is left alone [m], xpbd
        holds that solver's arguments, the others are as in the settings. None leaves a number to
        the library.
    """
    return SimpleNamespace(
        **{"geometry": s.geometry, "friction": float(s.friction), "dt": dt_s},
        restitution=s.restitution,
        **{"solver": s.solver, "xpbd": s.of_xpbd(), "gamma": s.baumgarte},
        delta=None if s.depth is None else s.depth * scene.system.width,
        **{"iterations": s.iterations, "tolerance": s.tolerance},
    )


def prepared(newton: Any, wp: Any, n: Any, s: Any) -> tuple[Any, ...]:
    """Build a block in space, on a plane at rest or a kinematic one; see `build`.

    Returns
    -------
    model, solver, pipeline, contacts, now, after
        A model, what solves it, what finds contacts and where it leaves them, and two states.
    """
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, n.weight))
    if s.solver != "xpbd":
        newton.solvers.SolverKamino.register_custom_attributes(builder)
    builder.default_shape_cfg.mu = s.friction
    if s.restitution is not None:
        builder.default_shape_cfg.restitution = s.restitution
    if not n.moving:
        builder.add_ground_plane()
    shape = builder.default_shape_cfg.copy()
    at = wp.transform((0.0, 0.0, n.z), (0.0, 0.0, 0.0, 1.0))
    if s.geometry == "box":
        shape.density = n.density
        builder.add_shape_box(builder.add_body(xform=at), hx=n.x, hy=n.y, hz=n.z, cfg=shape)
    else:
        shape.density = 0.0
        inertia = wp.mat33(*n.inertia)
        block = builder.add_body(xform=at, mass=n.mass, inertia=inertia, lock_inertia=True)
        for corner in n.corners:
            there = wp.transform(corner, (0.0, 0.0, 0.0, 1.0))
            builder.add_shape_sphere(block, xform=there, radius=n.radius, cfg=shape)
    if n.moving:
        shape.density = 0.0
        floor = builder.add_link(mass=n.mass, inertia=wp.mat33(*n.inertia), is_kinematic=True)
        builder.add_shape_plane(body=floor, width=0.0, length=0.0, cfg=shape)
        rail = builder.add_joint_prismatic(parent=-1, child=floor, axis=newton.Axis.X)
        builder.add_articulation([rail])
    model = builder.finalize(device="cpu")
    model.rigid_contact_max = n.most
    pipeline = newton.CollisionPipeline(model, rigid_contact_max=n.most)
    contacts = pipeline.contacts()
    if s.solver == "xpbd":
        solver = newton.solvers.SolverXPBD(model, **s.xpbd)
    else:
        kamino = newton.solvers.SolverKamino
        config = kamino.Config.from_model(model, dynamics_solver=s.solver)
        if s.gamma is not None:
            config.constraints.gamma = s.gamma
        if s.delta is not None:
            config.constraints.delta = s.delta
        if s.solver == "padmm" and s.iterations is not None:
            config.padmm.max_iterations = s.iterations
        if s.solver == "padmm" and s.tolerance is not None:
            config.padmm.primal_tolerance = config.padmm.dual_tolerance = s.tolerance
            config.padmm.compl_tolerance = s.tolerance
        solver = kamino(model, config=config)
    return model, solver, pipeline, contacts, model.state(), model.state()


def build(newton: Any, wp: Any, n: Any, s: Any) -> Any:
    """Build a block, and record a step.

    Parameters
    ----------
    newton, wp : module, newton and warp
    n : SimpleNamespace, from `numbers`
    s : SimpleNamespace, from `values`

    Returns
    -------
    model, solver, now, graph
        The model, its solver, the state that a step advances, and the step that is recorded.
    force, place, velocity : ndarray (bodies, 6), (bodies, 7), (bodies, 6)
        Views of the state in single precision, the block first, then a plane that moves: force [N]
        and moment [N m] that act; position [m] and quaternion, its real part last; velocity [m/s]
        and angular velocity [rad/s].
    joint_q, joint_qd : ndarray
        Views of the joints' coordinates; the last are place [m] and velocity [m/s] of a plane that
        moves.
    """
    model, solver, pipeline, contacts, now, after = prepared(newton, wp, n, s)
    moving = {"body_flag_filter": newton.BodyFlags.KINEMATIC}

    def advance() -> None:
        if n.moving:
            newton.eval_fk(model, now.joint_q, now.joint_qd, now, **moving)
        pipeline.collide(now, contacts)
        solver.step(now, after, None, contacts, s.dt)
        now.assign(after)

    advance()  # compiles its kernels
    with wp.ScopedCapture(device="cpu") as recorded:
        advance()
    force = now.body_f.numpy()  # on the CPU a view, as those that follow
    place, velocity = now.body_q.numpy(), now.body_qd.numpy()
    joint_q, joint_qd = now.joint_q.numpy(), now.joint_qd.numpy()
    return model, solver, now, recorded.graph, force, place, velocity, joint_q, joint_qd


class Recorded:
    """A model, its solver, and a step of it.

    Parameters
    ----------
    newton, warp : module
    scene : Scene
    settings : NewtonSettings
    dt_s : float
        Length of the step [s].

    Attributes
    ----------
    made_of : Made
        By which it is known again.
    model, graph, force, place, velocity, joint_q, joint_qd
        As `build` returns them.
    """

    def __init__(
        self, newton: Any, warp: Any, scene: Scene, settings: NewtonSettings, dt_s: float
    ) -> None:
        self.made_of = made_of(scene, settings, dt_s)
        built = build(newton, warp, numbers(scene, settings), values(scene, settings, dt_s))
        self.model, self._solver, self._now, self.graph, *views = built
        self.force, self.place, self.velocity, self.joint_q, self.joint_qd = views

    def put_back(self) -> None:
        """Let the solver forget the last run; the block is put where it begins by who takes it."""
        self._solver.reset(self._now)


idle: "OrderedDict[Made, Recorded]" = OrderedDict()
"""Models of this process whose run has ended, by what they are made of."""


def made_of(scene: Scene, settings: NewtonSettings, dt_s: float) -> Made:
    """Return what the model of a scene is made of; where the scene begins is none of it.

    Parameters
    ----------
    scene : Scene, of one body
    settings : NewtonSettings
    dt_s : float, the step [s]
    """
    size, moving = half_size(scene.bodies[0]), scene.frame == "world"
    return Made(settings, dt_s, size, scene.density, scene.system.gravity, moving)


def taken(newton: Any, warp: Any, scene: Scene, settings: NewtonSettings, dt_s: float) -> Recorded:
    """Return a model that no other run uses, as good as new.

    Parameters
    ----------
    newton, warp : module
    scene, settings, dt_s
        As for `made_of`.
    """
    recorded = idle.pop(made_of(scene, settings, dt_s), None)
    recorded = recorded or Recorded(newton, warp, scene, settings, dt_s)
    recorded.put_back()
    return recorded


def given_back(recorded: Recorded) -> None:
    """Keep a model for the next run."""
    idle[recorded.made_of] = recorded
    if len(idle) > MOST_IDLE:
        idle.popitem(last=False)
