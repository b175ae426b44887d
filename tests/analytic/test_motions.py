"""What must hold of every block and every ground motion."""

import math
import warnings

import numpy as np
import pytest
from given import FULL_SINE, WANDERING
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from analytic import MODELS, Delayed, Outcome, RigidBlock, SinePulse, housner_restitution, simulate
from analytic.conditioning import conditioning

MOTIONS = {
    "half sine": SinePulse(amplitude=3.0, omega=5.0),
    "sines": SinePulse(amplitude=-2.0, omega=9.0, half_cycles=5),
    "cosine": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=2, phase=0.5 * math.pi),
    "phase below 0": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=6, phase=-1.0),
    "phase beyond pi": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=3, phase=4.0),
    "after a rest": Delayed(FULL_SINE, 1.25),
    "record": WANDERING,
}


@pytest.fixture(params=MOTIONS)
def motion(request):
    return MOTIONS[request.param]


def test_velocity_and_displacement_are_the_integrals(motion):
    times = np.linspace(0, 1.3 * motion.duration, 6)[1:]
    for t in times:
        inside = [b for b in motion.breakpoints if 0 < b < t]
        options = {"points": inside or None, "limit": 400, "epsabs": 1e-13}
        velocity, _ = quad(motion.acceleration, 0, t, **options)
        displacement, _ = quad(motion.velocity, 0, t, **options)
        assert motion.velocity(t) == pytest.approx(velocity, abs=1e-11)
        assert motion.displacement(t) == pytest.approx(displacement, abs=1e-11)


def test_its_segments_are_its_acceleration(motion):
    assert (motion.breakpoints[0], motion.breakpoints[-1]) == (0, motion.duration)
    assert all(np.diff(motion.breakpoints) > 0)
    assert motion.acceleration([-1e-9, motion.duration + 1e-9]).tolist() == [0, 0]
    rows = motion.segments()
    assert rows[0, 0] == 0
    assert rows[-1, 1] == motion.duration
    assert (rows[1:, 0] == rows[:-1, 1]).all()
    for start, end, amplitude, omega, phase, offset, slope in rows:
        since = np.linspace(0.001, 0.999, 7) * (end - start)
        expected = amplitude * np.sin(omega * since + phase) + offset + slope * since
        assert motion.acceleration(start + since) == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize(
    ("aspect", "eta"), [(2, 0.7), (3, 0.85), (4, 0.911764705882353), (1 / 1.5, 0)]
)
def test_restitution_of_the_papers_blocks(aspect, eta):
    """A squat one comes to rest at its first impact."""
    block = RigidBlock(width=1, height=aspect)
    assert block.restitution == pytest.approx(eta, abs=1e-14)
    assert (housner_restitution(block.alpha) < 0) == (eta == 0)


EXTREMES = st.sampled_from([1e-150, 1e-100, 1e-30, 1e-8, 1.0, 1e8, 1e30, 1e100, 1e150])


@settings(max_examples=200, deadline=None)
@given(
    width=EXTREMES, height=EXTREMES, gravity=EXTREMES, amplitude=EXTREMES, omega=EXTREMES,
    model=st.sampled_from(list(MODELS)),
)  # fmt: skip
def test_extreme_input_is_refused_or_answered_without_a_warning(
    width, height, gravity, amplitude, omega, model
):
    try:
        block = RigidBlock(width=width, height=height, gravity=gravity)
        pulse = SinePulse(amplitude=amplitude, omega=omega, half_cycles=2)
    except ValueError as error:
        assert "must be" in str(error)
        reject()
    with warnings.catch_warnings(action="error"), np.errstate(all="warn", under="ignore"):
        response = simulate(block, pulse, model)
        numbers = conditioning(block, pulse, model)
        moved = pulse.displacement(pulse.duration), pulse.velocity(pulse.duration)
    assert np.isfinite(moved).all()
    if response.outcome is Outcome.FAILED:
        assert response.message
        assert np.isnan(numbers).all()


def test_velocity_keeps_its_digits_early_in_the_pulse():
    pulse = SinePulse(amplitude=1.0, omega=1.0)
    assert float(pulse.velocity(1e-7)) == pytest.approx(0.5e-14, rel=1e-12)
    cosine = SinePulse(amplitude=1.0, omega=1.0, phase=0.5 * math.pi)
    assert float(cosine.velocity(1e-7)) == pytest.approx(1e-7, rel=1e-12)
    assert float(cosine.displacement(1e-7)) == pytest.approx(0.5e-14, rel=1e-6)
