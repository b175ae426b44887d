"""Overturning maps: edges, islands, differences, checks, and the command."""

import itertools
import math

import numpy as np
import pandas as pd
import pytest
from commanding import refused

from analytic import MODELS, Outcome, peak_ratios, simulate
from analytic.criteria import overturning_amplitude
from analytic.maps import Modes
from studies.__main__ import run
from studies.cases.window import AXES, LIMITS, Window
from studies.old.tables import table_in
from studies.measures.published import PUBLISHED
from studies.overturning.edges import WIDTH, find_edges, intervals
from studies.overturning.engine_edges import (
    ROOM,
    Bisected,
    chosen_edges,
    edge_jobs,
    threshold,
)
from studies.overturning.report import (
    apart,
    beside_edges,
    checks,
    differences,
    edges,
    finding,
    modes,
    modes_at,
    shifts,
    window_of,
    with_verdicts,
)
from studies.overturning.study import mapped
from studies.sources.registry import core_sources, resolve

WINDOW = Window(columns=12, rows=60, low=0.3, high=6.0)


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
    edges = find_edges(known(islands), 1, np.linspace(1.0, 8.0, 50))
    inside = sorted(end for island in islands for end in island[:2] if end < 8.0)
    middle = 0.5 * (edges["low"] + edges["high"])
    assert list(middle) == pytest.approx(inside, abs=WIDTH)
    assert (edges["high"] - edges["low"] <= WIDTH).all()


def test_modes_without_an_island_between_them_are_an_edge():
    edges = find_edges(known([(2.0, 4.4, 2), (4.4 - 1e-13, 9.0, 0)]), 1, np.linspace(1.0, 8.0, 50))
    assert list(zip(edges["below"], edges["above"], strict=True)) == [(-1, 2), (2, 0)]
    assert edges["low"].iloc[1] == pytest.approx(4.4, abs=WIDTH)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("over", AXES)
def test_edges_are_those_of_peak_ratios(model, over):
    window = Window(over=over, columns=8, rows=80)
    edges, _ = mapped(window, model)
    assert len(edges) > 8
    alpha, ratio = edges["alpha"].to_numpy(), edges["omega_over_p"].to_numpy()
    for side, mode in (("low", "below"), ("high", "above")):
        shift = 1.0 - 2e-10 if side == "low" else 1.0 + 2e-10
        amplitude = edges[side].to_numpy() * shift * np.tan(alpha)
        peaks, _ = peak_ratios(alpha, amplitude, ratio, 2, model)
        wide = island_width(edges) > 1e-8
        np.testing.assert_array_equal(np.isinf(peaks)[wide], (edges[mode] >= 0).to_numpy()[wide])


def island_width(edges):
    """Return the distance of each edge to the next one in its column, on either side."""
    widths = []
    for _, group in edges.groupby("x", sort=False):
        gaps = np.diff(group["low"])
        widths += list(np.minimum(np.append(np.inf, gaps), np.append(gaps, np.inf)))
    return np.array(widths)


def test_a_finer_grid_finds_no_other_edges():
    coarse, _ = mapped(Window(columns=12, rows=100, low=0.5), "exact")
    fine, _ = mapped(Window(columns=12, rows=1500, low=0.5), "exact")
    np.testing.assert_allclose(coarse["low"], fine["low"], atol=2 * WIDTH)
    assert list(coarse["above"]) == list(fine["above"])


def test_strips_change_nothing(monkeypatch):
    whole = mapped(WINDOW, "housner")
    monkeypatch.setattr("studies.overturning.study.STRIP", 3 * WINDOW.rows)
    for part, other in zip(whole, mapped(WINDOW, "housner"), strict=True):
        pd.testing.assert_frame_equal(part.reset_index(drop=True), other.reset_index(drop=True))


def test_intervals_cover_each_column_and_repeat_the_grid():
    _, spans = mapped(WINDOW, "exact")
    x, onsets = WINDOW.centres(12), WINDOW.amplitudes(200)
    lengths = (spans["high"] - spans["low"]).groupby(spans["x"]).sum()
    np.testing.assert_allclose(lengths, 9.0, rtol=1e-12)
    direct = WINDOW.modes(x[:, None], onsets).mode
    np.testing.assert_array_equal(
        np.maximum(modes_at(spans, x, onsets), -1), np.maximum(direct, -1)
    )


