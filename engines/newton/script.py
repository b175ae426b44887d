"""A scene in Newton's own words, for a script that needs the library alone."""

from engines.newton.models import MOST_CONTACTS
from engines.newton.settings import XPBD, NewtonSettings
from engines.parts.script import Script
from engines.parts.shapes import corner_spheres, half_size
from engines.scene import Scene


def script(scene: Scene, s: NewtonSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of Newton; see `engines.parts.script`."""
    rough = f"builder.default_shape_cfg.mu = {float(s.friction)!r}"
    block, solver = _block(scene, s), _solver(scene, s)
    step = "solver.step(now, after, None, contacts, {})"
    return Script(
        imports=("import newton", "import warp as wp"),
        settings=(rough, *block, *solver, step.format(repr(dt_s))),
        build=(
            "builder = newton.ModelBuilder(gravity=(0.0, 0.0, -GRAVITY))",
            *_attributes(s),
            rough,
            "builder.add_ground_plane()",
            "shape = builder.default_shape_cfg.copy()",
            *block,
            'model = builder.finalize(device="cpu")',
            f"model.rigid_contact_max = most = {MOST_CONTACTS}",
            "pipeline = newton.CollisionPipeline(model, rigid_contact_max=most)",
            "contacts = pipeline.contacts()",
            *solver,
            "now, after = model.state(), model.state()",
            "force = now.body_f.numpy()  # on the CPU a view, as those that follow",
            "place, velocity = now.body_q.numpy(), now.body_qd.numpy()",
            "",
            "",
            "def advance():",
            "    pipeline.collide(now, contacts)",
            f"    {step.format('DT')}",
            "    now.assign(after)",
            "",
            "",
            "advance()  # compiles its kernels",
            'with wp.ScopedCapture(device="cpu") as recorded:',
            "    advance()",
            "solver.reset(now)",
            *_beginning(scene),
        ),
        step=(
            f"force[0, 0] = {scene.mass!r} * pull_x",
            f"force[0, 2] = {scene.mass!r} * (pull_z + GRAVITY)",
            "wp.capture_launch(recorded.graph)",
        ),
        pose=(
            "theta = 2.0 * math.atan2(float(place[0, 4]), float(place[0, 6]))",
            "rate = float(velocity[0, 4])",
        ),
    )


def _attributes(s: NewtonSettings) -> tuple[str, ...]:
    if s.solver == XPBD:
        return ()
    return ("newton.solvers.SolverKamino.register_custom_attributes(builder)",)


def _block(scene: Scene, s: NewtonSettings) -> tuple[str, ...]:
    x, y, z = half_size(scene)
    at = f"at = wp.transform((0.0, 0.0, {z!r}), (0.0, 0.0, 0.0, 1.0))"
    if s.geometry == "box":
        return (
            f"shape.density = {scene.density!r}",
            at,
            "block = builder.add_body(xform=at)",
            f"builder.add_shape_box(block, hx={x!r}, hy={y!r}, hz={z!r}, cfg=shape)",
        )
    radius = s.corner_radius * scene.block.width
    first, second, third = scene.inertia
    moments = f"{first!r}, 0.0, 0.0, 0.0, {second!r}, 0.0, 0.0, 0.0, {third!r}"
    return (
        "shape.density = 0.0",
        at,
        f"inertia = wp.mat33({moments})",
        f"block = builder.add_body(xform=at, mass={scene.mass!r}, inertia=inertia, "
        "lock_inertia=True)",
        f"for corner in {corner_spheres(scene, radius, planar=False)}:",
        "    there = wp.transform(corner, (0.0, 0.0, 0.0, 1.0))",
        f"    builder.add_shape_sphere(block, xform=there, radius={radius!r}, cfg=shape)",
    )


def _solver(scene: Scene, s: NewtonSettings) -> tuple[str, ...]:
    wanted = s.of_solver(scene).items()
    if s.solver == XPBD:
        arguments = ", ".join(f"{name}={value!r}" for name, value in wanted)
        return (f"solver = newton.solvers.SolverXPBD(model, {arguments})",)
    return (
        "kamino = newton.solvers.SolverKamino",
        f"config = kamino.Config.from_model(model, dynamics_solver={s.solver!r})",
        *(f"config.{name} = {value!r}" for name, value in wanted),
        "solver = kamino(model, config=config)",
    )


def _beginning(scene: Scene) -> tuple[str, ...]:
    """Return lines that put the block where it sets out."""
    at = scene.beginning
    return (
        f"half = 0.5 * {at.theta!r}",
        f"place[0] = ({at.x!r}, 0.0, {at.z!r}, 0.0, math.sin(half), 0.0, math.cos(half))",
        f"velocity[0] = ({at.velocity_x!r}, 0.0, {at.velocity_z!r}, 0.0, {at.rate!r}, 0.0)",
    )
