"""The exact model: against 30 digits, against SciPy, and against what must hold."""

import csv
import itertools
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from independent import peak_and_impacts

from analytic import MODELS, Outcome, RigidBlock, SinePulse, integrate, peak_ratios, simulate
from analytic.criteria import free_amplitude, overturning_velocity, quarter_period

G = 9.81
TABLE_FILE = Path(__file__).parent / "reference" / "exact.csv"
TABLE = list(csv.DictReader(TABLE_FILE.read_text().splitlines()))


def papers_case(width, height, amplitude_g, half_cycles):
    block = RigidBlock(width=width, height=height)
    return block, SinePulse(amplitude=amplitude_g * G, omega=2 * math.pi, half_cycles=half_cycles)


@pytest.mark.parametrize("row", TABLE, ids=lambda row: f"{row['height']}-{row['half_cycles']}")
def test_against_thirty_digits(row):
    block = RigidBlock(width=float(row["width"]), height=float(row["height"]))
    pulse = SinePulse(
        amplitude=float(row["amplitude"]),
        omega=float(row["omega"]),
        half_cycles=int(row["half_cycles"]),
    )
    response = simulate(block, pulse)
    expected = float(row["peak_ratio"])
    if math.isinf(expected):
        assert response.peak_ratio == math.inf
    else:
        assert response.peak_ratio == pytest.approx(expected, rel=1e-12)
    times = [float(t) for t in row["impact_times"].split()]
    during = [i.time for i in response.impacts if i.time < pulse.duration]
    assert during == pytest.approx(times, rel=1e-12)


# the values read off the paper's Figs 4 and 5 are given to four digits in the literature table
@pytest.mark.parametrize(
    ("width", "height", "amplitude_g", "half_cycles", "expected"),
    [
        (0.5, 3.0, 0.2, 1, (0.0197, 0.0219, 0.0197)),
        (0.5, 1.5, 0.4, 1, (0.0391, 0.0578, 0.0388)),
        (0.5, 1.0, 0.7, 1, (0.2249, 0.3824, 0.2138)),
        (0.5, 3.0, 0.2, 2, (0.1750, 0.2119, 0.1737)),
        (0.5, 1.5, 0.4, 2, (0.3852, math.inf, 0.3605)),
        (0.5, 1.0, 0.6, 2, (0.5558, math.inf, 0.4446)),
    ],
)
def test_the_papers_histories(width, height, amplitude_g, half_cycles, expected):
    case = papers_case(width, height, amplitude_g, half_cycles)
    for model, peak in zip(("exact", "housner", "modified"), expected, strict=True):
        assert simulate(*case, model).peak_ratio == pytest.approx(peak, abs=5.1e-5)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(12))
def test_every_model_against_scipy(model, seed):
    draw = np.random.default_rng(seed)
    block = RigidBlock(width=draw.uniform(0.1, 2), height=draw.uniform(2.2, 10))
    amplitude = G * math.tan(block.alpha) * draw.uniform(1.02, 2) * draw.choice([-1, 1])
    omega = block.p * draw.uniform(1, 6)
    pulse = SinePulse(amplitude=amplitude, omega=omega, half_cycles=int(draw.integers(1, 4)))
    peak, impacts = peak_and_impacts(model, block, pulse)
    response = simulate(block, pulse, model, duration=pulse.duration + 15.0 / block.p)
    # DOP853 at rtol 1e-12 with a dense output of order 7 for the events
    if peak is not None:
        assert response.peak_ratio == pytest.approx(peak, rel=2e-9)
    times = [i.time for i in response.impacts][: len(impacts)]
    assert times == pytest.approx(impacts, rel=2e-9)


@settings(max_examples=60, deadline=None)
@given(
    alpha=st.floats(0.03, 0.8),
    excess=st.floats(1.001, 4),
    omega=st.floats(0.1, 12),
    half_cycles=st.integers(1, 5),
    model=st.sampled_from(list(MODELS)),
)
def test_mirror_and_similarity(alpha, excess, omega, half_cycles, model):
    peaks = []
    for width, sign in ((0.01, 1), (0.64, 1), (0.64, -1)):
        block = RigidBlock(width=width, height=width / math.tan(alpha))
        amplitude = sign * excess * math.tan(alpha) * G
        pulse = SinePulse(amplitude=amplitude, omega=omega * block.p, half_cycles=half_cycles)
        peaks.append(simulate(block, pulse, model).peak_ratio)
    small, large, mirrored = peaks
    assert mirrored == large
    if math.isfinite(large) and large < 0.9:
        assert small == pytest.approx(large, rel=1e-9)


