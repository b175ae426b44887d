"""Overturning maps: edges and islands, differences, thresholds, contact forces, the planes."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from commanding import refused

from analytic import peak_ratios, simulate
from analytic.maps import Modes
from studies import overturning
from studies.cases.window import AXES, Window
from studies.kit.run import run
from studies.overturning import Options, edges, planes

SMALL = Options(columns=12, rows=60, low=0.3, high=6.0)
WINDOW = SMALL.window(quick=False)


def known(islands):
    """Return a solver whose blocks overturn on given intervals (low, high, mode)."""

    def solve(column, amplitude):
        mode = np.full(len(amplitude), -1, dtype=np.int32)
        margin = np.full(len(amplitude), -np.inf)
        for low, high, impacts in islands:
            half, middle = 0.5 * (high - low), 0.5 * (high + low)
            margin = np.maximum(margin, half - np.abs(amplitude - middle))
            mode[(amplitude > low) & (amplitude < high)] = impacts
        return Modes(mode, margin, np.ones(len(amplitude), dtype=np.int32))

    return solve


@pytest.mark.parametrize(
    "islands",
    [
        [(2.2, 9.0, 0)],
        # narrower than the grid: overturning in survival, survival in overturning, between modes
        [(2.51234, 2.51235, 3)],
        [(2.0, 4.4444, 1), (4.44441, 9.0, 1)],
        [(2.0, 4.4444, 1), (4.44444, 9.0, 0)],
        [(2.0, 4.44, 5), (4.4401, 4.47, 3), (4.4701, 4.49, 1), (4.4901, 9.0, 0)],
    ],
)
def test_islands_narrower_than_the_grid_are_found(islands):
    found = edges.find_edges(known(islands), 1, np.linspace(1.0, 8.0, 50))
    inside = sorted(end for island in islands for end in island[:2] if end < 8.0)
    assert list(0.5 * (found["low"] + found["high"])) == pytest.approx(inside, abs=edges.WIDTH)
    assert (found["high"] - found["low"] <= edges.WIDTH).all()


def test_modes_without_an_island_between_them_are_an_edge():
    islands = [(2.0, 4.4, 2), (4.4 - 1e-13, 9.0, 0)]
    found = edges.find_edges(known(islands), 1, np.linspace(1.0, 8.0, 50))
    assert list(zip(found["below"], found["above"], strict=True)) == [(-1, 2), (2, 0)]


@pytest.mark.parametrize("over", AXES)
def test_edges_are_those_of_peak_ratios_and_of_cases(over):
    window = Window(over=over, columns=8, rows=80)
    found = overturning.edges_of(window, "exact", window.centres(8))
    apart = np.diff(found["low"], prepend=-1.0, append=99.0)
    wide = (np.minimum(abs(apart[1:]), abs(apart[:-1])) > 1e-8) & (found["low"] > 1.0 + 1e-8)
    x, alpha = found["x"].to_numpy(), window.alpha(found["x"].to_numpy())
    for side, mode, shift in (("low", "below", 1 - 2e-10), ("high", "above", 1 + 2e-10)):
        amplitude = found[side].to_numpy() * shift * np.tan(alpha)
        peaks, _ = peak_ratios(alpha, amplitude, window.ratio(x), 2)
        assert (np.isinf(peaks) == (found[mode] >= 0))[wide].all()
    place = int(np.flatnonzero(wide)[0])
    for shift, mode in ((0.999, "below"), (1.001, "above")):
        case = window.case(float(x[place]), float(found["low"][place]) * shift)
        assert math.isinf(simulate(*case).peak_ratio) == (found[mode][place] >= 0)


def test_strips_change_nothing_and_columns_stand_alone(monkeypatch):
    x = WINDOW.centres(12)
    whole = overturning.edges_of(WINDOW, "housner", x)
    monkeypatch.setattr(overturning, "STRIP", 3 * WINDOW.rows)
    pd.testing.assert_frame_equal(whole, overturning.edges_of(WINDOW, "housner", x))
    alone = overturning.edges_of(WINDOW, "housner", x[[7]])
    pd.testing.assert_frame_equal(alone, whole[whole["x"] == x[7]].reset_index(drop=True))


@pytest.fixture(scope="module")
def tables():
    """Return the tables of a small map of two models."""
    jobs = overturning.jobs(("exact", "housner"), False, SMALL)
    return overturning.tabulate(pd.DataFrame(run(jobs, overturning.measure)))


def test_intervals_and_their_differences_are_those_of_a_fine_grid(tables):
    spans = tables["map"]
    lengths = (spans["high"] - spans["low"]).groupby([spans["model"], spans["x"]]).sum()
    np.testing.assert_allclose(lengths, 9.0, rtol=1e-12)
    x, onsets = WINDOW.centres(12)[:, None], WINDOW.amplitudes(8_000)
    exact, housner = (WINDOW.modes(x, onsets, model).mode >= 0 for model in ("exact", "housner"))
    (line,) = tables["differences"].to_dict("records")
    # a cell on either side of each of some 100 edges of 12 columns
    assert line["false"] == pytest.approx((~exact & housner).mean(), abs=1e-3)
    assert line["missed"] == pytest.approx((exact & ~housner).mean(), abs=1e-3)
    assert f"{100.0 * (line['false'] + line['missed']):.2g} %" in overturning.finding(tables)
    assert overturning.window_of(tables["window"]) == WINDOW


def test_an_engine_is_judged_on_cells_beside_edges_and_by_its_threshold():
    jobs = overturning.jobs(("mujoco:fixed",), True, SMALL)
    made = [{**job.labels, "source": job.source, "message": ""} for job in jobs]
    rows = pd.DataFrame([{**made[0], **overturning.measure(jobs[0])}, *made[1:]])
    x, onsets = rows["x"].fillna(1.0).to_numpy(), rows["onsets"].to_numpy()
    right = np.where(WINDOW.modes(x, onsets).mode >= 0, "overturned", "rocked")
    right[1], right[2] = {"overturned": "rocked", "rocked": "overturned"}[right[1]], "failed"
    rows["outcome"] = np.where(rows["table"] == "map", "mapped", right)
    rows = rows.assign(peak_ratio=0.5, impacts=1, steps=1, wall_s=0.0, shift=-0.02, runs=18)
    found = overturning.tabulate(rows)
    (line,) = found["differences"].to_dict("records")
    assert (line["cells"], line["false"] + line["missed"]) == (64, 1 / 64)
    assert (line["rest_wrong"], line["no_answer"]) == (0, 1)
    assert "62 of 64" in overturning.finding(found)
    beside, shifts = list(overturning.shown(found).values())[-3:-1]
    assert beside.iloc[0, 1:].tolist() == [1.0, 1.0, 1.0]
    assert shifts.iloc[0, 1:].tolist() == [len(found["thresholds"])] * 2 + [0.02, 0.02]


def test_a_threshold_is_found_where_it_is_or_not_at_all():
    jobs = overturning.jobs(("exact", "mujoco:fixed"), True, SMALL)
    searches = [job for job in jobs if job.labels["table"] == "thresholds"]
    assert searches
    for job in searches:
        found = overturning.threshold(replace(job, source="exact"))
        assert abs(found["shift"]) < 1e-6
    pulse = job.case.motion
    far = replace(job.case, motion=replace(pulse, amplitude=20.0 * pulse.amplitude))
    assert math.isnan(overturning.threshold(replace(job, source="exact", case=far))["shift"])


def test_squat_blocks_lift_off_and_slender_ones_do_not():
    squat, slender = (
        overturning.needs(overturning.forces(Window(aspect=aspect, columns=9, rows=9, onsets=4.0)))
        for aspect in (1.0, 4.0)
    )
    assert squat["lift_off"][0] > 0 == slender["lift_off"][0]
    assert math.isnan(slender["from_onsets"][0])
    # the uplift itself needs B/H
    assert slender["least_friction"][0] >= 0.25


@pytest.fixture(scope="module")
def exact():
    """Return the rows of the exact solution on the quick planes."""
    return pd.DataFrame(run(planes.jobs(("exact",), True), overturning.measure))


def test_each_kind_of_wrong_outcome_on_planes_is_counted(exact):
    engine = exact.assign(source="mujoco:naive")
    rows = planes.with_verdicts(pd.concat([exact, engine], ignore_index=True))
    counted = (rows["verdict"] == "right") & (rows["source"] != "exact")
    assert 10 < counted.sum() < len(engine)
    engine.index = rows.index[rows["source"] != "exact"]
    over, *_ = engine.index[counted[engine.index] & (engine["outcome"] == "overturned")]
    first, second, third, fourth, fifth, *_ = engine.index[
        counted[engine.index] & (engine["outcome"] == "rocked")
    ]
    engine.loc[over, ["outcome", "peak_ratio"]] = ["rocked", 0.5]
    engine.loc[[first, fifth], ["outcome", "peak_ratio"]] = ["overturned", math.inf]
    engine.loc[second, ["outcome", "peak_ratio"]] = ["at rest", 0.0]
    engine.loc[third, ["outcome", "peak_ratio"]] = ["failed", math.nan]
    engine.loc[fourth, "peak_ratio"] *= 1.2
    found = planes.tables(pd.concat([exact, engine]))
    line = found["parts"].sum(numeric_only=True)
    assert line[["fall_wrong", "rest_wrong", "no_answer", "far"]].tolist() == [3, 1, 1, 1]
    assert (line["false_overturnings"], line["missed_overturnings"]) == (2, 1)
    assert line["close"] == line["cases"] - 6 == found["rests"]["close"].sum()
    assert found["parts"]["p90_error"].max() < 0.21
    assert "MuJoCo" in planes.finding(found["parts"])


@pytest.mark.parametrize(
    ("options", "parts"),
    [
        (["--sources", "rk4"], ("--sources", "'rk4'", "engines")),
        (["--aspect", "3", "--over", "slenderness"], ("--aspect is 3", "--over frequency or size")),
        (["--omega-over-p", "3"], ("--omega-over-p is 3", "slenderness")),
        (["--pulse-hz", "3"], ("--pulse-hz is 3", "size")),
        (["--low", "5", "--high", "2"], ("--low is 5", "smaller")),
        (["--high", "1e4"], ("--high is 10000", "0.001 to 1000")),
        (["--onsets", "1"], ("--onsets is 1", "1.001 to 1000")),
        (["--columns", "1000000000"], ("--columns is 1000000000", "GB")),
        (["--planes", "--aspect", "3"], ("--aspect is 3", "--planes")),
        (["--columns", "0"], ("--columns", "positive whole number")),
    ],
)
def test_what_cannot_be_mapped_is_refused_in_a_line(options, parts, tmp_path, capsys):
    out = tmp_path / "out"
    refused(capsys, ["overturning", "--out", out, "--sources", "exact", *options], *parts)
    assert not out.exists()
