"""Modes of overturning by the million: against `simulate`, the criteria, and what must hold."""

import math

import numpy as np
import pytest
from closed_forms import overturning_amplitude, overturning_velocity
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from analytic import MODELS, Outcome, RigidBlock, SinePulse, peak_ratios, simulate
from analytic.maps import FAILED, NOT_LIFTED, SURVIVES, overturning_modes

LINEAR = [name for name, model in MODELS.items() if model.linear]


def onset_of(model, alpha):
    return float(MODELS[model].onset(np.array(alpha)))


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("half_cycles", [1, 3, 12, 31, 200])
def test_outcomes_are_those_of_the_peaks(model, half_cycles):
    """floor(k pi/pi) is k - 1 for k = 11, 15, 22, 30, …: half cycles are counted, not computed."""
    draw = np.random.default_rng(half_cycles)
    count = 2000 if half_cycles < 10 else 200
    alpha = draw.uniform(0.03, 1.2, count)
    amplitude = np.tan(alpha) * np.exp(draw.uniform(-0.2, 2.5, count)) * draw.choice([-1, 1], count)
    omega = np.exp(draw.uniform(math.log(0.05), math.log(20.0), count))
    restitution = np.where(draw.random(count) < 0.5, draw.uniform(0.0, 1.0, count), 0.8)
    found = overturning_modes(alpha, amplitude, omega, half_cycles, model, restitution)
    near = amplitude * (1.0 + 4e-16 * np.arange(-4, 5)[:, None])
    outcomes = peak_ratios(alpha, near, omega, half_cycles, model, restitution)[1]
    # of a hundred impacts each may double an error: then rounding decides
    decided = (outcomes == outcomes[4]).all(axis=0)
    assert decided.mean() > (0.95 if half_cycles == 200 else 0.999)
    expected = {SURVIVES: Outcome.ROCKED, NOT_LIFTED: Outcome.AT_REST, FAILED: Outcome.FAILED}
    named = [expected.get(int(mode), Outcome.OVERTURNED) for mode in found.mode]
    assert np.flatnonzero((np.array(named) != outcomes[4]) & decided).tolist() == []
    assert set(named) == {Outcome.ROCKED, Outcome.AT_REST, Outcome.OVERTURNED}


@pytest.mark.parametrize("amplitude", [1e78, 5e163])
def test_what_no_number_tells_of_has_failed(amplitude):
    """The margin of this case is nan; its mode said that it survives."""
    found = overturning_modes(0.76, amplitude, 0.12, 1)
    assert (int(found.mode), peak_ratios(0.76, amplitude, 0.12, 1)[1]) == (FAILED, Outcome.FAILED)


@settings(max_examples=150, deadline=None)
@given(
    alpha=st.floats(0.05, 0.8),
    excess=st.floats(1.05, 9.0),
    sign=st.sampled_from([1.0, -1.0]),
    omega=st.floats(0.2, 9.0),
    half_cycles=st.integers(1, 5),
    model=st.sampled_from(list(MODELS)),
)
def test_the_mode_is_the_number_of_impacts_of_the_fall(
    alpha, excess, sign, omega, half_cycles, model
):
    block = RigidBlock(width=1.0, height=1.0 / math.tan(alpha))
    amplitude = sign * excess * onset_of(model, alpha)
    pulse = SinePulse(
        amplitude=amplitude * block.gravity, omega=omega * block.p, half_cycles=half_cycles
    )
    found = overturning_modes(alpha, amplitude, omega, half_cycles, model)
    assume(abs(found.margin) >= 1e-9)
    # followed until the block lies on its side, the march meets every impact before
    fall = simulate(block, pulse, model, duration=pulse.duration + 40.0 / block.p)
    if fall.outcome is Outcome.OVERTURNED:
        assert found.mode == len(fall.impacts)
    else:
        assert found.mode == SURVIVES


def test_impacts_beyond_sixteen_bits_are_counted():
    """A pulse hardly above the onset sets an elastic block rattling, and throws it much later."""
    block, omega = RigidBlock(width=1.0, height=4.0, restitution=1.0), 0.01
    amplitude = (1.0 + 2e-5) * onset_of("housner", block.alpha)
    found = overturning_modes(block.alpha, amplitude, omega, 2, "housner", 1.0)
    pulse = SinePulse(amplitude=amplitude * block.gravity, omega=omega * block.p, half_cycles=2)
    fall = simulate(block, pulse, "housner")
    assert fall.outcome is Outcome.OVERTURNED
    assert found.mode == len(fall.impacts) > 2**16
    assert found.steps > found.mode


