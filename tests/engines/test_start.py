"""A run that begins aloft: released from a tilt, set turning upright, or sliding away under it.

`uses.band` says how near landing steps come; fixed ones carry the p dt of the impact's step.
"""

import itertools
import math

import numpy as np
import pytest
from declared import rounding
from uses import (
    BLOCK,
    CORE,
    HERE,
    LANDING,
    band,
    every_fixed_use,
    every_landing_use,
    pulse,
    rocked,
    scene,
    speed_band,
)

from analytic import RigidBlock, simulate
from analytic.criteria import free_amplitude, frictionless_fall, quarter_period
from analytic.motion import SinePulse, Still
from analytic.response import Outcome, Reason

STILL = Still()
TILT = 0.4 * BLOCK.alpha
LANDING_IN_FRAMES = [(*use, frame) for use in LANDING for frame in HERE[use[0]].frames]


BALANCED = (BLOCK.alpha, 0.0)
COSINE = {
    side: SinePulse(amplitude=4.0 * side, omega=8.0, half_cycles=2, phase=0.5 * math.pi)
    for side in (1.0, -1.0)
}


def released(engine, start, **options):
    """Return the response of a block that is let go over a base at rest."""
    return rocked(engine, STILL, start=start, duration=8.0 / BLOCK.p, **options)


def top(theta, rate):
    """Return the rotation [rad] at which a block that sets out so would turn, by its energy."""
    height = math.cos(BLOCK.alpha - abs(theta)) + 0.5 * (rate / BLOCK.p) ** 2
    return BLOCK.alpha - math.acos(height)


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("engine", "preset", "frame"), LANDING_IN_FRAMES)
def test_quarter_period_and_decay(engine, preset, frame, side):
    """The first impact comes after a quarter period, the next after two of what energy leaves."""
    response = released(engine, (side * TILT, 0.0), preset=preset, frame=frame)
    times = [impact.time for impact in response.impacts]
    assert response.outcome is Outcome.ROCKED
    # where it was released, as the engine's numbers have it
    assert response.peak_ratio == pytest.approx(0.4, rel=rounding(engine))
    assert not response.crossed
    assert response.uplifts == ()
    assert times[0] == pytest.approx(quarter_period(BLOCK, TILT), rel=band(engine))
    for n, gap in enumerate(np.diff(times[:5]), start=1):
        swing = 2.0 * quarter_period(BLOCK, free_amplitude(BLOCK, TILT, n))
        assert gap == pytest.approx(swing, rel=band(engine))
    speed = BLOCK.p * math.sqrt(2.0 * (math.cos(BLOCK.alpha - TILT) - math.cos(BLOCK.alpha)))
    first, nearly = response.impacts[0], speed_band(engine)
    assert first.velocity_before == pytest.approx(-side * speed, rel=nearly)
    assert first.ratio == pytest.approx(BLOCK.restitution, rel=nearly)


@pytest.mark.parametrize("side", [1.0, -1.0])
@every_landing_use
def test_set_turning_while_upright(engine, preset, side):
    """The rate says about which corner: the block rises as far as its energy carries it."""
    rate = side * 0.5 * BLOCK.p * BLOCK.alpha
    response = released(engine, (0.0, rate), preset=preset)
    peak = top(0.0, rate)
    assert response.peak_ratio == pytest.approx(peak / BLOCK.alpha, rel=band(engine))
    assert response.impacts[0].time == pytest.approx(
        2.0 * quarter_period(BLOCK, peak), rel=band(engine)
    )
    nearly = max(1e-3, speed_band(engine))
    assert response.impacts[0].velocity_before == pytest.approx(-rate, rel=nearly)


@every_landing_use
def test_set_out_inward(engine, preset):
    """The start is the peak before the impact, and what it leaves comes after."""
    rate = -0.55 * BLOCK.p * BLOCK.alpha
    response = released(engine, (TILT, rate), preset=preset)
    after = free_amplitude(BLOCK, top(TILT, rate), 1)
    assert response.peak_ratio == pytest.approx(max(TILT, after) / BLOCK.alpha, rel=band(engine))
    assert after > TILT


@every_fixed_use
def test_equal_steps(engine):
    """A release falls freely until its impact, whose velocity an equal step misses by its p dt."""
    response = released(engine, (TILT, 0.0), preset="fixed", step=1e-3)
    times = [impact.time for impact in response.impacts]
    assert times[0] == pytest.approx(quarter_period(BLOCK, TILT), rel=1e-3)
    swing = 2.0 * quarter_period(BLOCK, free_amplitude(BLOCK, TILT, 1))
    assert times[1] - times[0] == pytest.approx(swing, rel=1e-2)


@pytest.mark.parametrize("engine", CORE)
def test_steps_are_of_second_order_from_the_first_on(engine):
    """A first step with the wrong inertia, or a whole kick, would leave an error of first order."""
    exact = quarter_period(BLOCK, TILT)
    coarse, fine = (
        abs(released(engine, (TILT, 0.0), step=step).impacts[0].time - exact)
        for step in (4e-2, 1e-2)
    )
    assert fine < 0.15 * coarse


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("engine", "preset", "frame"), LANDING_IN_FRAMES)
def test_start_then_pulse(engine, preset, frame, side):
    """Released into a pulse that shakes it on: against the exact solution."""
    motion = pulse(-0.9 * side, 2.0, 2)
    asked = {
        "start": (side * 0.2 * BLOCK.alpha, side * 0.1 * BLOCK.p * BLOCK.alpha),
        "duration": motion.duration,
        "times": np.linspace(0.0, motion.duration, 200).tolist(),
    }
    response = rocked(engine, motion, preset=preset, frame=frame, **asked)
    exact = simulate(BLOCK, motion, **asked)
    assert response.history.theta == pytest.approx(
        exact.history.theta, abs=2.0 * band(engine) * BLOCK.alpha
    )
    assert len(exact.impacts) >= 1
    found = [impact.time for impact in response.impacts]
    assert found == pytest.approx(
        [impact.time for impact in exact.impacts], abs=2.0 * band(engine) / BLOCK.p
    )


