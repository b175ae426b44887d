"""Symmetric orbits of the linear model: where they are born and lost, against the solver."""

import math

import numpy as np
import pytest

from analytic import RigidBlock, SinePulse, simulate
from analytic.criteria import frictionless_fall
from analytic.orbits import orbit_limits

R, W = 0.925, 4.0
BLOCK = RigidBlock(width=0.18, height=1.0, restitution=R)


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


def test_printed_limits():
    """Hogan 1992, equations (11) to (19)."""
    assert orbit_limits(R, W, 1)[1] == pytest.approx(9.63982, abs=5e-6)
    assert orbit_limits(R, W, 3) == pytest.approx((0.449115, 1.640448), abs=5e-7)


def test_the_solver_settles_on_the_orbit_up_to_its_loss():
    """Below the limit every swing lasts three half periods; above it swings differ in turn."""
    _, loss = orbit_limits(R, W, 3)
    gaps, speeds = impact_gaps(0.99 * loss)
    assert gaps == pytest.approx(3.0, abs=1e-6)
    assert speeds == pytest.approx(speeds[0], rel=1e-6)
    gaps, speeds = impact_gaps(1.01 * loss)
    assert np.ptp(speeds) > 1e-3 * speeds[0]


def test_a_block_without_friction():
    """Siconos, RockingBlock, LsodarOSI; and the same block falling back from nearly flat."""
    block = RigidBlock(width=1.0, height=0.5)
    time, rate = frictionless_fall(block, math.pi / 3.0)
    assert time == pytest.approx(0.5874779745738901, rel=1e-12)
    assert rate == pytest.approx(4.130760093379687, rel=1e-12)
    # a low tilt falls with the moment of the weight about the centre: theta'' = -a, steadily
    gyration = (block.width**2 + block.height**2) / 12.0
    lever = 0.5 * block.width
    steady = block.gravity * lever / (gyration + lever**2)
    time, rate = frictionless_fall(block, 1e-6)
    assert (time, rate) == pytest.approx(
        (math.sqrt(2e-6 / steady), math.sqrt(2e-6 * steady)), rel=1e-5
    )
    with pytest.raises(ValueError, match="theta"):
        frictionless_fall(block, block.alpha)
