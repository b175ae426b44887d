"""Slips in closed form against plain time stepping and Newmark's formulas."""

import math

import numpy as np
import pytest
from given import FULL_SINE, G
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import Outcome, Record, SinePulse, SlidingBlock, Still, simulate
from analytic.response import Reason


def box(friction, **more):
    return SlidingBlock(width=1.0, height=0.5, friction=friction, **more)


def stepped(block, motion, end, v=0.0):
    """Return slips, last place and time by steps of constant acceleration: to dt^2 at each stop."""
    # whole steps to the end of the motion, and to each sample of a record
    dt = motion.duration / math.ceil(motion.duration / 1e-5)
    time = dt * (np.arange(round(end / dt)) + 0.5)
    brake, x, begin, slips = block.friction * block.gravity, 0.0, 0.0, []
    for a in motion.acceleration(time).tolist():
        left = dt
        if v != 0.0:
            gain = -a - math.copysign(brake, v)
            stop = -v / gain if v * gain < 0.0 else math.inf
            part = min(stop, left)
            x += part * (v + 0.5 * part * gain)
            v = v + part * gain if stop > left else 0.0
            left -= part
            if v == 0.0:
                slips.append(x - begin)
                begin = x
        if v == 0.0 and abs(a) > brake:
            gain = -a + math.copysign(brake, a)
            x, v = x + 0.5 * gain * left**2, gain * left
    return ([*slips, x - begin] if v != 0.0 else slips), x, time[-1] + 0.5 * dt


@pytest.mark.parametrize(
    ("friction", "printed"),
    [
        (0.3, (-0.029501431, 0.029501431)),
        (0.2, (-0.125811735, 0.132110191)),
        (0.1, (-0.307191864, 0.179053875)),
    ],
)
def test_slips_of_a_full_sine(friction, printed):
    """Rounded to nine decimals; the stepping errs by some dt^2 = 1e-10 times u'' = 4."""
    response = simulate(box(friction), FULL_SINE)
    slips, _, _ = stepped(box(friction), FULL_SINE, 2.0)
    assert response.outcome is Outcome.SLID
    assert response.slips == pytest.approx(printed, abs=6e-10)
    assert response.slips == pytest.approx(slips, abs=1e-8)
    assert response.peak_ratio == 0.0


def test_a_launched_cube():
    """v/(mu g) and v^2/(2 mu g), to rounding."""
    cube = SlidingBlock(width=1.0, height=1.0, friction=0.5)
    response = simulate(cube, Still(), start=(0.0, 6.0))
    assert response.slips == pytest.approx((3.669725,), abs=5e-7)
    ((begin, end),) = response.slip_times
    assert (begin, end) == pytest.approx((0.0, 1.223242), abs=5e-7)
    assert response.slips[0] == pytest.approx(36.0 / G, rel=1e-14)
    mirrored = simulate(cube, Still(), start=(2.0, -6.0), duration=0.5, times=[0.0, 0.25, 0.5])
    assert mirrored.slips == pytest.approx((-3.0 + 0.25 * 0.25 * G,), rel=1e-14)
    assert mirrored.history.theta[-1] == pytest.approx(2.0 + mirrored.slips[0], rel=1e-14)
    assert mirrored.history.velocity == pytest.approx(-6.0 + 0.5 * G * mirrored.history.time)


@pytest.mark.parametrize("a", [0.25, 0.5, 2.0])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_rectangular_pulse(a, sign):
    """Newmark (1965): D = V^2/(2 mu g) (1 - mu g/A), to rounding."""
    pulse, limit = Record(dt=0.3, samples=np.full(2, sign * a * G)), 0.2 * G
    velocity = a * G * 0.3
    distance = velocity**2 / (2.0 * limit) * (1.0 - limit / (a * G))
    response = simulate(box(0.2), pulse)
    assert response.slips == pytest.approx((-sign * distance,), rel=1e-13)
    assert response.slip_times[0] == pytest.approx((0.0, velocity / limit), rel=1e-13)


def test_below_and_above_mu_g():
    for part, outcome in ((1.0, Outcome.AT_REST), (1.0 + 1e-9, Outcome.SLID)):
        pulse = SinePulse(amplitude=part * 0.2 * G, omega=3.0, half_cycles=10)
        assert simulate(box(0.2), pulse).outcome is outcome
    endless = SinePulse(amplitude=0.2 * G, omega=3.0, half_cycles=10**12)
    assert simulate(box(0.2), endless).outcome is Outcome.AT_REST
    failed = simulate(box(0.19), endless)
    assert (failed.outcome, failed.reason) == (Outcome.FAILED, Reason.UNDECIDED)


@settings(max_examples=25, deadline=None)
@given(
    st.integers(0, 10**6),
    st.floats(0.05, 0.5),
    st.floats(-1.0, 1.0).map(lambda v: round(v, 6)),  # below 1e-150 a start is refused
    st.booleans(),
)
def test_any_motion_against_stepping(seed, friction, v, smooth):
    """The stepping errs by dt^2 = 1e-10 times the second derivative of u'', 4000, for a second."""
    draw = np.random.default_rng(seed)
    if smooth:
        motion = SinePulse(
            amplitude=draw.uniform(0.5, 10.0),
            omega=draw.uniform(1.0, 20.0),
            half_cycles=int(draw.integers(1, 6)),
            phase=draw.uniform(-4.0, 8.0),
        )
    else:
        motion = Record(dt=1e-5 * draw.integers(1000, 20000), samples=draw.normal(0.0, 4.0, 20))
    slips, x, end = stepped(box(friction), motion, motion.duration + 0.5, v)
    response = simulate(box(friction), motion, start=(0.0, v), duration=end, times=[0.0, end])
    assert response.history.theta[-1] == pytest.approx(x, abs=4e-7)
    assert sum(response.slips) == pytest.approx(response.history.theta[-1], abs=1e-12)
    found = [slip for slip in response.slips if abs(slip) > 1e-4]
    assert found == pytest.approx([s for s in slips if abs(s) > 1e-4], abs=4e-7)
