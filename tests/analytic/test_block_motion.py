"""The block and the base motions."""

import math

import numpy as np
import pytest
from scipy.integrate import quad

from analytic import Impact, Outcome, Response, RigidBlock, SinePulse, housner_restitution


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
        ("half_cycles", 1.5),
    ],
)
def test_bad_pulse(name, value):
    with pytest.raises(ValueError, match=f"{name} is"):
        SinePulse(**{"amplitude": 1.0, "omega": 2.0, "half_cycles": 1, name: value})


@pytest.mark.parametrize("half_cycles", [1, 2, 3, 6])
def test_velocity_and_displacement_integrate_the_acceleration(half_cycles):
    pulse = SinePulse(amplitude=-3.0, omega=5.0, half_cycles=half_cycles)
    for t in np.linspace(0, 1.5 * pulse.duration, 7)[1:]:
        split = [pulse.duration] if pulse.duration < t else None
        velocity, _ = quad(pulse.acceleration, 0, t, points=split, limit=200, epsabs=1e-13)
        displacement, _ = quad(pulse.velocity, 0, t, points=split, limit=200, epsabs=1e-13)
        assert pulse.velocity(t) == pytest.approx(velocity, abs=1e-12)
        assert pulse.displacement(t) == pytest.approx(displacement, abs=1e-12)


def test_velocity_keeps_its_digits_early_in_the_pulse():
    pulse = SinePulse(amplitude=1.0, omega=1.0)
    assert float(pulse.velocity(1e-7)) == pytest.approx(0.5e-14, rel=1e-12)


def test_impact_ratio_and_failure():
    assert Impact(1.0, -2.0, -1.7).ratio == pytest.approx(0.85)
    failed = Response.failure("diverged", steps=3)
    assert failed.outcome is Outcome.FAILED
    assert math.isnan(failed.peak_ratio)
    assert failed.message == "diverged"
