"""The exact model: against 30 digits, against SciPy, and against what must hold."""

import math
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from given import BLOCK, FULL_SINE, G, pulse
from hypothesis import given, settings
from hypothesis import strategies as st

from analytic import MODELS, Outcome, RigidBlock, SinePulse, peak_ratios, simulate
from studies.cases.paper import HISTORIES

REFERENCE = Path(__file__).parent / "reference"


def table(name):
    """Return the rows of a table of 30 digits, made by the script beside it."""
    return pd.read_csv(REFERENCE / name, keep_default_na=False).to_dict("records")


def case_of(row):
    restitution = float(row["restitution"]) if row.get("restitution") else None
    block = RigidBlock(width=row["width"], height=row["height"], restitution=restitution)
    asked = {name: row[name] for name in ("amplitude", "omega", "half_cycles")}
    return block, SinePulse(**asked)


ROWS = [*table("exact.csv"), *table("extreme.csv")]


@pytest.mark.parametrize("row", ROWS, ids=lambda row: str([*row.values()][:5]))
def test_against_thirty_digits(row):
    block, motion = case_of(row)
    response, within = simulate(block, motion), 1e-13 if "case" in row else 1e-12
    # a millionth below overturning the pulse's own rounding, 1e-16, grows ten thousandfold
    within = 1e-11 if "boundary" in row.get("case", "") else within
    # 0 and inf are met as they are
    assert response.peak_ratio == pytest.approx(row["peak_ratio"], rel=within, abs=0.0)
    if "impact_times" in row:
        times = [float(t) for t in row["impact_times"].split()]
        during = [i.time for i in response.impacts if i.time < motion.duration]
        assert during == pytest.approx(times, rel=1e-12)


PAPERS = [
    (0.0197, 0.0219, 0.0197),
    (0.0391, 0.0578, 0.0388),
    (0.2249, 0.3824, 0.2138),
    (0.1750, 0.2119, 0.1737),
    (0.3852, math.inf, 0.3605),
    (0.5558, math.inf, 0.4446),
]
"""Peaks of three models, read off the panels of Figs 4 and 5 to four digits; inf: overturns."""


def test_the_papers_histories():
    for panel, peaks in zip([*HISTORIES[4], *HISTORIES[5]], PAPERS, strict=True):
        for model, peak in zip(("exact", "housner", "modified"), peaks, strict=True):
            found = simulate(panel.block, panel.motion, model).peak_ratio
            assert found == pytest.approx(peak, abs=5.1e-5), (panel, model)


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
        motion = pulse(sign * excess, omega, half_cycles, block)
        peaks.append(simulate(block, motion, model).peak_ratio)
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


@pytest.mark.parametrize("height", [0.75, 1.5, 6.0])
def test_rest_time_is_the_sum_of_all_excursions(height):
    block = RigidBlock(width=0.5, height=height)
    response = simulate(block, pulse(1.2, 3.0, 1, block), duration=200.0)
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
    motion = pulse(1.01, 0.9, 5, block)
    response = simulate(block, motion)
    assert len(response.uplifts) == 5
    assert len(response.rests) >= 4
    assert len({impact.velocity_before > 0.0 for impact in response.impacts}) == 2
    # every half cycle is the mirror of the one before: the rest has forgotten the past
    assert np.diff(response.uplifts) == pytest.approx(math.pi / motion.omega, rel=1e-12)


def test_contact_forces_follow_from_the_path():
    """Both extremes fall into the first swing, where second differences of the path tell them."""
    block = RigidBlock(width=0.5, height=1.0)
    motion = pulse(2.2, 6.0, 2, block)
    response = simulate(block, motion, duration=20.0)
    times = np.linspace(response.uplifts[0], response.impacts[0].time, 3001)
    theta = simulate(block, motion, times=times, duration=20.0).history.theta
    z, side = block.alpha - np.abs(theta), np.sign(theta[1500])
    x = motion.displacement(times) + side * block.R * (np.sin(block.alpha) - np.sin(z))
    up = block.R * np.cos(z)
    step = times[1] - times[0]
    horizontal = np.diff(x, 2) / step**2 / G
    normal = 1 + np.diff(up, 2) / step**2 / G
    assert 0 < normal.argmin() < normal.size - 1
    # a twelfth of (omega step)^2, 1e-6
    assert response.min_normal == pytest.approx(normal.min(), abs=1e-6)
    assert response.friction_needed == pytest.approx((np.abs(horizontal) / normal).max(), abs=1e-6)


def test_the_error_follows_the_tolerance():
    exact = simulate(BLOCK, FULL_SINE)
    tolerances = 10.0 ** -np.arange(3, 15)
    errors = []
    for tolerance in tolerances:
        response = simulate(BLOCK, FULL_SINE, tolerance=tolerance)
        errors.append(abs(response.peak_ratio / exact.peak_ratio - 1))
        # a few steps, each amplified by the growth e^(p t) of the unstable motion
        assert errors[-1] < 10 * tolerance
    assert errors[0] > 1e4 * errors[-1]
