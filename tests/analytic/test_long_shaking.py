"""Long shaking: nothing drifts, and the linear model has the orbits that Hogan (1989) derives."""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import RigidBlock, SinePulse, simulate

R, W = 0.925, 4.0
BLOCK = RigidBlock(width=0.18, height=1.0, restitution=R)
BIRTH, LOSS = 0.449115, 1.640448
"""Amplitudes over alpha g between which the linear block has a stable orbit with a strike after
every third half period, as printed in the 10th World Conference on Earthquake Engineering, 1992,
pp. 3973-3977, eqs. (11)-(19)."""
SLENDER = RigidBlock(width=0.65, height=3.6, restitution=0.88)
SETTLING = {3.07: (0.3, 0.0), 1.9: (0.5, 0.0), 4.9: (0.4, 0.3), 4.14: (0.5, 0.3)}
"""omega/p -> a start in units of alpha and alpha p from which that block settles on an orbit."""


def shaken(omega_over_p):
    """Return 400 periods of a motion 2 alpha g cos(omega t), and the start."""
    (tilt, rate), alpha = SETTLING[omega_over_p], SLENDER.alpha
    motion = SinePulse(
        amplitude=2.0 * alpha * SLENDER.gravity,
        omega=omega_over_p * SLENDER.p,
        half_cycles=800,
        phase=0.5 * math.pi,
    )
    return motion, (tilt * alpha, rate * alpha * SLENDER.p)


@pytest.mark.parametrize("omega_over_p", SETTLING)
def test_long_shaking_is_the_sum_of_its_periods(omega_over_p):
    """A period at a time, from the state that the last one left: nothing drifts with time."""
    whole, state = shaken(omega_over_p)
    last = simulate(SLENDER, whole, start=state, times=[whole.duration]).history
    one = replace(whole, half_cycles=2)
    for _ in range(whole.half_cycles // 2):
        history = simulate(SLENDER, one, start=state, times=[one.duration]).history
        state = (float(history.theta[0]), float(history.velocity[0]))
    # the phase of a time keeps 1e-16 of it, here some 4e-13 rad of a period
    assert float(last.theta[0]) == pytest.approx(state[0], abs=1e-11)


def test_a_half_cycle_costs_the_same_however_many_there_were():
    pulse, start = shaken(1.9)
    steps = [
        simulate(SLENDER, replace(pulse, half_cycles=it), start=start).steps
        for it in (1000, 2000, 4000, 8000)
    ]
    assert np.diff(steps) / [1000, 2000, 4000] == pytest.approx([4.5] * 3, rel=1e-2)


def impact_gaps(beta, periods=600):
    """Return the half periods of shaking between late impacts and the rates after them, from near
    the phase at which an orbit's swing to the right begins."""
    omega, rise = W * BLOCK.p, math.tanh(1.5 * math.pi / W)
    impact = math.atan2((1.0 + R) / rise, (1.0 - R) * W) + math.pi - math.asin(BIRTH / beta)
    motion = SinePulse(
        amplitude=beta * BLOCK.alpha * BLOCK.gravity,
        omega=omega,
        half_cycles=2 * periods,
        phase=impact + 0.5 * math.pi,
    )
    start = (0.0, 1.13 * BLOCK.alpha * BLOCK.p)
    response = simulate(BLOCK, motion, "housner", start, duration=motion.duration)
    late = [i for i in response.impacts if i.time > 0.9 * motion.duration]
    gaps = np.diff([i.time for i in late]) * omega / math.pi
    return gaps, np.abs([i.velocity_after for i in late])


def test_the_solver_settles_on_the_orbit_up_to_its_loss():
    """Below the limit every swing lasts three half periods; above it swings differ in turn."""
    gaps, speeds = impact_gaps(0.99 * LOSS)
    assert gaps == pytest.approx(3.0, abs=1e-6)
    assert speeds == pytest.approx(speeds[0], rel=1e-6)
    gaps, speeds = impact_gaps(1.01 * LOSS)
    assert np.ptp(speeds) > 1e-3 * speeds[0]
