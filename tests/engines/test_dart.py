"""DART: how near it comes, and the traps that it sets without a word."""

from dataclasses import replace

import numpy as np
import pytest
from test_landing import errors_of_sweep
from uses import BLOCK, HERE, pulse, scene

from analytic import RigidBlock, simulate
from analytic.response import Outcome, Reason
from engines import Scene
from engines.run.drive import build, run

pytestmark = pytest.mark.skipif("dart" not in HERE, reason="dartpy is not installed")

MOTION = pulse(1.3, 3.0, 2)


def peak(sign=1.0, **options):
    motion = replace(MOTION, amplitude=sign * MOTION.amplitude)
    return run("dart", scene(motion, **options)).peak_ratio


def test_some_of_the_sweep():
    """The steps are of second order, 1/200^2 = 2.5e-5 times a factor that is below one here."""
    errors = errors_of_sweep("dart", every=96)
    assert np.median(errors) < 1e-5
    assert max(errors) < 1e-4


def test_friction_that_has_no_mass_is_left_to_another_solver():
    """Out of the plane nothing moves a planar block on a base of its own plane: the response is no
    longer the mirror image of its mirror's, unless the base can slide aside."""
    assert peak(1.0) == pytest.approx(peak(-1.0), rel=1e-12)
    beside = {"aside": False}
    there, back = (peak(sign, settings=beside) for sign in (1.0, -1.0))
    assert abs(there / back - 1.0) > 1e-5


def test_a_mass_brings_no_inertia():
    """Set by its mass alone, a block keeps the moments of inertia of 1 kg m2 and hardly rocks."""
    assert peak(preset="naive", settings={"exact_inertia": False}) < 0.1 * peak(preset="naive")


def test_of_a_pair_the_smaller_friction_counts():
    motion = scene(MOTION)
    world = build(HERE["dart"], motion)
    world._floor.getShapeNode(0).getDynamicsAspect().setFrictionCoeff(0.05)
    assert "friction was set to 10.0 but reads 0.05" in world._read_back(motion)
    world.close()


@pytest.mark.parametrize("preset", ["naive", "landing"])
def test_a_base_moved_by_position_leaves_the_block_behind(preset):
    response = run(
        "dart", scene(MOTION, preset=preset, frame="world", settings={"floor": "position"})
    )
    assert response.outcome is Outcome.FAILED
    assert "slid" in response.message


def test_corrections_go_by_the_unit_of_length():
    """In metres a pivot is pushed out of its margin at up to 1 mm/s, in 1e-5 m at 1e-8 m/s."""
    exact = simulate(BLOCK, MOTION).peak_ratio
    fine, coarse = (abs(peak(settings={"unit": unit}) / exact - 1.0) for unit in (1e5, 1.0))
    assert fine < 1e-4 < 1e-3 < coarse


def test_space_begins_as_the_plane_does():
    """Four corners on a free joint move as two in the plane, also where they set out in a swing."""
    start = (0.4 * BLOCK.alpha, 0.2 * BLOCK.p * BLOCK.alpha)
    plane, space = (
        run("dart", scene(MOTION, start=start, settings=settings)).peak_ratio
        for settings in ({}, {"planar": False, "aside": False})
    )
    assert space == pytest.approx(plane, rel=1e-5)


def test_a_release_without_an_option_has_it_off(monkeypatch):
    """One that cannot split impulses does as one that does not, and not as one that does."""
    import dartpy

    as_it_is = peak(preset="fixed")
    solver = dartpy.constraint.ConstraintSolver
    for name in ("isSplitImpulseEnabled", "setSplitImpulseEnabled"):
        monkeypatch.delattr(solver, name)
    for name in ("getDeactivationOptions", "setDeactivationOptions"):
        monkeypatch.delattr(dartpy.simulation.World, name)
    assert peak(preset="fixed") == as_it_is
    asked = run("dart", scene(MOTION, preset="fixed", settings={"split_impulse": True}))
    assert asked.outcome is Outcome.FAILED
    assert "split impulse was set to True but reads False" in asked.message


def test_friction_is_bounded_by_normal_forces_without_friction():
    """The pulse needs a friction of 0.66, and its pivot slides away with 1: on one corner the
    library's solver allows the friction of a normal force that it finds without friction."""
    block = RigidBlock(width=0.5, height=1.0)
    hard = Scene(system=block, motion=pulse(3.1, 2.0, 1, block), preset="naive")
    assert 0.65 < simulate(block, hard.motion).friction_needed < 0.66
    assert run("dart", hard).reason is Reason.SLID
    for solver in ("NSGS", "FBF"):
        held = run("dart", replace(hard, settings={"solver": solver}))
        assert held.outcome is Outcome.OVERTURNED, held.message
