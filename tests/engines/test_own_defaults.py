"""What the tables of settings say of the libraries' own defaults is what the libraries report."""

import importlib

import pytest
from uses import HERE, rocked

from engines.parts.quiet import imported


def mujoco(library):
    text = '<mujoco><worldbody><geom type="sphere" size="1"/></worldbody></mujoco>'
    model = library.MjModel.from_xml_string(text)
    exact, enabled = library.mjtEnableBit.mjENBL_DIAGEXACT, model.opt.enableflags
    return {
        "friction": [f"condim {model.geom_condim[0]}"],
        "contact": [f"diagexact {'on' if enabled & int(exact) else 'off'}"],
        "without effect": [
            f"refsafe, island and multiccd {'on' if model.opt.disableflags == 0 else 'off'}",
            f"ls_iterations {model.opt.ls_iterations}",
            f"ls_tolerance {model.opt.ls_tolerance:g}",
        ],
    }


def pymunk(library):
    space = library.Space()
    left = space.collision_bias ** (1.0 / 60.0)
    return {
        "iterations": [f"{space.iterations}"],
        "collision_slop": [f"{space.collision_slop:g}"],
        "collision_persistence": [f"{space.collision_persistence:g} steps"],
        "without effect": [f"collision_bias {left:.1g}^60", f"damping {space.damping:g}"],
    }


def box2d(library):
    world = library.b2World()
    return {
        "skin": [f"{library.b2_polygonRadius:.3g}", f"{library.b2_linearSlop:.3g}"],
        "warm starting": ["on" if world.warmStarting else "off"],
        "without effect": [
            f"continuousPhysics {'on' if world.continuousPhysics else 'off'}",
            f"b2_velocityThreshold {library.b2_velocityThreshold:g}",
            f"b2_maxTranslation {library.b2_maxTranslation:g}",
        ],
    }


def dart(library):
    world, options = library.simulation.World(), library.constraint.PgsBoxedLcpSolverOption()
    solver, asleep = world.getConstraintSolver(), world.getDeactivationOptions()
    assert type(solver.getSecondaryBoxedLcpSolver()).__name__ == "PgsBoxedLcpSolver"
    assert asleep.mEnabled and not solver.isSplitImpulseEnabled()
    return {
        "step": [f"{world.getTimeStep():g}"],
        "solver": [
            type(solver.getBoxedLcpSolver()).__name__.removesuffix("BoxedLcpSolver"),
            f"{options.mMaxIteration} iterations",
        ],
        "collision": [
            type(solver.getCollisionDetector()).__name__.removesuffix("CollisionDetector")
        ],
        "sleeping": [
            f"{asleep.mTimeUntilSleep:g} s",
            f"{asleep.mLinearSpeedThreshold:g} m/s",
            f"{asleep.mAngularSpeedThreshold:g} rad/s",
        ],
    }


def rapier(library):
    own = library.IntegrationParameters()
    soft, hard = own.contact_softness, own.static_contact_softness
    assert own.friction_model == library.FrictionModel.SIMPLIFIED and not own.friction_in_bias_pass
    assert own.contact_recycling and own.contact_clustering and own.warmstart_coefficient == 1.0
    return {
        "substeps": [f"{own.num_solver_iterations}"],
        "contact": [
            f"{soft.natural_frequency:g} Hz, damping ratio {soft.damping_ratio:g}",
            f"{hard.natural_frequency:g} Hz on",
            f"{own.normalized_prediction_distance:.2g} away",
            f"less than {own.normalized_contact_recycle_distance:.2g}",
        ],
        "iterations": [
            f"{own.num_internal_pgs_iterations} a substep",
            f"{own.num_internal_stabilization_iterations} of stabilization",
        ],
        "without effect": [
            f"allowed_linear_error {own.normalized_allowed_linear_error:.2g}",
            f"max_corrective_velocity {own.normalized_max_corrective_velocity:g}",
            f"max_linear_velocity {own.normalized_max_linear_velocity:g}",
            f"max_ccd_substeps {own.max_ccd_substeps}",
        ],
    }


def physx(library):
    scene, shape = library.physx.PhysxSceneConfig(), library.physx.PhysxShapeConfig()
    body = library.physx.PhysxRigidDynamicComponent()
    assert scene.enable_friction_every_iteration and not scene.enable_ccd
    return {
        "bounce_threshold": [f"{scene.bounce_threshold:.1f}"],
        "contact_offset": [f"{shape.contact_offset:.2g}", f"rest_offset {shape.rest_offset:g}"],
        "manifolds": [f"enable_pcm = {scene.enable_pcm}"],
        "damping": [f"angular {body.angular_damping:.2g}", f"linear {body.linear_damping:g}"],
        "without effect": [
            f"max_angular_velocity {body.max_angular_velocity:g}",
            f"max_depenetration_velocity {body.max_depenetration_velocity:.0e}".replace("+", ""),
        ],
    }


def drake(_):
    bare = importlib.import_module("pydrake.multibody.plant").MultibodyPlantConfig()
    config = importlib.import_module("pydrake.geometry").SceneGraphConfig()
    shapes = config.default_proximity_properties
    return {
        "step": [f"time_step = {bare.time_step}"],
        "solver": [
            f"{bare.discrete_contact_approximation!r}",
            f"stiction_tolerance = {bare.stiction_tolerance}",
        ],
        "contact": [
            f"contact_model = {bare.contact_model!r}",
            f"compliance_type = {shapes.compliance_type!r}",
            f"point_stiffness = {shapes.point_stiffness:.0f}",
            f"dissipation = {shapes.hunt_crossley_dissipation:.0f}",
        ],
        "friction": [f"static_friction = {shapes.static_friction}"],
    }


def newton(library):
    return {"gap": [f"rigid_gap {library.ModelBuilder().rigid_gap:g}"]}


READ = {each.__name__: each for each in (mujoco, pymunk, box2d, dart, rapier, physx, newton, drake)}


@pytest.mark.parametrize("engine", [name for name in READ if name in HERE])
def test_what_the_table_says_of_a_default_is_what_the_library_reports(engine):
    said: dict[str, str] = {}
    for source in HERE[engine].preset("naive").documented:
        said[source.setting] = f"{said.get(source.setting, '')} {source.value}"
    for setting, found in READ[engine](imported(HERE[engine].library)).items():
        for value in found:
            assert value in said[setting], (setting, value)


def peak(engine, **settings):
    return rocked(engine, preset="naive", settings=settings).peak_ratio


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


@pytest.mark.skipif("rapier" not in HERE, reason="it is not installed")
@pytest.mark.parametrize(
    ("changed", "felt"),
    [
        ({"normalized_allowed_linear_error": 0.0, "contact_clustering": False}, False),
        ({"normalized_max_corrective_velocity": 0.3, "max_ccd_substeps": 0}, False),
        ({"normalized_prediction_distance": 0.002}, True),
    ],
)
def test_which_of_rapier_s_own_numbers_the_block_feels(changed, felt, monkeypatch):
    module, own = importlib.import_module("engines.rapier.build"), peak("rapier")
    build = module.build

    def otherwise(*arguments):
        world, parameters, *rest = build(*arguments)
        for name, value in changed.items():
            setattr(parameters, name, value)
        return world, parameters, *rest

    monkeypatch.setattr(module, "build", otherwise)
    assert (peak("rapier") != own) == felt