def test_areas_of_difference_are_those_of_a_fine_grid():
    areas = pd.concat([mapped(WINDOW, name)[1] for name in ("exact", "housner")])
    (row,) = differences(areas, pd.DataFrame(), WINDOW).to_dict("records")
    x, onsets = WINDOW.centres(12), WINDOW.amplitudes(8_000)
    exact, housner = (WINDOW.modes(x[:, None], onsets, m).mode for m in ("exact", "housner"))
    # a cell on either side of each of some 100 edges of 12 columns
    assert row["false"] == pytest.approx(((exact < 0) & (housner >= 0)).mean(), abs=1e-3)
    assert row["missed"] == pytest.approx(((exact >= 0) & (housner < 0)).mean(), abs=1e-3)
    assert row["false"] > 0.005
    assert row["missed"] > 0.005


def test_the_least_amplitude_without_impact_of_a_half_sine_is_the_criterion():
    window = Window(pulse="half-sine", columns=10, rows=50)
    edges, _ = mapped(window, "housner")
    found = (0.5 * (edges["low"] + edges["high"])).to_numpy()
    law = MODELS["housner"].law(math.atan(0.25), 0.9)
    expected = [overturning_amplitude(ratio) * law.onset / 0.25 for ratio in edges["omega_over_p"]]
    np.testing.assert_allclose(found, expected, atol=WIDTH)


def test_checks_hold():
    table = checks(WINDOW)
    apart = (table["found"] / table["expected"] - 1.0).abs()
    criterion = table["against"].str.startswith("the criterion")
    assert criterion.sum() == 24
    assert (apart[criterion] < 1e-13).all()
    # Housner's own formula lies above the threshold: it is not on the safe side
    housner = table["against"].str.startswith("Housner")
    assert (table["found"] < table["expected"])[housner].all()
    # a pulse of ω/p = 1e5 acts in a time of order 1e-5/p
    assert (apart[~criterion & ~housner] < 3e-5).all()


def test_what_is_told_is_counted_from_the_published_tables():
    folder = PUBLISHED / "overturning"
    areas, boundaries = table_in(folder, "map"), table_in(folder, "boundaries")
    parts = modes(areas, window_of(folder)).set_index("model")
    np.testing.assert_allclose(parts.sum(axis=1), 1.0, rtol=1e-12)
    told = edges(boundaries, ["exact"]).iloc[0]
    assert told["edges"] == told[["grid", "mode", "margin"]].sum()
    assert told["edges"] == (boundaries["model"] == "exact").sum()
    cases, thresholds = table_in(folder, "edges"), table_in(folder, "thresholds")
    beside = beside_edges(cases).set_index("source")
    mine = cases[(cases["source"] == "dart:naive") & (cases["offset"].abs() == 1e-3)]
    rises = mine["overturns"].eq("above") == mine["offset"].gt(0.0)
    assert beside.loc["dart:naive", "0.001"] == (mine["outcome"].eq("overturned") == rises).mean()
    found = shifts(thresholds).set_index("source").loc["dart:naive"]
    own = thresholds.loc[thresholds["source"] == "dart:naive", "shift"]
    assert (found["asked"], found["found"]) == (len(own), own.notna().sum())
    assert found["largest"] == own.abs().max()
    assert apart(table_in(folder, "checks"))["thresholds"].tolist() == [24, 4, 1]
    told = finding(table_in(folder, "differences").query("source in ['housner', 'pymunk:naive']"))
    cells = table_in(folder, "engines").query("source == 'pymunk:naive'")
    wrong = (with_verdicts(cells, window_of(folder))["verdict"].isin(["false", "missed"])).sum()
    assert f"the fall wrong in {wrong}" in told
    pd.testing.assert_frame_equal(
        differences(areas, table_in(folder, "engines"), window_of(folder)),
        table_in(folder, "differences"),
        check_dtype=False,
    )


@pytest.mark.parametrize("over", AXES)
def test_a_point_of_the_plane_is_the_case_that_sources_get(over):
    window = Window(over=over)
    x, onsets = 0.5 * (window.low + window.high), 2.4
    block, motion = window.case(x, onsets)
    assert block.alpha == pytest.approx(float(window.alpha(np.array(x))), rel=1e-14)
    assert motion.omega / block.p == pytest.approx(float(window.ratio(np.array(x))), rel=1e-14)
    if over == "size":
        assert block.p / (2.0 * math.pi) == pytest.approx(x, rel=1e-14)
        assert motion.omega == pytest.approx(2.0 * math.pi * window.pulse_hz, rel=1e-14)
    overturned = simulate(block, motion).outcome is Outcome.OVERTURNED
    assert overturned == bool(window.modes(np.array(x), np.array(onsets)).mode >= 0)