@settings(max_examples=100, deadline=None)
@given(
    alpha=st.floats(0.02, 1.2),
    below=st.floats(0, 1 - 1e-12),
    omega=st.floats(0.01, 100),
    model=st.sampled_from(list(MODELS)),
)
def test_at_rest_up_to_the_onset_and_not_beyond(alpha, below, omega, model):
    onset = float(MODELS[model].onset(np.array(alpha)))
    peaks, outcomes = peak_ratios(alpha, [below * onset, onset * (1 + 1e-9)], omega, 2, model)
    assert outcomes[0] is Outcome.AT_REST
    assert peaks[0] == 0
    assert outcomes[1] is not Outcome.AT_REST
    assert peaks[1] > 0


def test_free_rocking_period_and_decay():
    block = RigidBlock(width=0.5, height=1.5)
    pulse = SinePulse(amplitude=5.0, omega=8.0, half_cycles=1)
    response = simulate(block, pulse, duration=20.0)
    free = [i for i in response.impacts if i.time > pulse.duration]
    assert len(free) > 20
    lift = 0.5 * (free[0].velocity_after / block.p) ** 2
    barrier = 1 - math.cos(block.alpha)
    start = block.alpha - 2 * math.asin(math.sqrt((barrier - lift) / 2))
    # later, small rotations lose digits in the closed form: its asin is close to 1
    for n, (impact, following) in enumerate(itertools.pairwise(free[:15])):
        period = 2 * quarter_period(block, free_amplitude(block, start, n))
        assert following.time - impact.time == pytest.approx(period, abs=1e-11)
        assert impact.ratio == pytest.approx(block.restitution, rel=1e-14)


@pytest.mark.parametrize("height", [0.75, 1.5, 6.0])
def test_rest_time_is_the_sum_of_all_excursions(height):
    block = RigidBlock(width=0.5, height=height)
    pulse = SinePulse(amplitude=1.2 * G * 0.5 / height, omega=3 * block.p)
    response = simulate(block, pulse, duration=200.0)
    last, rest = response.impacts[-1], response.rests[0]
    velocity, time = abs(last.velocity_after) / block.p, last.time
    for _ in range(int(40 / (1 - block.restitution))):
        # free excursion from its series: 2 v/sin(alpha) (1 + v^2/(3 sin alpha tan alpha) + ...)
        stretch = 1 + velocity**2 / (3 * math.sin(block.alpha) * math.tan(block.alpha))
        time += 2 * velocity / math.sin(block.alpha) * stretch / block.p
        velocity *= block.restitution
    assert len(response.rests) == 1
    assert rest == pytest.approx(time, abs=1e-7 / block.p)
    assert len(response.impacts) < 20 / (1 - block.restitution)


def test_rest_and_uplift_again_in_both_directions():
    # a squat block loses all but a little at an impact, so it rests within each half cycle
    block = RigidBlock(width=1.0, height=1.05)
    amplitude = 1.01 * G * math.tan(block.alpha)
    omega = 0.9 * block.p
    response = simulate(block, SinePulse(amplitude=amplitude, omega=omega, half_cycles=5))
    assert len(response.uplifts) == 5
    assert len(response.rests) >= 4
    history = simulate(
        block,
        SinePulse(amplitude=amplitude, omega=omega, half_cycles=5),
        times=np.linspace(0, 5 * math.pi / omega, 4001),
    ).history
    sides = {
        math.copysign(1, history.theta[np.searchsorted(history.time, t + 0.02)])
        for t in response.uplifts
    }
    assert sides == {-1.0, 1.0}
    # every half cycle is the mirror of the one before: the rest has forgotten the past
    half = math.pi / omega
    assert np.diff(response.uplifts) == pytest.approx(half, rel=1e-12)


