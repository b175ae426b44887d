"""PhysX: how near single precision comes, and the traps that it sets without a word."""

import numpy as np
import pytest
from test_landing import errors_of_sweep
from uses import BLOCK, HERE, pulse, scene

from analytic import simulate
from analytic.response import Outcome
from engines import ENGINES
from engines.parts.quiet import imported
from engines.run.drive import LAG, build, run

pytestmark = pytest.mark.skipif("physx" not in HERE, reason="sapien is not installed")

MOTION = pulse(1.3, 3.0, 2)


def rocked(preset="fixed", **options):
    settings = options.pop("settings", {})
    return run("physx", scene(MOTION, preset=preset, settings=settings, **options))


def error(preset="fixed", **options):
    return abs(rocked(preset, **options).peak_ratio / simulate(BLOCK, MOTION).peak_ratio - 1.0)


@pytest.mark.parametrize(("preset", "median", "largest"), [("landing", 1e-3, 6e-3)])
def test_some_of_the_sweep(preset, median, largest):
    """Landing steps err by the noise of a contact, a rounding of its place over the step."""
    errors = errors_of_sweep("physx", every=48, preset=preset)
    assert np.median(errors) < median
    assert max(errors) < largest


def test_a_depth_that_is_corrected_at_once_is_noise():
    """The more of it the shorter the step."""
    free = {"depenetration": None, "contact_offset": None}
    assert error(step=2.5e-4, settings=free) > 3.0 * error(step=2.5e-4)


def test_a_block_held_before_it_strikes_strikes_twice():
    """A contact within its offset lets a gap close in a step, and holds in the next one."""
    near = rocked(settings={"contact_offset": None}).impacts[0].ratio
    assert rocked().impacts[0].ratio == pytest.approx(BLOCK.restitution, abs=5e-3)
    assert near > BLOCK.restitution + 0.01


def test_a_floor_whose_pose_is_set_carries_nothing():
    placed = rocked(frame="world", settings={"floor": "position"})
    assert placed.outcome is not Outcome.ROCKED
    led = rocked(frame="world", settings={"floor": "target"})
    assert led.outcome is Outcome.ROCKED
    assert led.observables[LAG] < 1e-6


def test_its_own_settings_are_told_apart_by_what_is_read_back():
    """Its threshold of a bounce, its sleep and its material are the library's where none is set."""
    physx = imported("sapien").physx
    build(ENGINES["physx"], scene(MOTION, preset="naive")).close()
    body = physx.PhysxRigidDynamicComponent()
    assert body.sleep_threshold == pytest.approx(0.005)
    assert (body.solver_position_iterations, body.solver_velocity_iterations) == (10, 1)
    assert physx.PhysxCpuSystem().config.bounce_threshold == 2.0
    asked = scene(MOTION, preset="fixed", settings={"bounce_threshold": 0.01, "units": None})
    world = build(ENGINES["physx"], asked)
    assert world.fault() == ""
    world.close()
    assert physx.PhysxCpuSystem().config.bounce_threshold == pytest.approx(0.01)
    assert physx.PhysxRigidDynamicComponent().sleep_threshold == 0.0


def test_a_script_of_corners_names_each():
    """What a script builds is written out: no name of the adapter's is left in it."""
    asked = ENGINES["physx"].preset("fixed")
    told = ENGINES["physx"].script
    assert told is not None
    lines = "\n".join(told(scene(MOTION), asked.settings, 1e-3).build)
    assert lines.count("sapien.Pose((-0.") == lines.count("sapien.Pose((0.1") == 1
    assert "corner" not in lines
