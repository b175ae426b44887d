"""How errors move a peak: condition numbers, and sensitivities to small but finite errors."""

import math
from dataclasses import replace
from itertools import product

import numpy as np
import pytest
from given import BLOCK, pulse
from independent import peak_and_impacts

from analytic import MODELS, Outcome, RigidBlock, SinePulse, Still, peak_ratios, simulate
from analytic.block import housner_restitution
from analytic.conditioning import NUDGE, condition_numbers, conditioning, sensitivities, sensitivity
from studies.cases.paper import sweep_cases

NEAR_ONSET = RigidBlock(width=1.5256313519414122, height=9.174363250019729)
CASES = np.array(
    [
        (case.block.alpha, case.amplitude_g, case.omega_over_p, case.motion.half_cycles)
        for case in sweep_cases([6, 7, 8, 9])
        if case.width_m == 0.5
    ]
).T
RESTITUTION = np.vectorize(housner_restitution)(CASES[0])


MOVED = ("by", "eta")
"""What changes: the amplitude and the restitution by a part."""


def difference(function, nudge):
    """The derivative at 1 to fourth order."""
    near = function(1.0 + nudge) - function(1.0 - nudge)
    far = function(1.0 + 2.0 * nudge) - function(1.0 - 2.0 * nudge)
    return (8.0 * near - far) / (12.0 * nudge)


@pytest.mark.parametrize("model", MODELS)
def test_they_are_the_slopes_of_the_peaks(model):
    alpha, amplitude, omega, half_cycles = CASES

    def peaks(by=1.0, eta=1.0):
        cases = (alpha, by * amplitude, omega, half_cycles, model, eta * RESTITUTION)
        return np.log(peak_ratios(*cases)[0])

    found, (_, outcome) = condition_numbers(*CASES, model=model), peak_ratios(*CASES, model=model)
    assert all(np.array_equal(np.isfinite(it), outcome == Outcome.ROCKED) for it in found)
    # no impact comes before the peak of a half sine
    before = found.restitution[(half_cycles == 1) & (outcome == Outcome.ROCKED)]
    assert before.size and not before.any()
    with np.errstate(invalid="ignore"):
        for numbers, moved in zip(found, MOVED, strict=True):
            slopes = difference(lambda scale, moved=moved: peaks(**{moved: scale}), 1e-5)
            usable = np.isfinite(slopes)
            error = np.abs(numbers - slopes)[usable] / np.maximum(1.0, np.abs(slopes[usable]))
            assert np.median(error) < 1e-9
            assert np.quantile(error, 0.95) < 1e-7
            # near overturning the peak curves within the difference
            assert error[np.abs(slopes[usable]) < 50.0].max() < 1e-5


@pytest.mark.parametrize("start", [(0.0, 0.0), (0.1, -0.2), (0.0, 0.3)])
@pytest.mark.parametrize("model", MODELS)
def test_they_are_the_slopes_of_a_peak_after_any_start(model, start):
    for phase in (0.4, 1.57, 3.0, 4.5):
        motion = SinePulse(amplitude=3.6, omega=12.0, half_cycles=4, phase=phase)

        def peak(by=1.0, eta=1.0, motion=motion):
            block = replace(BLOCK, restitution=eta * BLOCK.restitution)
            shaken = replace(motion, amplitude=by * motion.amplitude)
            return math.log(simulate(block, shaken, model, start).peak_ratio)

        for number, moved in zip(conditioning(BLOCK, motion, model, start), MOVED, strict=True):
            nudge = 1e-5 / math.sqrt(1.0 + abs(number))
            slope = difference(lambda scale, moved=moved: peak(**{moved: scale}), nudge)
            # against a difference of fourth order: ours errs by (kappa nudge)^2 and rounding
            curved = 50.0 * (number * NUDGE) ** 2
            assert number == pytest.approx(slope, rel=1e-6 + curved, abs=1e-9)


def near_onset(scale=1.0):
    return SinePulse.in_g(scale * 0.17396032278997067, omega=2.10102467443576, half_cycles=2)


