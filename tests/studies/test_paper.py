"""The paper's sweep, its time histories and its linearizations: tables, and what it concludes."""

import math

import numpy as np
import pandas as pd
import pytest

from analytic import MODELS, peak_ratios
from studies import histories, linearizations, sweep
from studies.kit.run import run
from studies.kit.study import claim
from studies.linearizations import NAMED, VARIANTS, errors_on, grid
from studies.measures.differences import posed_cases


def test_the_exact_model_agrees_with_itself():
    jobs = sweep.jobs(("exact", "housner"), False, sweep.Options(figure=(8,)))
    rows = pd.DataFrame(run(jobs, sweep.STUDY.measure))
    tables = sweep.tabulate(rows)
    line = tables["summary"].set_index("source").loc["exact"]
    assert (line["agree"], line["fall_wrong"]) == (240, 0)
    assert line["max_error"] < 1e-12
    found = tables["findings"].set_index("statement")
    assert found.loc[
        "Housner's linearization overturns blocks that survive, even at H/B = 3", "holds"
    ]
    housner = tables["summary"].set_index("source").loc["housner"]
    assert housner["false_overturnings"] == 20
    peaks = (rows.loc[rows["source"] == name, "peak_ratio"] for name in ("exact", "housner"))
    right, found = (peak.to_numpy() for peak in peaks)
    both = np.isfinite(right) & np.isfinite(found) & (right > 0.0)
    off = np.sort(np.abs(found[both] / right[both] - 1.0))
    assert housner["median_error"] == pytest.approx(np.median(off), rel=1e-12)
    assert housner["p90_error"] == pytest.approx(np.quantile(off, 0.9), rel=1e-12)
    assert housner["max_error"] == pytest.approx(off[-1], rel=1e-12)


def test_the_finding_of_presets_names_the_worst_engine_of_the_best():
    lines = pd.DataFrame(
        {
            "figure": "all", "source": ["mujoco:default", "mujoco:tuned", "pybullet:tuned"],
            "cases": 10, "survivors": 5, "agree": [2, 10, 9], "fall_wrong": 0, "rest_wrong": 0,
            "no_answer": 0, "median_error": 0.1, "median_difference": 0.05, "p90_error": 0.1,
            "max_error": [0.9, 0.02, 0.03], "wall_s": 1.0,
        }
    )  # fmt: skip
    words = sweep.finding({"summary": lines})
    assert "at least 2 of 10 outcomes" in words and "at least 9 " in words


def lines(number, **peaks):
    rows = [
        {
            "figure": number, "panel": panel, "source": source, "peak_ratio": peak,
            "outcome": "overturned" if np.isinf(peak) else "failed" if np.isnan(peak) else "rocked",
            **{name: [0.0, peak] for name in histories.SAMPLES},
        }
        for source, found in peaks.items()
        for panel, peak in zip("abc", found, strict=False)
    ]  # fmt: skip
    return pd.DataFrame(rows)


@pytest.mark.parametrize(
    ("housner", "modified", "holds"),
    [
        ((1.1, 1.2, 1.5), (1.0, 1.0, 1.0), True),
        ((1.1, 1.2, 1.0), (1.0, 1.0, 1.0), False),  # it does not grow
        ((1.1, 1.2, 1.2), (1.0, 1.0, 1.0), False),
        ((1.1, 1.2, 1.5), (1.0, 1.3, 1.0), False),  # the modified one is further off
        ((1.1, np.nan, 1.5), (1.0, 1.0, 1.0), None),  # a failed source cannot be tested
    ],
)
def test_figure_4_compares_errors_of_the_peak(housner, modified, holds):
    rows = lines(4, exact=(1.0, 1.0, 1.0), housner=housner, modified=modified)
    assert histories.tabulate(rows)["findings"]["holds"].tolist() == [holds]


@pytest.mark.parametrize(("peak", "holds"), [(np.inf, True), (0.9, False)])
def test_figure_5_compares_outcomes(peak, holds):
    rows = lines(5, exact=[0.5] * 3, housner=[0.5, np.inf, peak], modified=[0.5] * 3)
    tables = histories.tabulate(rows)
    assert tables["findings"]["holds"].tolist() == [holds]
    assert f"{'1' if holds else 'None'} of 1" in histories.finding(tables)