def test_a_threshold_is_found_where_it_is():
    edges, _ = mapped(WINDOW, "exact")
    chosen = chosen_edges(edges, [4.0])
    (x,) = chosen["x"].unique()
    assert abs(x - 4.0) <= 0.5 * 5.7 / WINDOW.columns
    column = edges.loc[edges["x"] == x, "low"]
    for low in column:
        alone = (abs(np.log(column.drop(column.index[column == low]) / low)) > ROOM).all()
        assert alone == (low in set(chosen["low"]))
    jobs = [j for j in edge_jobs(WINDOW, ["exact"], chosen) if j.labels["table"] == "thresholds"]
    for job in jobs:
        found = threshold(job, resolve("exact"))
        assert isinstance(found, Bisected)
        assert abs(found.shift) < 1e-6


def test_the_command_repeats_itself_and_maps_one_window_to_a_folder(tmp_path, capsys):
    arguments = ["overturning", "--out", str(tmp_path), "--columns", "20", "--rows", "40"]
    arguments += ["--quick", "--sources", "exact", "housner"]
    told = []
    for _ in range(2):
        assert run(arguments) == 0
        told.append(capsys.readouterr().out)
    assert told[0] == told[1]
    assert set(table_in(tmp_path, "boundaries")["model"]) == {"exact", "housner"}
    refused(capsys, [*arguments[:3], "--quick", "--sources", "exact", "housner"], "settings")


@pytest.mark.parametrize(
    ("window", "sources", "told"),
    [
        (["--pulse", "half-sine"], ["exact"], "The exact map stands alone"),
        # nothing overturns
        (["--low", "20", "--high", "40"], ["exact", "housner"], "Edges of each model"),
        (["--over", "size", "--pulse-hz", "20"], ["exact", "housner"], "Edges of each model"),
    ],
)
def test_a_map_of_one_source_and_one_without_edges(window, sources, told, tmp_path, capsys):
    arguments = ["overturning", "--out", str(tmp_path), "--columns", "6", "--rows", "12", *window]
    assert run([*arguments, "--quick", "--sources", *sources]) == 0
    found = edges(table_in(tmp_path, "boundaries"), sources)
    assert found["edges"].eq(0).all() == (len(sources) > 1)
    assert told in capsys.readouterr().out
    assert (tmp_path / "map.png").exists()
    assert (tmp_path / "differences.png").exists() == (len(sources) > 1)


@pytest.mark.slow
@pytest.mark.parametrize("over", AXES)
@pytest.mark.parametrize("end", [0, 1])
def test_every_edge_is_found_at_the_limits_of_a_window(over, end):
    least, most = LIMITS[over]
    low = least if end == 0 else most / 1.5
    known = {"over": over, "low": low, "high": 1.5 * low, "columns": 4, "rows": 10}
    known |= {"pulse_hz": low} if over == "size" else {}
    for onsets, aspect in itertools.product(LIMITS["onsets"], LIMITS["aspect"]):
        window = Window(onsets=onsets, aspect=aspect, **known)
        for model in MODELS:
            _, spans = mapped(window, model)
            assert (spans["mode"] >= -2).all()


@pytest.mark.slow
def test_engines_agree_a_thousandth_from_an_edge(tmp_path, capsys):
    arguments = ["overturning", "--out", str(tmp_path), "--columns", "20", "--rows", "100"]
    arguments += ["--sources", "exact", *core_sources()]
    assert run([*arguments, "--quick"]) == 0
    capsys.readouterr()
    edges = table_in(tmp_path, "edges")
    expected = (edges["offset"] > 0.0) == (edges["overturns"] == "above")
    assert ((edges["outcome"] == "overturned") == expected)[edges["offset"].abs() >= 1e-3].all()
    assert table_in(tmp_path, "thresholds")["shift"].abs().max() < 1e-3


def test_intervals_of_a_column_without_edges():
    none = pd.DataFrame({"column": [], "low": [], "high": [], "above": []})
    spans = intervals(none.astype({"column": int}), np.array([-1, 0], dtype=np.int32), 1.0, 10.0)
    assert spans.to_numpy().tolist() == [[0, 1, 10, -1], [1, 1, 10, 0]]
