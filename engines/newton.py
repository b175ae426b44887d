"""Newton (Warp): settings, presets, and how a scene is built, stepped and read back, on the CPU.

A step is dozens of short kernels: they are recorded once, with the step's length, and replayed. To
make a model takes as long as hundreds of its steps: that of one block is kept for the next run of
the same, which sets out from where its own scene begins. The library compiles its kernels when they
are first used on a machine, for minutes, and keeps them there.
"""

import math
from collections import OrderedDict
from collections.abc import Hashable
from dataclasses import dataclass
from typing import Any, NamedTuple

from engines.declaration import Engine, Precision, Preset, citations, default
from engines.factors import BOTH, DEFAULT, factor, level, moving_base
from engines.parts import NO_JAM, Adapter, imported, silence, yaw_of
from engines.run.export import Notes
from engines.scene import Scene
from engines.settings import check, disagreement, given, setting
from engines.shapes import half_size, touching_spheres
from engines.world import FloatArray, Script, Step

MOST_CONTACTS = 4, 16
"""Room for so many contacts of a block, having four corners at its base, and of each pair of faces
where bodies rest on others; by its own estimate the library solves for hundreds in every step."""

MOST_IDLE = 8
"""Models kept for later runs."""

UPRIGHT = (0.0, 0.0, 0.0, 1.0)
"""A quaternion, its real part last."""

XPBD = "xpbd"
SOLVERS = (XPBD, "padmm", "dvi")
"""The solver by positions, and Kamino's, by impulses."""


@dataclass(frozen=True, slots=True, kw_only=True)
class NewtonSettings:
    """Settings of Newton, by default those of its own example of a belt; None leaves its own."""

    # of corners, small spheres where those are that touch: four of a face, or two if planar
    geometry: str = setting("box", names=("box", "corners"))
    planar: bool = False
    friction: float = setting(1.0, least=0.0)
    solver: str = setting(XPBD, names=SOLVERS)  # Kamino has the other two, solvers of dynamics
    # the library's own are 2 of "xpbd", 200 of "padmm", 24 of "dvi"
    iterations: int | None = setting(least=1)
    # part of a contact's correction that "xpbd" makes in an iteration; its own is 0.8
    relaxation: float | None = setting(above=0.0, most=2.0)
    # "xpbd" divides a correction by the number of contacts: momentum is lost
    weighting: bool | None = None
    # part of a penetration that Kamino corrects in a step, by a velocity; its own is 0.01
    baumgarte: float | None = setting(least=0.0, most=1.0)
    # of block and base; "xpbd" heeds it where it is told to, as here
    restitution: float | None = setting(least=0.0, most=1.0)
    corner_radius: float = setting(1e-3, above=0.0)  # over the width
    floor: str = setting("velocity", names=("velocity", "position"))

    def __post_init__(self) -> None:
        check(self)


class Model(NamedTuple):
    """What takes a step, from `now` over `after`."""

    newton: Any
    model: Any
    pipeline: Any
    contacts: Any
    solver: Any
    now: Any
    after: Any
    moving: bool

    def advance(self, dt_s: float) -> None:
        """Take a step of a length [s]."""
        now = self.now
        if self.moving:
            only = self.newton.BodyFlags.KINEMATIC
            self.newton.eval_fk(self.model, now.joint_q, now.joint_qd, now, body_flag_filter=only)
        self.pipeline.collide(now, self.contacts)
        self.solver.step(now, self.after, None, self.contacts, dt_s)
        now.assign(self.after)


def build(newton: Any, warp: Any, scene: Scene, s: NewtonSettings) -> Model:
    """Build bodies on a plane that does not move, or on a kinematic one."""
    moving = scene.frame == "world"
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, -scene.system.gravity))
    if s.solver != XPBD:
        newton.solvers.SolverKamino.register_custom_attributes(builder)
    builder.default_shape_cfg.mu = float(s.friction)
    if s.restitution is not None:
        builder.default_shape_cfg.restitution = s.restitution
    # in which order things are made decides in which they are solved for
    if not moving and not scene.stacked:
        builder.add_ground_plane()
    shape = builder.default_shape_cfg.copy()
    shape.density = 0.0
    for number in range(len(scene.bodies)):
        add_body(builder, warp, scene, number, s, shape)
    if moving:
        shape.density = 0.0
        mass, turning = scene.bodies[0].mass, diagonal(warp, *scene.bodies[0].inertia)
        floor = builder.add_link(mass=mass, inertia=turning, is_kinematic=True)
        builder.add_shape_plane(body=floor, width=0.0, length=0.0, cfg=shape)
        rail = builder.add_joint_prismatic(parent=-1, child=floor, axis=newton.Axis.X)
        builder.add_articulation([rail])
    elif scene.stacked:
        builder.add_ground_plane()
    model = builder.finalize(device="cpu")
    one, each = MOST_CONTACTS
    most = each * len(scene.layout.contacts) if scene.stacked else one
    model.rigid_contact_max = most
    pipeline = newton.CollisionPipeline(model, rigid_contact_max=most)
    contacts = pipeline.contacts()
    solver = new_solver(newton, model, s)
    return Model(newton, model, pipeline, contacts, solver, model.state(), model.state(), moving)


