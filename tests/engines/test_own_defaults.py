"""What is said of the libraries' own defaults is what they report, and default leaves them so."""

import importlib
import math
from collections import defaultdict

import numpy as np
import pytest
from uses import BLOCK, HERE, agreed, pulse, rocked, scene

from analytic import RigidBlock, SinePulse, simulate
from analytic.response import Outcome, Reason
from engines.parts import imported
from engines.pybullet import NAIVE
from engines.run.run import LAG, build

OWN = "friction of a box of which nothing is said"


def on(flag):
    return "on" if flag else "off"


def pybullet(library):
    client = library.connect(library.DIRECT)
    size = {"halfExtents": (1, 1, 1), "physicsClientId": client}
    box = library.createCollisionShape(library.GEOM_BOX, **size)
    body = library.createMultiBody(1.0, box, physicsClientId=client)
    yield OWN, library.getDynamicsInfo(body, -1, physicsClientId=client)[1]
    library.disconnect(client)


def mujoco(library):
    text = '<mujoco><worldbody><geom type="sphere" size="1"/></worldbody></mujoco>'
    model = library.MjModel.from_xml_string(text)
    yield "friction", f"condim {model.geom_condim[0]}"
    exact = int(library.mjtEnableBit.mjENBL_DIAGEXACT)
    yield "contact", f"diagexact {on(model.opt.enableflags & exact)}"
    yield "without effect", f"refsafe, island and multiccd {on(model.opt.disableflags == 0)}"
    yield "without effect", f"ls_iterations {model.opt.ls_iterations}"
    yield "without effect", f"ls_tolerance {model.opt.ls_tolerance:g}"


def pymunk(library):
    space = library.Space()
    yield "iterations", f"{space.iterations}"
    yield "collision_slop", f"{space.collision_slop:g}"
    yield "collision_persistence", f"{space.collision_persistence:g} steps"
    yield "without effect", f"collision_bias {space.collision_bias ** (1.0 / 60.0):.1g}^60"
    yield "without effect", f"damping {space.damping:g}"
    yield OWN, library.Poly.create_box(library.Body(1.0, 1.0)).friction


def box2d(library):
    world = library.b2World()
    yield "skin", f"{library.b2_polygonRadius:.3g}"
    yield "skin", f"{library.b2_linearSlop:.3g}"
    yield "warm starting", on(world.warmStarting)
    yield "without effect", f"continuousPhysics {on(world.continuousPhysics)}"
    yield "without effect", f"b2_velocityThreshold {library.b2_velocityThreshold:g}"
    yield "without effect", f"b2_maxTranslation {library.b2_maxTranslation:g}"
    box = library.b2FixtureDef(shape=library.b2PolygonShape(box=(1, 1)))
    yield OWN, world.CreateDynamicBody(fixtures=box).fixtures[0].friction


def dart(library):
    world, options = library.simulation.World(), library.constraint.PgsBoxedLcpSolverOption()
    solver, asleep = world.getConstraintSolver(), world.getDeactivationOptions()
    assert type(solver.getSecondaryBoxedLcpSolver()).__name__ == "PgsBoxedLcpSolver"
    assert asleep.mEnabled and not solver.isSplitImpulseEnabled()
    yield "step", f"{world.getTimeStep():g}"
    yield "solver", type(solver.getBoxedLcpSolver()).__name__.removesuffix("BoxedLcpSolver")
    yield "solver", f"{options.mMaxIteration} iterations"
    detector = type(solver.getCollisionDetector()).__name__
    yield "collision", detector.removesuffix("CollisionDetector")
    yield "sleeping", f"{asleep.mTimeUntilSleep:g} s"
    yield "sleeping", f"{asleep.mLinearSpeedThreshold:g} m/s"
    yield "sleeping", f"{asleep.mAngularSpeedThreshold:g} rad/s"


