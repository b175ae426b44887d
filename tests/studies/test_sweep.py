"""The paper's sweep: its rows, its summary and its conclusions."""

import numpy as np
import pandas as pd
import pytest

from studies import sweep
from studies.kit.run import run


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
