"""A scene in Drake's own words, for a script that needs the library alone."""

from engines.drake.settings import CENIC, LONGEST, PLANE, DrakeSettings
from engines.parts.script import Script
from engines.parts.settings import given
from engines.parts.shapes import corner_spheres, half_size
from engines.scene import Scene


def script(scene: Scene, s: DrakeSettings, dt_s: float) -> Script:
    """Return a scene on a base at rest as calls of Drake; see `engines.parts.script`."""
    config, material = _config(scene, s, dt_s), _material(scene, s, dt_s)
    shapes, joint, steps = _shapes(scene, s), _joint(s), _steps(scene, s, dt_s)
    return Script(
        imports=(
            "from pydrake.geometry import AddContactMaterial, HalfSpace, ProximityProperties",
            f"from pydrake.geometry import {'Box' if s.geometry == 'box' else 'Sphere'}",
            "from pydrake.math import RigidTransform, RotationMatrix",
            "from pydrake.multibody.math import SpatialVelocity",
            "from pydrake.multibody.plant import AddMultibodyPlant, CoulombFriction",
            "from pydrake.multibody.plant import MultibodyPlantConfig",
            "from pydrake.multibody.tree import FixedOffsetFrame, PlanarJoint, SpatialInertia",
            "from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator",
            "from pydrake.systems.framework import DiagramBuilder",
        ),
        settings=(*config, *joint, *material, *shapes, *steps),
        build=(
            "builder = DiagramBuilder()",
            *config,
            "plant, _ = AddMultibodyPlant(config, builder)",
            *_inertia(scene),
            *joint,
            *material,
            "ground, here = plant.world_body(), RigidTransform()",
            'plant.RegisterCollisionGeometry(ground, here, HalfSpace(), "base", properties)',
            *shapes,
            "plant.Finalize()",
            "field = plant.mutable_gravity_field()",
            "simulator = Simulator(builder.Build())",
            "context = plant.GetMyMutableContextFromRoot(simulator.get_mutable_context())",
            *_beginning(scene, s),
            *steps,
            "simulator.Initialize()",
            # a discrete plant changes at the beginning of a step: half of one later it has, once
            f"end = {'0.0' if s.solver == CENIC else '-0.5 * DT'}",
        ),
        step=(
            "global end",
            "field.set_gravity_vector((pull_x, 0.0, pull_z))",
            "end += DT",
            "simulator.AdvanceTo(end)",
        ),
        pose=(
            "state = plant.GetPositionsAndVelocities(context)",
            *_pose(s),
        ),
    )


def _config(scene: Scene, s: DrakeSettings, dt_s: float) -> tuple[str, ...]:
    continuous = s.solver == CENIC
    scale = scene.block.p * scene.block.R
    wanted = {
        "time_step": 0.0 if continuous else dt_s,
        "discrete_contact_approximation": None if continuous else s.solver,
        "stiction_tolerance": None if s.stiction is None else s.stiction * scale,
        "sap_near_rigid_threshold": s.near_rigid,
    }
    arguments = ", ".join(f"{name}={value!r}" for name, value in given(wanted).items())
    return (f"config = MultibodyPlantConfig({arguments})",)


def _inertia(scene: Scene) -> tuple[str, ...]:
    numbers = (scene.mass, *(2.0 * half for half in half_size(scene)))
    inertia = f"SpatialInertia.SolidBoxWithMass({', '.join(map(repr, numbers))})"
    return (f'block = plant.AddRigidBody("block", {inertia})',)


def _joint(s: DrakeSettings) -> tuple[str, ...]:
    if not s.planar:
        return ()
    return (
        f"turned = RigidTransform(RotationMatrix({[list(row) for row in PLANE]}))",
        'base_plane = FixedOffsetFrame("base plane", plant.world_body().body_frame(), turned)',
        'block_plane = FixedOffsetFrame("block plane", block.body_frame(), turned)',
        "frames = [plant.AddFrame(frame) for frame in (base_plane, block_plane)]",
        'plant.AddJoint(PlanarJoint("plane", *frames))',
    )


def _material(scene: Scene, s: DrakeSettings, dt_s: float) -> tuple[str, ...]:
    """Return lines that make what a contact is made of; two shapes have a half of it each."""
    scale = scene.block.p * scene.block.R
    wanted = {
        "point_stiffness": s.stiffness and 2.0 * s.stiffness * scene.mass / dt_s**2,
        "dissipation": s.dissipation and s.dissipation / scale,
    }
    numbers = "".join(f"{name}={value!r}, " for name, value in given(wanted).items())
    friction = f"friction=CoulombFriction({float(s.friction)!r}, {float(s.friction)!r})"
    lines = (
        "properties = ProximityProperties()",
        f"AddContactMaterial({numbers}{friction}, properties=properties)",
    )
    if s.relaxation is None:
        return lines
    time = 0.5 * s.relaxation * dt_s
    return (*lines, f'properties.AddProperty("material", "relaxation_time", {time!r})')


def _shapes(scene: Scene, s: DrakeSettings) -> tuple[str, ...]:
    if s.geometry == "box":
        size = ", ".join(repr(2.0 * half) for half in half_size(scene))
        shape = f"here, Box({size})"
        return (f'plant.RegisterCollisionGeometry(block, {shape}, "block", properties)',)
    radius = s.corner_radius * scene.block.width
    corners = [list(at) for at in corner_spheres(scene, radius, planar=s.planar)]
    ball = f'Sphere({radius!r}), f"corner {{number}}", properties'
    return (
        f"for number, at in enumerate({corners}):",
        f"    plant.RegisterCollisionGeometry(block, RigidTransform(at), {ball})",
    )


def _beginning(scene: Scene, s: DrakeSettings) -> tuple[str, ...]:
    """Return lines that put the block where it sets out."""
    at = scene.beginning
    if s.planar:
        state = [at.z, at.x, at.theta, at.velocity_z, at.velocity_x, at.rate]
        return (f"plant.SetPositionsAndVelocities(context, {state})",)
    velocity = f"w={[0.0, at.rate, 0.0]}, v={[at.velocity_x, 0.0, at.velocity_z]}"
    return (
        f"turned = RotationMatrix.MakeYRotation({at.theta!r})",
        f"start = RigidTransform(turned, {[at.x, 0.0, at.z]})",
        "plant.SetFreeBodyPose(context, block, start)",
        f"plant.SetFreeBodySpatialVelocity(context, block, SpatialVelocity({velocity}))",
    )


def _steps(scene: Scene, s: DrakeSettings, dt_s: float) -> tuple[str, ...]:
    """Return lines that put CENIC in charge of a continuous plant."""
    if s.solver != CENIC:
        return ()
    longest = LONGEST * dt_s if s.accuracy is None else dt_s
    lines = (
        f'ResetIntegratorFromFlags(simulator=simulator, scheme="{CENIC}", '
        f"max_step_size={longest!r})",
        "integrator = simulator.get_mutable_integrator()",
        f"integrator.set_fixed_step_mode({s.accuracy is None})",
    )
    if s.accuracy is None:
        return lines
    accuracy = s.accuracy * scene.block.alpha * max(1.0, scene.block.R)
    return (*lines, f"integrator.set_target_accuracy({accuracy!r})")


def _pose(s: DrakeSettings) -> tuple[str, ...]:
    if s.planar:
        return ("theta, rate = state[2], state[5]",)
    return ("theta, rate = 2.0 * math.atan2(state[2], state[0]), state[8]",)