@pytest.mark.parametrize("omega_over_p", [0.5, 1.0, 2.0, 4.0, 8.0])
@pytest.mark.parametrize("model", LINEAR)
@pytest.mark.parametrize("half_cycles", [1, 2])
def test_overturning_without_impact_begins_where_the_criterion_says(
    model, omega_over_p, half_cycles
):
    alpha = 0.35
    law = MODELS[model].law(alpha, 0.9)
    threshold = law.onset * overturning_amplitude(omega_over_p / law.k, half_cycles)
    sides = threshold * np.array([1.0 - 1e-11, 1.0 + 1e-11])
    below, above = overturning_modes(alpha, sides, omega_over_p, half_cycles, model).mode
    assert below != 0
    assert above == 0
    # to a part 1e-12 by the other kernel; without a rebound no later fall is left
    sides = threshold * np.array([1.0 - 1e-12, 1.0 + 1e-12])
    peaks, _ = peak_ratios(alpha, sides, omega_over_p, half_cycles, model, restitution=0.0)
    if half_cycles == 1 or omega_over_p >= 1.0:
        assert np.isinf(peaks).tolist() == [False, True]


@pytest.mark.parametrize(("omega_over_p", "excess"), [(1.0, 0.0649), (2.0, 0.195), (8.0, 0.406)])
def test_housners_own_formula_lies_above_the_threshold(omega_over_p, excess):
    """Housner (1963): sqrt(1 + (ω/p)²), which drops the exponential and so is not safe."""
    formula = 0.1 * math.hypot(1.0, omega_over_p)
    found = overturning_modes(0.1, np.linspace(0.1, formula, 20_001), omega_over_p, 1, "housner")
    least = 0.1 + np.argmax(found.mode >= 0) / 20_000 * (formula - 0.1)
    assert 1.0 - least / formula == pytest.approx(excess, abs=1e-3)


def test_a_short_pulse_overturns_by_its_velocity():
    """One step in velocity, 4 R p sqrt(2 (1 - cos α)) / (3 cos α)."""
    block, short = RigidBlock(width=0.5, height=2.0), 1e5
    velocity = overturning_velocity(block) * np.array([1.0 - 3e-5, 1.0 + 3e-5])
    amplitude = 0.5 * velocity * short * block.p / block.gravity
    assert overturning_modes(block.alpha, amplitude, short, 1).mode.tolist() == [SURVIVES, 0]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("half_cycles", [1, 2, 3])
def test_margin_is_continuous_through_changes_of_the_impact_count(model, half_cycles):
    alpha, omega = 0.25, 2.0
    onset = onset_of(model, alpha)

    def margins(amplitudes):
        found = overturning_modes(alpha, onset * amplitudes, omega, half_cycles, model)
        assert np.array_equal(found.mode >= 0, found.margin > 0.0)
        return np.minimum(found.margin, 0.3)

    amplitudes = np.linspace(1.0, 7.0, 2001)
    steps = np.abs(np.diff(margins(amplitudes)))
    # the steepest places are steep, like a root at a grazing impact, but no jumps
    for place in np.argsort(steps)[-3:]:
        low, high = amplitudes[place], amplitudes[place + 1]
        for _ in range(36):
            points = np.array([low, 0.5 * (low + high), high])
            first, second = np.abs(np.diff(margins(points)))
            low, high = (points[0], points[1]) if first > second else (points[1], points[2])
        assert abs(np.diff(margins(np.array([low, high])))[0]) < 2e-3


def test_threads_and_chunks_change_no_bit():
    alpha = np.linspace(0.1, 0.6, 40)[:, None]
    amplitude = np.tan(alpha) * np.linspace(1.0, 6.0, 1000)
    peaks, again = (peak_ratios(alpha, it, 2.5, 2)[0] for it in (amplitude, amplitude[:, ::-1]))
    assert np.array_equal(peaks, again[:, ::-1])
    one = overturning_modes(alpha, amplitude, 2.5, 2, threads=1)
    two = overturning_modes(alpha, amplitude, 2.5, 2, threads=2)
    parts = [overturning_modes(alpha[i], amplitude[i], 2.5, 2) for i in range(40)]
    for name in ("mode", "margin", "steps"):
        assert getattr(one, name).tobytes() == getattr(two, name).tobytes()
        assert getattr(one, name).tobytes() == b"".join(getattr(p, name).tobytes() for p in parts)