def add_body(
    builder: Any, warp: Any, scene: Scene, number: int, s: NewtonSettings, shape: Any
) -> None:
    """Add a body where it is at rest: a box, or small spheres where it touches others."""
    body = scene.bodies[number]
    at, (x, y, z) = warp.transform((body.home[0], 0.0, body.home[1]), UPRIGHT), half_size(body)
    if s.geometry == "box" and not scene.stacked:
        shape.density = body.density
        builder.add_shape_box(builder.add_body(xform=at), hx=x, hy=y, hz=z, cfg=shape)
        return
    turning = diagonal(warp, *body.inertia)
    own = builder.add_body(xform=at, mass=body.mass, inertia=turning, lock_inertia=True)
    if s.geometry == "box" or scene.layout.rests(number):
        builder.add_shape_box(own, hx=x, hy=y, hz=z, cfg=shape)
        return
    radius = s.corner_radius * body.width
    for corner in touching_spheres(scene, number, radius, planar=s.planar):
        there = warp.transform(corner, UPRIGHT)
        builder.add_shape_sphere(own, xform=there, radius=radius, cfg=shape)


def diagonal(warp: Any, first: float, second: float, third: float) -> Any:
    """Return a matrix of moments of inertia."""
    return warp.mat33(first, 0.0, 0.0, 0.0, second, 0.0, 0.0, 0.0, third)


def new_solver(newton: Any, model: Any, s: NewtonSettings) -> Any:
    """Return the solver of a model."""
    if s.solver == XPBD:
        wanted = {
            "iterations": s.iterations,
            "rigid_contact_relaxation": s.relaxation,
            "rigid_contact_con_weighting": s.weighting,
            "enable_restitution": None if s.restitution is None else True,
        }
        return newton.solvers.SolverXPBD(model, **given(wanted))
    config = newton.solvers.SolverKamino.Config.from_model(model, dynamics_solver=s.solver)
    if s.baumgarte is not None:
        config.constraints.gamma = s.baumgarte
    if s.iterations is not None and s.solver == "padmm":
        config.padmm.max_iterations = s.iterations
    elif s.iterations is not None:
        config.dvi.max_alternating_iterations = s.iterations
    return newton.solvers.SolverKamino(model, config=config)


class Recorded:
    """A step of a model, known again by what that is made of, and single-precision views of it.

    A row for each body and a moving plane: force [N] and moment [N m]; position [m] and
    quaternion; velocity [m/s] and angular velocity [rad/s].
    """

    def __init__(self, scene: Scene, settings: NewtonSettings, dt_s: float) -> None:
        self.made_of = made_of(scene, settings, dt_s)
        warp = imported("warp")
        self.it = it = build(imported("newton"), warp, scene, settings)
        it.advance(dt_s)  # compiles its kernels
        with warp.ScopedCapture(device="cpu") as recorded:
            it.advance(dt_s)
        self.graph, now = recorded.graph, it.now
        self.force, self.place = now.body_f.numpy(), now.body_q.numpy()
        self.velocity = now.body_qd.numpy()
        self.joint_q, self.joint_qd = now.joint_q.numpy(), now.joint_qd.numpy()


def made_of(scene: Scene, settings: NewtonSettings, dt_s: float) -> Hashable:
    """Return what the model of a scene is made of; where the scene begins is none of it."""
    bodies = tuple((half_size(body), body.density, body.home) for body in scene.bodies)
    return settings, dt_s, bodies, scene.layout.contacts, scene.system.gravity, scene.frame


idle: "OrderedDict[Hashable, Recorded]" = OrderedDict()
"""Models of this process whose run has ended, by what they are made of."""