def rapier(library):
    own = library.IntegrationParameters()
    soft, hard = own.contact_softness, own.static_contact_softness
    assert own.friction_model == library.FrictionModel.SIMPLIFIED and not own.friction_in_bias_pass
    assert own.contact_recycling and own.contact_clustering and own.warmstart_coefficient == 1.0
    yield "substeps", f"{own.num_solver_iterations}"
    yield "contact", f"{soft.natural_frequency:g} Hz, damping ratio {soft.damping_ratio:g}"
    yield "contact", f"{hard.natural_frequency:g} Hz on"
    yield "contact", f"{own.normalized_prediction_distance:.2g} away"
    yield "contact", f"less than {own.normalized_contact_recycle_distance:.2g}"
    yield "iterations", f"{own.num_internal_pgs_iterations} a substep"
    yield "iterations", f"{own.num_internal_stabilization_iterations} of stabilization"
    yield "without effect", f"allowed_linear_error {own.normalized_allowed_linear_error:.2g}"
    yield "without effect", f"max_corrective_velocity {own.normalized_max_corrective_velocity:g}"
    yield "without effect", f"max_linear_velocity {own.normalized_max_linear_velocity:g}"
    yield "without effect", f"max_ccd_substeps {own.max_ccd_substeps}"
    world, box = library.PhysicsWorld(), library.Collider.cuboid(1.0, 1.0, 1.0)
    body = world.rigid_bodies[world.add_body(library.RigidBody.dynamic(), [box])]
    yield OWN, world.colliders[body.colliders[0]].friction


def physx(library):
    scene, shape = library.physx.PhysxSceneConfig(), library.physx.PhysxShapeConfig()
    body = library.physx.PhysxRigidDynamicComponent()
    assert scene.enable_friction_every_iteration and not scene.enable_ccd
    yield "bounce_threshold", f"{scene.bounce_threshold:.1f}"
    yield "contact_offset", f"{shape.contact_offset:.2g}"
    yield "contact_offset", f"rest_offset {shape.rest_offset:g}"
    yield "manifolds", f"enable_pcm = {scene.enable_pcm}"
    yield "damping", f"angular {body.angular_damping:.2g}"
    yield "damping", f"linear {body.linear_damping:g}"
    yield "without effect", f"max_angular_velocity {body.max_angular_velocity:g}"
    most = f"{body.max_depenetration_velocity:.0e}".replace("+", "")
    yield "without effect", f"max_depenetration_velocity {most}"
    yield OWN, library.physx.get_default_material().static_friction


def drake(_):
    bare = importlib.import_module("pydrake.multibody.plant").MultibodyPlantConfig()
    config = importlib.import_module("pydrake.geometry").SceneGraphConfig()
    shapes = config.default_proximity_properties
    yield "step", f"time_step = {bare.time_step}"
    yield "solver", f"{bare.discrete_contact_approximation!r}"
    yield "solver", f"stiction_tolerance = {bare.stiction_tolerance}"
    yield "contact", f"contact_model = {bare.contact_model!r}"
    yield "contact", f"compliance_type = {shapes.compliance_type!r}"
    yield "contact", f"point_stiffness = {shapes.point_stiffness:.0f}"
    yield "contact", f"dissipation = {shapes.hunt_crossley_dissipation:.0f}"
    yield "friction", f"static_friction = {shapes.static_friction}"
    yield OWN, shapes.dynamic_friction


def newton(library):
    yield "gap", f"rigid_gap {library.ModelBuilder().rigid_gap:g}"


READ = {
    each.__name__: each
    for each in (pybullet, mujoco, pymunk, box2d, dart, rapier, physx, newton, drake)
}


@pytest.mark.parametrize("engine", [name for name in READ if name in HERE])
def test_what_the_table_says_of_a_default_is_what_the_library_reports(engine):
    """Also that a box's friction is not what is set; a squat block would slide at it."""
    default, said = HERE[engine].preset("default"), defaultdict(str)
    for source in default.documented:
        said[source.setting] += f" {source.value}"
    read = list(READ[engine](imported(HERE[engine].library)))
    for setting, value in read:
        assert setting == OWN or value in said[setting], (setting, value)
    own = dict(read).get(OWN)
    assert default.own == ({} if own is None else {"friction": pytest.approx(own, rel=1e-7)})
    if default.own:
        cube = RigidBlock(width=0.5, height=0.5)
        sine = SinePulse.in_g(1.5, omega=8.0, half_cycles=2)
        assert simulate(cube, sine).friction_needed > own
        slid = rocked(engine, sine, system=cube, preset="default", settings={"friction": own})
        assert slid.reason is Reason.SLID


def peak(engine, **settings):
    return rocked(engine, preset="default", settings=settings).peak_ratio


FELT = [
    ("pybullet", {"friction_erp": 0.0, "warm_starting": 0.85, "restitution_threshold": 0.0}, False),
    ("pybullet", {"constraint_erp": 0.8}, True),
    ("pymunk", {"bias": 0.0}, False),
    ("box2d", {"continuous": False}, False),
    ("mujoco", {"diagexact": True}, True),
    ("rapier", {"friction_in_bias_pass": True}, True),
]
"""Settings of which the table says whether the block feels them."""


