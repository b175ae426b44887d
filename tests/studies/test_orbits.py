"""Steady states read from histories that are known in closed form."""

import math

import numpy as np
import pytest
from given import BLOCK

from analytic import SinePulse
from analytic.response import History, Impact, Outcome, Response
from studies.measures.orbits import LAST_PERIODS, orbit_of, sample_times

MOTION = SinePulse(amplitude=4.0, omega=6.0, half_cycles=2 * 60)
FORCING = 2.0 * math.pi / MOTION.omega


def response(theta, rate, impacts=()):
    times = sample_times(MOTION)
    return Response(
        outcome=Outcome.ROCKED,
        peak_ratio=0.5,
        impacts=impacts,
        history=History(times, theta(times), rate(times)),
    )


def swinging(order, shift=0.0):
    """A sine of `order` forcing periods about `shift`, in units of alpha."""
    omega = MOTION.omega / order
    return response(
        lambda t: BLOCK.alpha * (shift + 0.3 * np.sin(omega * t)),
        lambda t: BLOCK.alpha * 0.3 * omega * np.cos(omega * t),
    )


@pytest.mark.parametrize("order", [1, 2, 4, 16])
def test_the_period_is_that_of_the_history(order):
    assert orbit_of(BLOCK, MOTION, swinging(order)).period == order


def test_the_larger_side_comes_first_whichever_it_is():
    for sign in (1.0, -1.0):
        orbit = orbit_of(BLOCK, MOTION, swinging(1, shift=0.1 * sign))
        assert orbit.right / BLOCK.alpha == pytest.approx(0.4, rel=1e-6)
        assert orbit.left / BLOCK.alpha == pytest.approx(0.2, rel=1e-6)


def test_impacts_are_those_of_one_period():
    every = FORCING / 3.0
    count = round(MOTION.duration / every)
    impacts = [Impact((k + 0.5) * every, -1.0, 0.9) for k in range(count)]
    swing = swinging(2)
    orbit = orbit_of(
        BLOCK,
        MOTION,
        Response(
            outcome=swing.outcome,
            peak_ratio=0.5,
            impacts=tuple(impacts),
            history=swing.history,
        ),
    )
    assert orbit.impacts == 6


def test_a_response_that_does_not_repeat_has_no_period():
    incommensurable = MOTION.omega / math.sqrt(2.0)
    wandering = response(
        lambda t: 0.3 * BLOCK.alpha * np.sin(incommensurable * t),
        lambda t: 0.3 * BLOCK.alpha * incommensurable * np.cos(incommensurable * t),
    )
    orbit = orbit_of(BLOCK, MOTION, wandering)
    assert (orbit.period, orbit.impacts) == (0, 0)
    assert orbit.right / BLOCK.alpha == pytest.approx(0.3, rel=1e-4)


def test_what_was_not_sampled_has_no_orbit():
    fallen = Response(outcome=Outcome.OVERTURNED, peak_ratio=math.inf)
    with pytest.raises(ValueError, match="overturned"):
        orbit_of(BLOCK, MOTION, fallen)


def test_samples_fall_on_whole_periods_at_the_end():
    times = sample_times(MOTION)
    assert times[-1] == MOTION.duration
    assert times[-1] - times[0] == pytest.approx(LAST_PERIODS * FORCING, rel=1e-12)


def test_an_orbit_that_still_settles_has_no_period_yet():
    """Every other period it is 1.6e-6 away, a little more than what counts as the same."""
    omega = MOTION.omega
    settling = response(
        lambda t: BLOCK.alpha * (0.3 * np.sin(omega * t) + 8e-7 * np.cos(0.5 * omega * t)),
        lambda t: BLOCK.alpha * 0.3 * omega * np.cos(omega * t),
    )
    assert orbit_of(BLOCK, MOTION, settling).period == 0