def test_no_restitution_rests_at_once_and_is_lifted_at_once():
    block = RigidBlock(width=1.5, height=1.0)
    assert block.restitution == 0
    pulse = SinePulse(amplitude=1.05 * 1.5 * G, omega=3 * block.p, half_cycles=2)
    response = simulate(block, pulse)
    assert response.impacts[0].velocity_after == 0
    assert len(response.uplifts) == 2
    assert response.outcome is Outcome.ROCKED


def test_a_velocity_step_overturns_from_its_closed_form_on():
    block = RigidBlock(width=0.5, height=1.5)
    velocity = overturning_velocity(block)
    omega = 1e5 * block.p
    for factor, overturned in ((1 + 1e-4, True), (1 - 1e-4, False)):
        # during so short a pulse the block turns by 1e-5 at most
        amplitude = factor * velocity * omega / 2
        outcome = simulate(block, SinePulse(amplitude=amplitude, omega=omega)).outcome
        assert (outcome is Outcome.OVERTURNED) == overturned


def test_beyond_the_critical_rotation_and_back():
    alpha = math.atan(1 / 3)
    amplitudes = np.linspace(0.4, 3.0, 4000)
    peaks, _ = peak_ratios(alpha, amplitudes, 5.0, 2)
    survivors = peaks[np.isfinite(peaks) & (peaks > 1)]
    assert survivors.size > 0, "no block crosses theta_cr and survives"
    block = RigidBlock(width=0.5, height=1.5)
    crossing = amplitudes[np.isfinite(peaks) & (peaks > 1)][0]
    pulse = SinePulse(amplitude=crossing * G, omega=5 * block.p, half_cycles=2)
    response = simulate(block, pulse)
    assert response.crossed
    assert response.outcome is Outcome.ROCKED


def test_contact_forces_follow_from_the_path():
    """Both extremes fall into the first swing, where second differences of the path tell them."""
    block = RigidBlock(width=0.5, height=1.0)
    amplitude = 2.2 * G * math.tan(block.alpha)
    pulse = SinePulse(amplitude=amplitude, omega=6.0 * block.p, half_cycles=2)
    response = simulate(block, pulse, duration=20.0)
    times = np.linspace(response.uplifts[0], response.impacts[0].time, 3001)
    theta = simulate(block, pulse, times=times, duration=20.0).history.theta
    z, side = block.alpha - np.abs(theta), np.sign(theta[1500])
    x = pulse.displacement(times) + side * block.R * (np.sin(block.alpha) - np.sin(z))
    up = block.R * np.cos(z)
    step = times[1] - times[0]
    horizontal = np.diff(x, 2) / step**2 / G
    normal = 1 + np.diff(up, 2) / step**2 / G
    assert 0 < normal.argmin() < normal.size - 1
    # a twelfth of (omega step)^2, 1e-6
    assert response.min_normal == pytest.approx(normal.min(), abs=1e-6)
    assert response.friction_needed == pytest.approx((np.abs(horizontal) / normal).max(), abs=1e-6)


def test_a_block_at_rest_needs_the_friction_that_carries_it():
    response = simulate(*papers_case(0.5, 1.5, 0.3, 2))
    assert response.outcome is Outcome.AT_REST
    assert response.friction_needed == pytest.approx(0.3, rel=1e-5)
    assert response.min_normal == 1


def test_history_follows_the_response():
    block, pulse = papers_case(0.5, 1.5, 0.4, 2)
    times = np.linspace(0, 3, 3001)
    response = simulate(block, pulse, times=times, duration=3.0)
    theta, velocity = response.history.theta, response.history.velocity
    assert np.abs(theta).max() / block.alpha == pytest.approx(response.peak_ratio, rel=1e-4)
    slope = np.gradient(theta, times)
    near = [np.abs(times - i.time).min() for i in response.impacts]
    smooth = np.all([np.abs(times - i.time) > 2e-3 for i in response.impacts], axis=0)
    assert near
    np.testing.assert_allclose(velocity[smooth], slope[smooth], atol=2e-3)
    assert np.all(theta[times < response.uplifts[0]] == 0)


def test_history_ends_where_the_block_lies_down():
    block = RigidBlock(width=0.5, height=3)
    pulse = SinePulse(amplitude=0.5 * G, omega=2.0, half_cycles=2)
    response = simulate(block, pulse, times=np.linspace(0, 10, 101), duration=10.0)
    assert response.outcome is Outcome.OVERTURNED
    assert response.history.time[-1] < 10
    assert np.all(np.isfinite(response.history.theta))