@pytest.mark.parametrize(("engine", "changed", "felt"), [row for row in FELT if row[0] in HERE])
def test_what_is_called_without_effect_has_none_and_the_rest_has(engine, changed, felt):
    own, other = peak(engine), peak(engine, **changed)
    assert own > 0.0
    assert (other != own, abs(other - own) > 0.01) == (felt, felt)


BARE = """<mujoco><worldbody><body name="there" mocap="true"/><body name="here"><freejoint/>
<geom type="box" size="1 1 1"/></body></worldbody>
<equality><weld body1="there" body2="here"/></equality></mujoco>"""


def test_what_naive_pybullet_does_not_set_is_the_library_s_own():
    """Damping cannot be read back: two boxes that fly are slowed alike."""
    p = pytest.importorskip("pybullet")
    world, bare = build(HERE["pybullet"].use(scene(preset="default"))), p.connect(p.DIRECT)
    half = (0.5 * BLOCK.width, 0.5 * BLOCK.width, 0.5 * BLOCK.height)
    box = p.createCollisionShape(p.GEOM_BOX, halfExtents=half, physicsClientId=bare)
    body = p.createMultiBody(375.0, box, physicsClientId=bare)
    read = []
    for client, block in ((world._client, world.bodies[0]), (bare, body)):
        place = (0.0, 0.0, 100.0), (0.0, 0.0, 0.0, 1.0)
        p.resetBasePositionAndOrientation(block, *place, physicsClientId=client)
        p.resetBaseVelocity(block, (1.0, 0.0, 0.0), (0.0, 1.0, 0.0), physicsClientId=client)
        for _ in range(240):
            p.stepSimulation(physicsClientId=client)
        rest = p.getDynamicsInfo(block, -1, physicsClientId=client)[2:]  # after mass and friction
        parameters = p.getPhysicsEngineParameters(physicsClientId=client)
        velocity = np.ravel(p.getBaseVelocity(block, physicsClientId=client)).tolist()
        read.append((rest, parameters, velocity))
    world.close()
    p.disconnect(bare)
    assert read[0] == read[1]
    assert read[0][2][0] < math.exp(-0.04)


def test_what_naive_mujoco_does_not_set_is_the_library_s_own():
    mj = pytest.importorskip("mujoco")
    world = build(HERE["mujoco"].use(scene(preset="default")))
    bare, read = mj.MjModel.from_xml_string(BARE), world.model
    for name in dir(bare.opt):
        found = getattr(read.opt, name)
        if not name.startswith("_") and not callable(found):
            assert np.array_equal(found, getattr(bare.opt, name)), name
    for name in ("solref", "solimp", "friction", "margin", "gap", "condim", "solmix", "priority"):
        own = getattr(bare, f"geom_{name}")[0]
        assert all(np.array_equal(found, own) for found in getattr(read, f"geom_{name}")), name
    for name in ("eq_solref", "eq_solimp"):
        assert np.array_equal(getattr(read, name), getattr(bare, name)), name
    world.close()


LAGS_S = {
    "pybullet": (0.8 / 0.2 * NAIVE.step_s, 1e-2),  # a fifth of its error a step
    "mujoco": (2.0 * 0.02 * 0.95, 5e-2),  # damping over stiffness of its weld
}
"""Engine -> by how long its floor lags behind a steady velocity, and within what part."""
LED_M = {"drake": 1e-7, "newton": 1e-6}
"""Engine -> by less than what the floor is off that it leads."""


@pytest.mark.parametrize("engine", [name for name in LAGS_S if name in HERE])
@pytest.mark.parametrize("onsets", [1.3, 0.8, -0.8])
def test_the_floor_lags_by_what_holds_it(engine, onsets):
    """A block is seen from where the floor is, not from where it should be."""
    (lag_s, within), motion = LAGS_S[engine], pulse(onsets, 3.0, 2)
    response = rocked(engine, motion, preset="default")
    lag = lag_s * 2.0 * abs(motion.amplitude) / motion.omega
    assert response.observables[LAG] == pytest.approx(lag, rel=within)
    assert response.outcome is (Outcome.ROCKED if onsets > 1.0 else Outcome.AT_REST)


@pytest.mark.parametrize("engine", [name for name in LED_M if name in HERE])
def test_a_floor_that_is_led_is_where_it_should_be(engine):
    exact, response = agreed(engine, preset="default", frame="world")
    assert 0.0 < response.observables[LAG] < LED_M[engine]
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=0.2)
