"""Condition numbers: carried along with the solution, held against differences of peaks."""

import numpy as np
import pytest

from analytic import MODELS, Outcome, RigidBlock, SinePulse, peak_ratios, simulate
from analytic.block import housner_restitution
from analytic.conditioning import condition_numbers, conditioning
from studies.cases.paper import sweep_cases

CASES = np.array(
    [
        (case.block.alpha, case.amplitude_g, case.omega_over_p, case.motion.half_cycles)
        for case in sweep_cases([6, 7, 8, 9])
        if case.width_m == 0.5
    ]
).T
RESTITUTION = np.vectorize(housner_restitution)(CASES[0])


def difference(function, nudge):
    """The derivative at 1 to fourth order."""
    near = function(1.0 + nudge) - function(1.0 - nudge)
    far = function(1.0 + 2.0 * nudge) - function(1.0 - 2.0 * nudge)
    return (8.0 * near - far) / (12.0 * nudge)


@pytest.mark.parametrize("model", MODELS)
def test_they_are_the_slopes_of_the_peaks(model):
    alpha, amplitude, omega, half_cycles = CASES

    def by_amplitude(scale):
        return np.log(
            peak_ratios(alpha, scale * amplitude, omega, half_cycles, model, RESTITUTION)[0]
        )

    def by_restitution(scale):
        return np.log(
            peak_ratios(alpha, amplitude, omega, half_cycles, model, scale * RESTITUTION)[0]
        )

    found = condition_numbers(*CASES, model=model)
    with np.errstate(invalid="ignore"):
        for numbers, function in (
            (found.amplitude, by_amplitude),
            (found.restitution, by_restitution),
        ):
            slopes = difference(function, 1e-5)
            usable = np.isfinite(slopes)
            error = np.abs(numbers - slopes)[usable] / np.maximum(1.0, np.abs(slopes[usable]))
            assert np.median(error) < 1e-9
            assert np.quantile(error, 0.95) < 1e-7
            # near overturning the peak curves within the difference
            assert error[np.abs(slopes[usable]) < 50.0].max() < 1e-5


@pytest.mark.parametrize("model", MODELS)
def test_they_are_nan_where_no_peak_survives(model):
    _, outcome = peak_ratios(*CASES, model=model)
    found = condition_numbers(*CASES, model=model)
    for numbers in found:
        assert np.array_equal(np.isfinite(numbers), outcome == Outcome.ROCKED)


def test_a_peak_before_any_impact_does_not_feel_the_restitution():
    half_sine = CASES[3] == 1
    found = condition_numbers(*CASES).restitution[half_sine]
    assert np.all(found[np.isfinite(found)] == 0.0)


def test_one_response_is_conditioned_as_in_the_array():
    block = RigidBlock(width=0.5, height=1.5)
    pulse = SinePulse(amplitude=0.4 * 9.81, omega=4.0 * block.p, half_cycles=4)
    response = simulate(block, pulse)
    assert len(response.impacts) >= 2
    one = conditioning(block, pulse)
    assert all(map(np.isfinite, one))
    many = condition_numbers(block.alpha, 0.4, 4.0, 4)
    assert one == pytest.approx([float(numbers) for numbers in many], rel=1e-10)
