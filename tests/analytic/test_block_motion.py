"""The block and the base motions."""

import math
import warnings

import numpy as np
import pytest
from hypothesis import given, reject, settings
from hypothesis import strategies as st
from scipy.integrate import quad

from analytic import (
    MODELS,
    Impact,
    Outcome,
    Response,
    RigidBlock,
    SinePulse,
    Still,
    conditioning,
    housner_restitution,
    simulate,
)


@pytest.mark.parametrize(("aspect", "eta"), [(2, 0.7), (3, 0.85), (4, 0.911764705882353)])
def test_restitution_of_the_papers_blocks(aspect, eta):
    assert RigidBlock(width=1, height=aspect).restitution == pytest.approx(eta, abs=1e-14)


def test_dimensions():
    block = RigidBlock(width=0.6, height=0.8)
    assert pytest.approx(0.5) == block.R
    assert block.alpha == pytest.approx(math.atan(0.75))
    assert block.p == pytest.approx(math.sqrt(3 * 9.81 / 2))


def test_squat_block_comes_to_rest_at_its_first_impact():
    block = RigidBlock(width=1.5, height=1.0)
    assert housner_restitution(block.alpha) < 0
    assert block.restitution == 0


@pytest.mark.parametrize("value", [0, -1, math.inf, math.nan, "wide", None])
@pytest.mark.parametrize("name", ["width", "height", "gravity"])
def test_bad_block(name, value):
    with pytest.raises(ValueError, match=f"{name} is .*; it must be"):
        RigidBlock(**{"width": 1.0, "height": 2.0, name: value})


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"width": 5e-324}, "width is 5e-324; it must be from 1e-150 to 1e\\+150"),
        ({"height": 1e308}, r"height is 1e\+308"),
        ({"gravity": 1e-310}, "gravity is 1e-310"),
        ({"width": 1e-100, "height": 1e60}, r"width is 1e-100 and height 1e\+60; alpha"),
        ({"width": 1e60, "height": 1e-100}, r"width is 1e\+60 and height 1e-100; alpha"),
    ],
)
def test_a_block_whose_alpha_or_p_floating_point_does_not_hold(change, named):
    with pytest.raises(ValueError, match=named):
        RigidBlock(**({"width": 0.5, "height": 1.5} | change))


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"omega": 1e-308}, "omega is 1e-308; it must be from 1e-150"),
        ({"omega": 1e200}, r"omega is 1e\+200"),
        ({"amplitude": 1e200, "omega": 1e-100}, r"amplitude is 1e\+200 and omega 1e-100; the disp"),
        ({"half_cycles": 10**400}, "half_cycles is 1000"),
        (
            {"half_cycles": 10**16},
            r"half_cycles is 1\d*; it must be a whole number from 1 to 1e\+15",
        ),
    ],
)
def test_a_pulse_whose_length_or_displacement_floating_point_does_not_hold(change, named):
    with pytest.raises(ValueError, match=named):
        SinePulse(**({"amplitude": 4.0, "omega": 6.0} | change))


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


@pytest.mark.parametrize("value", [-0.1, 1.1, math.inf])
def test_bad_restitution(value):
    with pytest.raises(ValueError, match="restitution is"):
        RigidBlock(width=1, height=2, restitution=value)


@pytest.mark.parametrize(
    ("name", "value"),
    [
        ("amplitude", math.nan),
        ("omega", 0),
        ("omega", -2),
        ("half_cycles", 0),
        ("phase", math.inf),
        ("half_cycles", 1.5),
    ],
)
def test_bad_pulse(name, value):
    with pytest.raises(ValueError, match=f"{name} is"):
        SinePulse(**{"amplitude": 1.0, "omega": 2.0, "half_cycles": 1, name: value})


@pytest.mark.parametrize("phase", [0.0, 0.5 * math.pi, -1.0, 4.0])
@pytest.mark.parametrize("half_cycles", [1, 2, 3, 6])
def test_velocity_and_displacement_integrate_the_acceleration(half_cycles, phase):
    pulse = SinePulse(amplitude=-3.0, omega=5.0, half_cycles=half_cycles, phase=phase)
    for t in np.linspace(0, 1.5 * pulse.duration, 7)[1:]:
        split = [pulse.duration] if pulse.duration < t else None
        velocity, _ = quad(pulse.acceleration, 0, t, points=split, limit=200, epsabs=1e-13)
        displacement, _ = quad(pulse.velocity, 0, t, points=split, limit=200, epsabs=1e-13)
        assert pulse.velocity(t) == pytest.approx(velocity, abs=1e-12)
        assert pulse.displacement(t) == pytest.approx(displacement, abs=1e-12)


def test_velocity_keeps_its_digits_early_in_the_pulse():
    pulse = SinePulse(amplitude=1.0, omega=1.0)
    assert float(pulse.velocity(1e-7)) == pytest.approx(0.5e-14, rel=1e-12)
    cosine = SinePulse(amplitude=1.0, omega=1.0, phase=0.5 * math.pi)
    assert float(cosine.velocity(1e-7)) == pytest.approx(1e-7, rel=1e-12)
    assert float(cosine.displacement(1e-7)) == pytest.approx(0.5e-14, rel=1e-6)


def test_still_ground_does_not_move():
    still = Still()
    for moved in (still.acceleration, still.velocity, still.displacement):
        assert np.array_equal(moved([-1.0, 0.0, 2.0]), np.zeros(3))
    assert still.duration == 0.0
    assert still == Still()


def test_impact_ratio_and_failure():
    assert Impact(1.0, -2.0, -1.7).ratio == pytest.approx(0.85)
    failed = Response.failure("diverged", steps=3)
    assert failed.outcome is Outcome.FAILED
    assert math.isnan(failed.peak_ratio)
    assert failed.message == "diverged"