def test_samples_stand_beside_their_case_and_a_failed_line_has_none():
    jobs = histories.jobs((), False, histories.Options(figure=(2,), sources=("exact", "rk4")))
    rows = pd.DataFrame(run(jobs, histories.measure))
    table = histories.tabulate(rows)["figure-2"]
    assert table.groupby(["panel", "source"]).size().tolist() == [1501] * 4
    peaks = table["theta_ratio"].abs().groupby([table["panel"], table["source"]]).max()
    assert peaks["b", "exact"] == pytest.approx(0.1369, abs=1e-4)
    rows.loc[0, "outcome"] = "failed"
    found = histories.tabulate(rows)
    assert len(found["figure-2"]) == 3 * 1501
    assert found["findings"]["holds"].isna().all()  # average acceleration was not asked
    assert "No statement" in histories.finding(found)


def test_a_claim_needs_its_sources():
    table = pd.DataFrame({"source": ["exact"], "value": [2.0]})
    less = claim("two is less than one", "exact")(lambda t: (bool((t["value"] < 1).all()), "2"))
    lost = claim("nobody asked", "rk4")(lambda t: (True, ""))
    assert list(pd.DataFrame([less(table), lost(table)])["holds"]) == [False, None]


@pytest.mark.parametrize("changed", VARIANTS)
def test_each_change_is_what_it_says(changed):
    onset, frequency, saddle = map(int, changed)
    law = VARIANTS[changed].law(0.6, 0.7)
    assert law.onset == pytest.approx(math.tan(0.6) if onset else 0.6)
    assert law.k == pytest.approx(math.sqrt(math.cos(0.6)) if frequency else 1.0)
    assert law.saddle == pytest.approx(math.tan(0.6) if saddle else 0.6)
    if changed in NAMED:
        assert law == pytest.approx(MODELS[NAMED[changed]].law(0.6, 0.7), rel=1e-15)


def test_the_saddle_alone_scales_the_rotation_and_changes_no_outcome():
    """A linear model's equation holds for any multiple of y that scales saddle and forcing."""
    cases = grid("paper").iloc[::7]
    posed = posed_cases(cases)
    scale = np.tan(posed[0]) / posed[0]
    for changed in ("00", "01", "10", "11"):
        at_alpha, outcome = peak_ratios(*posed, model=VARIANTS[f"{changed}0"])
        at_tangent, same = peak_ratios(*posed, model=VARIANTS[f"{changed}1"])
        # but for a block whose side touches the ground, at 90 degrees whatever its saddle
        assert np.mean(outcome == same) > 0.99
        both = np.isfinite(at_alpha) & np.isfinite(at_tangent)
        np.testing.assert_allclose(at_tangent[both], (scale * at_alpha)[both], rtol=1e-11)


def test_grids_have_no_copies_and_errors_are_against_the_exact_peak():
    assert len(grid("paper")) == 480
    assert not grid("wide").duplicated().any()
    errors = errors_on("paper", "111")
    row = errors[errors["error"].notna()].iloc[40]
    posed = (math.atan(1 / row["aspect"]), *row[["amplitude_g", "omega_over_p", "half_cycles"]])
    peaks = [float(peak_ratios(*posed, model=name)[0]) for name in ("modified", "exact")]
    assert row["error"] == pytest.approx(peaks[0] / peaks[1] - 1.0)


def test_tables_follow_the_rows(monkeypatch):
    monkeypatch.setattr(linearizations, "GRIDS", ("paper",))
    rows = pd.DataFrame(run(linearizations.jobs((), False), linearizations.measure))
    wide = rows.assign(
        grid="wide", by_aspect=[[dict(it) for it in each] for each in rows["by_aspect"]]
    )
    both = pd.concat([rows, wide], ignore_index=True)
    tables = linearizations.tabulate(both)
    lines = tables["linearizations"].set_index(["grid", "changed"])
    assert len(lines) == 16
    assert lines.loc[("paper", "000"), ["cases", "wrong", "false"]].tolist() == [480, 26, 25]
    assert tables["slenderness"].groupby("grid")["false"].sum()["paper"] == lines["false"].sum() / 2
    assert tables["findings"]["holds"].tolist() == [False]
    assert "onset" in linearizations.finding(tables) and "61 %" in linearizations.finding(tables)
    both["median_error"] = [0.1 if changed[1] == "1" else 0.2 for changed in both["changed"]]
    assert linearizations.tabulate(both)["findings"]["holds"].tolist() == [True]