class NewtonWorld(Adapter):
    """Bodies in space, on a plane that does not move, or on a kinematic one."""

    library = "warp"

    def _build(self, scene: Scene, dt_s: float) -> None:
        self._masses = [body.mass for body in scene.bodies]
        self._library.config.log_level = self._library.LOG_ERROR
        with silence():
            kept = idle.pop(made_of(scene, self._s, dt_s), None)
            self._recorded = kept or Recorded(scene, self._s, dt_s)
            self._recorded.it.solver.reset(self._recorded.it.now)
        self._force, self._places = self._recorded.force, self._recorded.place
        self._velocity = self._recorded.velocity
        for number, body in enumerate(scene.bodies):
            at, half = body.at, 0.5 * body.at.theta
            self._places[number] = (at.x, 0.0, at.z, 0.0, math.sin(half), 0.0, math.cos(half))
            self._velocity[number] = (at.velocity_x, 0.0, at.velocity_z, 0.0, at.rate, 0.0)
        if self._way:
            self._places[-1, 0] = 0.0

    def step(self, step: Step) -> None:
        """Advance by a step, of which all are equal."""
        if step.dt_s != self._ordinary:
            self._fault = self._fault or "its steps are recorded, and all of one length"
        for number, mass in enumerate(self._masses):
            self._force[number, 0] = mass * step.pull_x
            self._force[number, 2] = mass * (step.pull_z + self._scene.system.gravity)
        if self._way:
            speed = step.base_velocity if self._way == "velocity" else 0.0
            self._recorded.joint_q[-1], self._recorded.joint_qd[-1] = step.base_x, speed
        self._library.capture_launch(self._recorded.graph)
        self._came(step, float(self._places[-1, 0]) if self._way else None)

    @property
    def yaw(self) -> float:
        """How far the first body has turned; see `engines.world.World`."""
        x, y, z, w = self._places[0, 3:].tolist()
        return yaw_of(w, x, y, z)

    def state(self) -> FloatArray:
        """Read the bodies' poses back."""
        for number, row in enumerate(self._state):
            x, _, z, _, turn_y, _, turn_w = self._places[number].tolist()
            rate = float(self._velocity[number, 4])
            row[:] = x - self._place, z, 2.0 * math.atan2(turn_y, turn_w), rate
        return self._state

    def close(self) -> None:
        """Leave the engine's memory to the next run of the same bodies."""
        idle[self._recorded.made_of] = self._recorded
        if len(idle) > MOST_IDLE:
            idle.popitem(last=False)

    def _read_back(self, scene: Scene) -> str:
        model = self._recorded.it.model
        mass, inertia = model.body_mass.numpy(), model.body_inertia.numpy()
        friction = min(model.shape_material_mu.numpy().tolist())
        pairs = {"friction": (self._s.friction, friction)}
        for number, body in enumerate(scene.bodies):
            pairs[f"mass {number}"] = (body.mass, float(mass[number]))
            pairs[f"moment {number}"] = (body.inertia[1], float(inertia[number, 1, 1]))
        return disagreement(pairs, Precision.SINGLE.value)


def script(scene: Scene, settings: NewtonSettings, dt_s: float) -> Script:
    """Return a scene as calls of Newton; see `engines.run.export`."""
    notes, moving = Notes(), scene.frame == "world"
    newton, warp = notes.of(imported("newton"), "newton"), notes.of(imported("warp"), "wp")
    with silence():
        it = build(newton, warp, scene, settings)
    notes.name(model=it.model, pipeline=it.pipeline, contacts=it.contacts)
    notes.name(solver=it.solver, now=it.now, after=it.after)
    carry = (
        "    only = newton.BodyFlags.KINEMATIC",
        "    newton.eval_fk(model, now.joint_q, now.joint_qd, now, body_flag_filter=only)",
    )
    begins = []
    for number, body in enumerate(scene.bodies):
        at, half = body.at, 0.5 * body.at.theta
        turn = f"0.0, math.sin({half!r}), 0.0, math.cos({half!r})"
        speed = f"{at.velocity_x!r}, 0.0, {at.velocity_z!r}, 0.0, {at.rate!r}, 0.0"
        begins.append(f"place[{number}] = {at.x!r}, 0.0, {at.z!r}, {turn}")
        begins.append(f"velocity[{number}] = {speed}")
    return Script(
        imports=("import newton", "import warp as wp"),
        settings=notes.quoted("Solver", "cfg.", "config.", "contact_max"),
        build=(
            *notes.lines(),
            *("", "", "def advance():", *carry * moving),
            "    pipeline.collide(now, contacts)",
            "    solver.step(now, after, None, contacts, DT)",
            *("    now.assign(after)", "", ""),
            "advance()  # compiles its kernels",
            "with wp.ScopedCapture(device='cpu') as recorded:",
            "    advance()",
            "solver.reset(now)",
            "force, place = now.body_f.numpy(), now.body_q.numpy()  # views, on the CPU",
            "velocity, joint_q, joint_qd = (",
            "    it.numpy() for it in (now.body_qd, now.joint_q, now.joint_qd)",
            ")",
            *begins,
            f"masses = {[body.mass for body in scene.bodies]!r}",
        ),
        step=(
            "for number, mass in enumerate(masses):",
            "    force[number, 0] = mass * pull_x",
            "    force[number, 2] = mass * (pull_z + GRAVITY)",
            *("joint_q[-1], joint_qd[-1] = base_x, base_velocity",) * moving,
            "wp.capture_launch(recorded.graph)",
        ),
        pose=(
            "theta = 2.0 * math.atan2(float(place[number, 4]), float(place[number, 6]))",
            "rate = float(velocity[number, 4])",
        ),
        place="float(place[0, 0])" + " - float(place[-1, 0])" * moving,
    )


