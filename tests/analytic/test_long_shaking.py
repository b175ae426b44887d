"""Long shaking, and the symmetric orbits of the linear model, against the solver.

What is printed of both is a table of `rocking literature`.
"""

import math
from dataclasses import replace

import numpy as np
import pytest

from analytic import RigidBlock, SinePulse, simulate
from analytic.criteria import frictionless_fall
from analytic.orbits import orbit_limits
from studies.literature.prints import PROBLEMS
from studies.literature.problems import SteadyState

R, W = 0.925, 4.0
BLOCK = RigidBlock(width=0.18, height=1.0, restitution=R)
STEADY = [problem for problem in PROBLEMS if isinstance(problem, SteadyState)]


@pytest.mark.parametrize("shaken", STEADY, ids=lambda problem: problem.name)
def test_long_shaking_is_the_sum_of_its_periods(shaken):
    """A period at a time, from the state that the last one left: nothing drifts with time."""
    whole = shaken.pulse
    last = simulate(shaken.block, whole, start=shaken.start, times=[whole.duration]).history
    one, state = replace(whole, half_cycles=2), shaken.start
    for _ in range(whole.half_cycles // 2):
        history = simulate(shaken.block, one, start=state, times=[one.duration]).history
        state = (float(history.theta[0]), float(history.velocity[0]))
    # the phase of a time keeps 1e-16 of it, here some 4e-13 rad of a period
    assert float(last.theta[0]) == pytest.approx(state[0], abs=1e-11)


def test_a_half_cycle_costs_the_same_however_many_there_were():
    shaken = STEADY[1]
    steps = [
        simulate(shaken.block, replace(shaken.pulse, half_cycles=it), start=shaken.start).steps
        for it in (1000, 2000, 4000, 8000)
    ]
    assert np.diff(steps) / [1000, 2000, 4000] == pytest.approx([4.5] * 3, rel=1e-2)


def impact_gaps(beta, periods=600):
    """Return the half periods of shaking between late impacts and the rates after them, from near
    the phase at which an orbit's swing to the right begins."""
    omega, rise = W * BLOCK.p, math.tanh(1.5 * math.pi / W)
    birth, _ = orbit_limits(R, W, 3)
    impact = math.atan2((1.0 + R) / rise, (1.0 - R) * W) + math.pi - math.asin(birth / beta)
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
    _, loss = orbit_limits(R, W, 3)
    gaps, speeds = impact_gaps(0.99 * loss)
    assert gaps == pytest.approx(3.0, abs=1e-6)
    assert speeds == pytest.approx(speeds[0], rel=1e-6)
    gaps, speeds = impact_gaps(1.01 * loss)
    assert np.ptp(speeds) > 1e-3 * speeds[0]


def test_a_block_without_friction_falls_back_from_nearly_flat():
    """A low tilt falls with the moment of the weight about the centre: theta'' = -a, steadily."""
    block = RigidBlock(width=1.0, height=0.5)
    gyration = (block.width**2 + block.height**2) / 12.0
    lever = 0.5 * block.width
    steady = block.gravity * lever / (gyration + lever**2)
    found = frictionless_fall(block, 1e-6)
    assert found == pytest.approx((math.sqrt(2e-6 / steady), math.sqrt(2e-6 * steady)), rel=1e-5)