def test_arrays_and_single_responses_agree():
    alpha = np.arctan([[1 / 2], [1 / 4]])
    omega = np.array([0.5, 2.0, 3.5])
    for model in MODELS:
        peaks, outcomes = peak_ratios(alpha, np.tan(alpha) + 0.1, omega, 2, model)
        assert peaks.shape == outcomes.shape == (2, 3)
        for i, j in np.ndindex(2, 3):
            block = RigidBlock(width=1, height=1 / math.tan(alpha[i, 0]))
            amplitude = (math.tan(alpha[i, 0]) + 0.1) * G
            pulse = SinePulse(amplitude=amplitude, omega=omega[j] * block.p, half_cycles=2)
            response = simulate(block, pulse, model)
            assert response.outcome is outcomes[i, j]
            if math.isfinite(response.peak_ratio):
                assert peaks[i, j] == pytest.approx(response.peak_ratio, rel=1e-9)


def test_many_cases_are_the_same_on_all_cores():
    omega = np.linspace(0.5, 8, 20_000)
    peaks, _ = peak_ratios(0.3, 0.5, omega, 3)
    again, _ = peak_ratios(0.3, 0.5, omega[::-1], 3)
    assert np.array_equal(peaks, again[::-1])


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"alpha": 0.0}, "alpha is 0.0"),
        ({"omega_over_p": [1.0, -2.0]}, "omega_over_p is -2.0"),
        ({"amplitude_g": math.nan}, "amplitude_g is nan"),
        ({"half_cycles": 1.5}, "half_cycles is 1.5"),
        ({"restitution": 1.5}, "restitution is 1.5"),
        ({"model": "linear"}, "model is 'linear'; it must be one of exact, housner"),
    ],
)
def test_bad_arrays(change, words):
    arguments = {"alpha": 0.3, "amplitude_g": 0.4, "omega_over_p": 1.0, "half_cycles": 1}
    with pytest.raises(ValueError, match=words):
        peak_ratios(**(arguments | change))


def test_the_error_follows_the_tolerance():
    case = papers_case(0.5, 1.5, 0.4, 2)
    exact = simulate(*case)
    tolerances = 10.0 ** -np.arange(3, 15)
    errors = []
    for tolerance in tolerances:
        response = simulate(*case, tolerance=tolerance)
        errors.append(abs(response.peak_ratio / exact.peak_ratio - 1))
        # a few steps, each amplified by the growth e^(p t) of the unstable motion
        assert errors[-1] < 10 * tolerance
    assert errors[0] > 1e4 * errors[-1]


@pytest.mark.parametrize("tolerance", [0.0, 1e-17, 0.1, math.nan])
def test_bad_tolerance(tolerance):
    with pytest.raises(ValueError, match="tolerance is"):
        simulate(*papers_case(0.5, 1.5, 0.4, 2), tolerance=tolerance)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("amplitude", "omega"), [(1e300, 6.0), (4.0, 1e-150)])
def test_what_floating_point_cannot_hold_fails_and_says_so(model, amplitude, omega):
    block = RigidBlock(width=0.5, height=1.5)
    motion = SinePulse(amplitude=amplitude, omega=omega, half_cycles=2)
    for response in (simulate(block, motion, model), integrate(block, motion, model)):
        if response.outcome is not Outcome.OVERTURNED:
            assert response.outcome is Outcome.FAILED
            assert "overflows" in response.message
            assert math.isnan(response.peak_ratio)


@pytest.mark.parametrize("amplitude_g", 10.0 ** np.arange(1, 13))
def test_the_most_violent_pulse_overturns(amplitude_g):
    peaks, outcomes = peak_ratios(0.3, amplitude_g, [0.5, 2.0, 8.0], 1)
    assert np.isinf(peaks).all()
    assert all(outcome is Outcome.OVERTURNED for outcome in outcomes)


def test_bad_windows():
    case = papers_case(0.5, 1.5, 0.4, 1)
    with pytest.raises(ValueError, match=r"duration is 0\.1; it must be at least"):
        simulate(*case, duration=0.1)
    with pytest.raises(ValueError, match="increasing"):
        simulate(*case, times=[1.0, 0.5])
