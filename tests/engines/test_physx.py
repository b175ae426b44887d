"""PhysX: the traps that it sets without a word."""

import pytest
from uses import BLOCK, HERE, error, rocked, scene

from engines import ENGINES
from engines.parts import imported
from engines.run.run import build

pytestmark = pytest.mark.skipif("physx" not in HERE, reason="sapien is not installed")


def test_a_depth_that_is_corrected_at_once_is_noise():
    """The more of it the shorter the step."""
    fine = {"preset": "fixed", "step": 2.5e-4}
    free = {"depenetration": None, "contact_offset": None}
    assert error("physx", **fine, settings=free) > 3.0 * error("physx", **fine)


def test_a_block_held_before_it_strikes_strikes_twice():
    """A contact within its offset lets a gap close in a step, and holds in the next one."""
    near = rocked("physx", preset="fixed", settings={"contact_offset": None}).impacts[0].ratio
    far = rocked("physx", preset="fixed").impacts[0].ratio
    assert far == pytest.approx(BLOCK.restitution, abs=5e-3)
    assert near > BLOCK.restitution + 0.01


def test_its_own_settings_are_told_apart_by_what_is_read_back():
    """Its threshold of a bounce, its sleep and its material are the library's where none is set."""
    physx = imported("sapien").physx
    build(ENGINES["physx"].use(scene(preset="naive"))).close()
    body = physx.PhysxRigidDynamicComponent()
    assert body.sleep_threshold == pytest.approx(0.005)
    assert (body.solver_position_iterations, body.solver_velocity_iterations) == (10, 1)
    assert physx.PhysxCpuSystem().config.bounce_threshold == 2.0
    asked = scene(preset="fixed", settings={"bounce_threshold": 0.01, "units": None})
    world = build(ENGINES["physx"].use(asked))
    assert world.fault() == ""
    world.close()
    assert physx.PhysxCpuSystem().config.bounce_threshold == pytest.approx(0.01)
    assert physx.PhysxRigidDynamicComponent().sleep_threshold == 0.0


def test_a_script_of_corners_names_each():
    """What a script builds is written out: no name of the adapter's is left in it."""
    asked = ENGINES["physx"].preset("fixed")
    told = ENGINES["physx"].script
    assert told is not None
    lines = "\n".join(told(scene(), asked.settings, 1e-3).build)
    assert lines.count("sapien.Pose((-0.") == lines.count("sapien.Pose((0.1") == 1
    assert "corner" not in lines
