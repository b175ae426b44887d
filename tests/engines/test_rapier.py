"""Rapier: how near single precision comes, and the traps that it sets without a word."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from declared import equal_to
from test_landing import errors_of_sweep
from uses import BLOCK, HERE, pulse, scene

from analytic import RigidBlock, SinePulse, simulate
from analytic.motion import Still
from analytic.response import Outcome
from engines import Scene
from engines.run.drive import run
from studies.cases.drawn import draw
from studies.cases.extreme import extremes

pytestmark = pytest.mark.skipif("rapier" not in HERE, reason="rapier3d is not installed")

MOTION = pulse(1.3, 3.0, 2)


def rocked(preset="landing", **settings):
    return run("rapier", scene(MOTION, preset=preset, settings=settings))


def error(**settings):
    return abs(rocked(**settings).peak_ratio / simulate(BLOCK, MOTION).peak_ratio - 1.0)


def test_some_of_the_sweep():
    """Thousands of roundings add up to some 1e-4; one at an impact may cost ten times that."""
    errors = errors_of_sweep("rapier", every=96)
    assert np.median(errors) < equal_to("rapier") / 6.0
    assert max(errors) < 10.0 * equal_to("rapier")


def test_other_blocks_than_the_papers():
    """Slender, small and large ones, of the random cases: rounding follows the height."""
    cases = {case.case: case for case in islice(draw(1), 78)}
    for number in (7, 14, 72, 77):
        block, motion = cases[number].block, cases[number].motion
        exact, found = simulate(block, motion), run("rapier", Scene(system=block, motion=motion))
        assert found.outcome is exact.outcome
        assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=equal_to("rapier"))


@pytest.mark.parametrize("width", [0.02, 0.5, 9.9, 30.0])
def test_the_size_of_a_block_hardly_matters(width):
    """In metres the largest errs by a tenth, since its corners are rounded by its size."""

    def error(case, **settings):
        block = RigidBlock(width=width, height=width * case.aspect)
        omega = case.omega_over_p * block.p
        motion = replace(case.motion, omega=omega)
        found = run("rapier", Scene(system=block, motion=motion, settings=settings))
        return abs(found.peak_ratio / simulate(block, motion).peak_ratio - 1.0)

    cases = {case.case: case for case in islice(draw(1), 832)}
    assert max(error(cases[number]) for number in (577, 823, 831)) < 1e-4
    if width == 30.0:
        assert error(cases[831], units=None, centred=False) > 0.1


def test_a_ball_whose_centre_rounds_onto_a_deep_base_loses_its_contact():
    """It has no normal there: the block falls freely for a step, now and then."""
    case = next(islice(draw(1), 77, None))
    exact = simulate(case.block, case.motion).peak_ratio

    def error(**settings):
        asked = Scene(system=case.block, motion=case.motion, settings=settings)
        return abs(run("rapier", asked).peak_ratio / exact - 1.0)

    assert error(corner_radius=1e-7, base_depth=1.0) > 30.0 * equal_to("rapier")
    assert error(corner_radius=1e-7) < equal_to("rapier")


def test_contacts_that_are_recycled_let_the_pivot_go():
    """It slides by inches, and the block overturns or leaves the problem."""
    assert rocked().outcome is simulate(BLOCK, MOTION).outcome is Outcome.ROCKED
    assert rocked(recycling=True).outcome is not Outcome.ROCKED


def test_a_block_locked_into_the_plane_has_no_friction():
    """Rotations may be locked, or the translation out of the plane, but not all of them."""
    response = rocked(locked_aside=True)
    assert response.outcome is Outcome.FAILED
    assert "slid" in response.message


def test_a_block_that_sleeps_on_its_base_is_at_rest():
    """It leans there by what the contact yields, which is no rest aloft."""
    weak = SinePulse.in_g(0.9 * BLOCK.width / BLOCK.height, omega=3.0 * BLOCK.p, half_cycles=1)
    posed = Scene(system=BLOCK, motion=weak, preset="naive", duration=3.0, times=(3.0,))
    rested = run("rapier", posed)
    assert rested.outcome is Outcome.AT_REST
    assert 0.0 < abs(rested.history.theta[-1]) < 1e-3 * BLOCK.alpha


def test_a_block_that_sleeps_aloft_has_no_answer():
    """A slender one is slow enough at the turn of its swing to be put to sleep there."""
    case = next(case for case in extremes(False) if case.name == "H/B 50")
    posed = Scene(system=case.block, motion=case.motion, preset="naive", duration=case.duration)
    slept = run("rapier", posed)
    assert slept.outcome is Outcome.FAILED
    assert "to sleep aloft" in slept.message


def test_gravity_that_changes_wakes_nothing():
    """A block that was put to sleep before it lifts stays where it is, and is no endless run."""
    motion = pulse(1.3, 0.3)
    asleep = run("rapier", scene(motion, preset="naive", frame="base"))
    assert asleep.outcome is Outcome.AT_REST
    assert asleep.steps < 2000
    awake = run("rapier", scene(motion, preset="naive", frame="base", settings={"sleeping": False}))
    assert awake.outcome is simulate(BLOCK, motion).outcome


def test_a_soft_contact_and_the_stabilization_cost_all_accuracy():
    """The library's own contact has a spring of 30 Hz, and takes velocities out again."""
    best = error()
    assert best < 2.0 * equal_to("rapier")
    assert error(stabilization=1) > 10.0 * best
    assert error(frequency=30.0, damping_ratio=10.0, correction=None) > 10.0 * best


def test_swings_that_rounding_hides_are_left_to_the_contacts():
    """Below 1e-6 of the height a swing cannot be told from rest, and need not be followed."""
    start = (1e-3 * BLOCK.alpha, 0.0)
    asked = Scene(system=BLOCK, motion=Still(), start=start, duration=8.0 / BLOCK.p)
    assert run("rapier", asked).steps < 10_000