@pytest.mark.parametrize(("whole", "move", "rise"), [(1.0, 1e-4, 0.68), (1.0003, 1e-3, 2.35)])
def test_near_onset_it_sees_what_the_derivative_does_not(whole, move, rise):
    """An uplift that comes at 0.9999 of the amplitude: against a general integrator."""
    kappa = max(map(abs, conditioning(NEAR_ONSET, near_onset(whole))))
    assert kappa < 100.0
    still, weaker = (
        peak_and_impacts("exact", NEAR_ONSET, near_onset(scale), most=30)[0]
        for scale in (whole, whole * (1.0 - move))
    )
    assert weaker / still - 1.0 == pytest.approx(rise, abs=0.01)
    found = sensitivity(NEAR_ONSET, near_onset(whole))
    assert found == pytest.approx((weaker / still - 1.0) / move, rel=1e-3)
    assert found > 5e-3 * kappa / move


def test_where_the_peak_is_smooth_it_is_the_condition_number():
    kappa = np.fmax(*map(np.abs, condition_numbers(*CASES)))
    found = sensitivities(*CASES)
    calm = kappa < 10.0
    assert calm.sum() > 90
    # over a move of 1e-3 a peak bends by about kappa times that
    assert np.median(np.abs(found[calm] / kappa[calm] - 1.0) / kappa[calm]) < 1e-3
    assert np.all(found[calm] > 0.99 * kappa[calm])


@pytest.mark.parametrize("onsets", [1.0 + 0.9e-4, 1.0 - 0.9e-4, 1.0 + 0.9e-6, 0.9, 15.0])
def test_an_outcome_that_changes_is_without_bound_and_one_that_stays_not_sensitive(onsets):
    found = sensitivity(BLOCK, pulse(onsets, 4.0))
    assert found == (math.inf if abs(onsets - 1.0) < 1e-4 else 0.0)


def test_of_a_block_that_is_pushed_onto_its_base_it_is_that_of_the_energy():
    """Of the impact no more than eta is left, and the peak follows from the energy after it."""
    tilt, rate = 0.02, 0.6 * BLOCK.p * BLOCK.alpha

    def work(theta):
        return math.cos(BLOCK.alpha - theta) - math.cos(BLOCK.alpha)

    energy = 0.5 * (rate / BLOCK.p) ** 2 + work(tilt)

    def peak(scale):
        left = (scale * BLOCK.restitution) ** 2 * energy
        return BLOCK.alpha - math.acos(left + math.cos(BLOCK.alpha))

    moves = (1e-3, -1e-3, 1e-4, -1e-4, 1e-6, -1e-6)
    wanted = max(abs(peak(1.0 + move) / peak(1.0) - 1.0) / abs(move) for move in moves)
    assert sensitivity(BLOCK, Still(), start=(tilt, -rate)) == pytest.approx(wanted, rel=1e-7)
    # tilted further than that, the block is highest where it starts
    assert sensitivity(BLOCK, Still(), start=(0.9 * BLOCK.alpha, 0.0)) == 0.0


@pytest.mark.parametrize("model", MODELS)
def test_arrays_and_single_responses_agree(model):
    """A row of blocks for each slenderness; in the last the block is struck during its pulse."""
    alpha = np.arctan([[1 / 2], [1 / 3], [1 / 4]])
    omega, half_cycles = np.array([0.5, 2.0, 3.5, 4.0]), np.array([2, 2, 2, 4])
    cases = (alpha, np.tan(alpha) + 0.1, omega, half_cycles, model)
    (peaks, outcomes), numbers = peak_ratios(*cases), condition_numbers(*cases)
    moved = sensitivities(*cases)
    assert peaks.shape == outcomes.shape == moved.shape == (3, 4)
    for at in product(range(3), range(4)):
        block = RigidBlock(width=1.0, height=1.0 / math.tan(alpha[at[0], 0]))
        omega_s, count = omega[at[1]] * block.p, int(half_cycles[at[1]])
        motion = SinePulse.in_g(math.tan(block.alpha) + 0.1, omega=omega_s, half_cycles=count)
        response = simulate(block, motion, model)
        assert response.outcome is outcomes[at]
        assert response.peak_ratio == pytest.approx(peaks[at], rel=1e-9)
        one = [float(number[at]) for number in numbers]
        assert conditioning(block, motion, model) == pytest.approx(one, rel=1e-8, nan_ok=True)
        assert sensitivity(block, motion, model) == pytest.approx(moved[at], rel=1e-5)