DOMINOES = "newton/examples/contacts/example_domino_spiral.py, newton 1.8.0"
BELT = "newton/examples/basic/example_basic_conveyor.py, newton 1.8.0"

DOCUMENTED = citations(f"""
step | fps = 100, sim_substeps = 10 | {BELT}
solver | newton.solvers.SolverXPBD(model), the example's --solver by default | {BELT}
iterations | Defaults to 2. | SolverXPBD, newton 1.8.0
contact | rigid_contact_relaxation 0.8, rigid_contact_con_weighting True, enable_restitution False
    | SolverXPBD, newton 1.8.0
damping | angular_damping: Defaults to 0.0. | SolverXPBD, newton 1.8.0
friction | mu: float = 1.0, of a pair the mean | ModelBuilder.ShapeConfig; xpbd/kernels.py, newton
    1.8.0
gap | contacts are made from rigid_gap 0.1 away | ModelBuilder, newton 1.8.0
floor | is_kinematic=True on a joint; joint_q and joint_qd in each substep, then eval_fk(...,
    body_flag_filter=BodyFlags.KINEMATIC) | {BELT}
shapes | a box on add_shape_plane(body=belt), where the solver is Kamino | {BELT}
""")
"""What the preset "default" is documented by: the example in which a floor moves."""

RECOMMENDED = citations(f"""
step | a smaller dt first, before all else of a solver | simulation_tuning.rst
step | 60 fps of 10 substeps, free dominoes | {DOMINOES}
iterations | 20, free dominoes; enable_restitution, which is left off | {DOMINOES}
""")
"""What it recommends for less penetration: a smaller step, then more iterations."""

TUNED = NewtonSettings(solver="dvi", friction=NO_JAM, baumgarte=0.0)

STACKED = {"geometry": "corners", "planar": True, "iterations": 100}
"""Where bodies rest on others: two boxes meet at another depth than a box and the floor."""

OVERDONE = "both corners correct all of a penetration that they share"

FACTORS = (
    factor(
        ("solver", "iterations"),
        level("XPBD, 50 iterations", BOTH, solver=XPBD, iterations=50),
        level("Kamino by PADMM", BOTH, solver="padmm", iterations=200),
    ),
    factor("relaxation", level("1", (DEFAULT,), relaxation=1.0), by_default=False),
    factor("weighting", level("no", (DEFAULT,), OVERDONE, weighting=False), by_default=False),
    factor("baumgarte", level("0.1", baumgarte=0.1)),
    factor("geometry", level("corners", BOTH, geometry="corners")),
    factor("friction"),
    moving_base("velocity", "position"),
)

NAIVE = default(NewtonSettings(), 1e-3, DOCUMENTED)

ENGINE = Engine(
    name="newton",
    title="Newton",
    library="newton",
    packages=("newton", "warp-lang"),
    build=NewtonWorld,
    stacks=True,
    presets=(
        NAIVE,
        NAIVE.at_rest(),
        NAIVE.recommended(*RECOMMENDED, step_s=1.0 / 600.0, iterations=20),
        Preset(name="tuned", settings=TUNED, step=1e-3, stacked=STACKED),
    ),
    precision=Precision.SINGLE,
    shortest_step=3e-6,
    script=script,
    factors=FACTORS,
    compiles=True,
)
