"""Rapier: where single precision shows, and the traps that it sets without a word."""

from dataclasses import replace
from itertools import islice

import pytest
from declared import equal_to
from uses import BLOCK, HERE, agreed, error, rocked

from analytic import RigidBlock, SinePulse
from analytic.motion import Still
from analytic.response import Outcome
from studies.cases.drawn import draw
from studies.cases.extreme import extremes

pytestmark = pytest.mark.skipif("rapier" not in HERE, reason="rapier3d is not installed")


@pytest.fixture(scope="module")
def drawn():
    return list(islice(draw(1), 832))


def test_other_blocks_than_the_papers(drawn):
    """Slender, small and large ones, of the random cases: rounding follows the height."""
    for number in (7, 14, 72, 77):
        case = drawn[number]
        exact, found = agreed("rapier", case.motion, system=case.block)
        assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=equal_to("rapier"))


@pytest.mark.parametrize("width", [0.02, 0.5, 9.9, 30.0])
def test_the_size_of_a_block_hardly_matters(width, drawn):
    """In metres the largest errs by a tenth, since its corners are rounded by its size."""

    def missed(number, **settings):
        case = drawn[number]
        block = RigidBlock(width=width, height=width * case.aspect)
        motion = replace(case.motion, omega=case.omega_over_p * block.p)
        return error("rapier", motion, system=block, settings=settings)

    assert max(map(missed, (577, 823, 831))) < 1e-4
    if width == 30.0:
        assert missed(831, units=None, centred=False) > 0.1


def test_a_ball_whose_centre_rounds_onto_a_deep_base_loses_its_contact(drawn):
    """It has no normal there: the block falls freely for a step, now and then."""
    asked = {"motion": drawn[77].motion, "system": drawn[77].block}
    small = {"corner_radius": 1e-7}
    assert error("rapier", **asked, settings=small) < equal_to("rapier")
    deep = {**small, "base_depth": 1.0}
    assert error("rapier", **asked, settings=deep) > 30.0 * equal_to("rapier")


def test_contacts_that_are_recycled_let_the_pivot_go():
    """It slides by inches, and the block overturns or leaves the problem."""
    assert agreed("rapier")[1].outcome is Outcome.ROCKED
    assert rocked("rapier", settings={"recycling": True}).outcome is not Outcome.ROCKED


def test_a_block_that_sleeps_on_its_base_is_at_rest():
    """It leans there by what the contact yields, which is no rest aloft."""
    weak = SinePulse.in_g(0.9 * BLOCK.width / BLOCK.height, omega=3.0 * BLOCK.p, half_cycles=1)
    rested = rocked("rapier", weak, preset="naive", duration=3.0, times=(3.0,))
    assert rested.outcome is Outcome.AT_REST
    assert 0.0 < abs(rested.history.theta[-1]) < 1e-3 * BLOCK.alpha


def test_a_block_that_sleeps_aloft_has_no_answer():
    """A slender one is slow enough at the turn of its swing to be put to sleep there."""
    case = next(case for case in extremes(False) if case.name == "H/B 50")
    asked = {"system": case.block, "duration": case.duration}
    slept = rocked("rapier", case.motion, preset="naive", **asked)
    assert slept.outcome is Outcome.FAILED
    assert "to sleep aloft" in slept.message


def test_a_soft_contact_and_the_stabilization_cost_all_accuracy():
    """The library's own contact has a spring of 30 Hz, and takes velocities out again."""
    best = error("rapier")
    assert best < 2.0 * equal_to("rapier")
    soft = {"frequency": 30.0, "damping_ratio": 10.0, "correction": None}
    for settings in ({"stabilization": 1}, soft):
        assert error("rapier", settings=settings) > 10.0 * best


def test_swings_that_rounding_hides_are_left_to_the_contacts():
    """Below 1e-6 of the height a swing cannot be told from rest, and need not be followed."""
    start = (1e-3 * BLOCK.alpha, 0.0)
    assert rocked("rapier", Still(), start=start, duration=8.0 / BLOCK.p).steps < 10_000