@pytest.mark.parametrize("side", [1.0, -1.0])
@pytest.mark.parametrize(("engine", "preset", "frame"), LANDING_IN_FRAMES)
def test_lifted_at_once(engine, preset, frame, side):
    """A cosine lifts the block with the first step, in which it must have its own inertia."""
    exact = simulate(BLOCK, COSINE[side])
    assert exact.uplifts[0] == 0.0
    found = rocked(engine, COSINE[side], preset=preset, frame=frame)
    assert found.outcome is exact.outcome
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=band(engine))
    assert found.uplifts[0] == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("engine", CORE)
def test_lifted_at_once_is_of_second_order(engine):
    """Steps of a fifth: an error of first order would keep a fifth."""
    exact = simulate(BLOCK, COSINE[1.0]).peak_ratio
    coarse, fine = (
        abs(rocked(engine, COSINE[1.0], accuracy=name).peak_ratio / exact - 1.0)
        for name in ("loose", "standard")
    )
    assert fine < 0.12 * coarse


@pytest.mark.parametrize("engine", HERE)
def test_beyond_alpha_and_back(engine):
    """A block past its balance that moves inward fast enough comes back; one at rest falls."""
    tilt = 1.2 * BLOCK.alpha
    barrier = BLOCK.p * math.sqrt(2.0 * (1.0 - math.cos(BLOCK.alpha - tilt)))
    back = released(engine, (tilt, -1.1 * barrier))
    assert (back.outcome, back.crossed) == (Outcome.ROCKED, True)
    assert back.peak_ratio == pytest.approx(1.2, rel=rounding(engine))
    for rate in (0.0, -0.9 * barrier):
        assert released(engine, (tilt, rate)).outcome is Outcome.OVERTURNED


@pytest.mark.parametrize("engine", HERE)
def test_a_small_release_comes_to_rest(engine):
    response = released(engine, (1e-3 * BLOCK.alpha, 0.0))
    assert response.outcome is Outcome.ROCKED
    assert response.peak_ratio == pytest.approx(1e-3, rel=rounding(engine))
    assert response.uplifts == ()


def test_a_balanced_block_may_be_shaken():
    """It falls to the side from which the base is moved away, as the exact solution does."""
    motion = SinePulse(amplitude=1.0, omega=10.0)
    exact = simulate(BLOCK, motion, start=BALANCED)
    for engine in CORE:
        assert rocked(engine, motion, start=BALANCED).outcome is exact.outcome


def test_the_corner_stays_where_it_stands():
    """Place and velocity of the start leave the corner that carries the block at rest."""
    cases = itertools.product((0.2, -0.2, 0.0), (0.7, -0.7))
    for theta, rate in cases:
        posed = scene(STILL, start=(theta, rate))
        at = posed.bodies[0].at
        sine, cosine = math.sin(theta), math.cos(theta)
        x, z = 0.5 * posed.side * BLOCK.width, -0.5 * BLOCK.height
        corner = (at.x + x * cosine + z * sine, at.z - x * sine + z * cosine)
        speed = (
            at.velocity_x + rate * (-x * sine + z * cosine),
            at.velocity_z + rate * (-x * cosine - z * sine),
        )
        assert corner == pytest.approx((x, 0.0), abs=1e-15)
        assert speed == pytest.approx((0.0, 0.0), abs=1e-15)


FLAT = RigidBlock(width=1.0, height=0.5)


@pytest.mark.parametrize("side", [1.0, -1.0])
@every_landing_use
def test_a_slide_is_no_failure_where_it_is_meant(engine, preset, side):
    """The centre falls straight down, so that the corner slides by half of what the width loses."""
    theta = 0.3
    time, rate = frictionless_fall(FLAT, theta)
    start, until = (side * theta, 0.0), 1.05 * time
    asked = {"system": FLAT, "start": start, "preset": preset, "duration": until}
    response = rocked(engine, STILL, **asked, friction=0.0)
    strike = response.impacts[0]
    # steps of p dt = 1/200 are of second order; the pivot is helped as if it stood
    assert strike.time == pytest.approx(time, rel=2e-4)
    assert strike.velocity_before == pytest.approx(-side * rate, rel=1e-3)
    corner = 0.5 * (FLAT.width * math.cos(theta) - FLAT.height * math.sin(theta))
    assert response.slip_m == pytest.approx(abs(corner - 0.5 * FLAT.width), rel=0.05)


@pytest.mark.parametrize("engine", HERE)
def test_a_slide_is_a_failure_where_there_is_friction(engine):
    response = rocked(engine, STILL, system=FLAT, start=(0.9, 0.0), friction=1e-6)
    assert response.reason is Reason.SLID


def test_friction_is_not_negative():
    with pytest.raises(ValueError, match=r"friction is -0\.1; it must not be negative"):
        scene(STILL, friction=-0.1)
