"""The block and the base motions."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st

from analytic import (
    MODELS,
    Outcome,
    RigidBlock,
    SinePulse,
    conditioning,
    housner_restitution,
    simulate,
)


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
