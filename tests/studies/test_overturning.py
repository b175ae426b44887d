"""Overturning maps: their cells, differences, contact forces; the planes of engines."""

import math

import numpy as np
import pandas as pd
import pytest

from analytic import peak_ratios, simulate
from studies import overturning
from studies.cases.window import Window, pulse_of
from studies.kit.run import run
from studies.overturning import Options

WINDOW = Window(columns=12, rows=60, low=0.3, high=6.0)


@pytest.fixture(scope="module")
def tables():
    jobs = overturning.map_jobs(("housner",), WINDOW)
    return overturning.tabulate(pd.DataFrame(run(jobs, overturning.measure)))


def test_cells_are_those_of_peak_ratios_and_of_cases(tables):
    areas = tables["map"]
    assert (areas["high"] > areas["low"]).all()
    lengths = (areas["high"] - areas["low"]).groupby([areas["model"], areas["omega_over_p"]]).sum()
    np.testing.assert_allclose(lengths, WINDOW.onsets - 1.0, rtol=1e-12)
    ratios, onsets = WINDOW.ratios(12)[:, None], WINDOW.amplitudes(60)
    alpha = math.atan(0.25)
    for model, mine in areas.groupby("model"):
        modes = overturning.modes_of(mine, WINDOW)
        peaks, _ = peak_ratios(alpha, onsets * math.tan(alpha), ratios, 2, model)
        assert (np.isinf(peaks) == (modes >= 0)).all()
    exact = overturning.modes_of(areas[areas["model"] == "exact"], WINDOW)
    for column, row in ((2, 10), (5, 30), (11, 50)):
        pulse = pulse_of(WINDOW.block, "full-sine", float(onsets[row]), float(ratios[column, 0]))
        response = simulate(WINDOW.block, pulse)
        assert math.isinf(response.peak_ratio) == (exact[column, row] >= 0)


def test_differences_are_parts_of_the_cells(tables):
    exact, housner = (
        overturning.modes_of(tables["map"][tables["map"]["model"] == name], WINDOW) >= 0
        for name in ("exact", "housner")
    )
    (line,) = tables["differences"].to_dict("records")
    assert line["false"] == (~exact & housner).mean() > 0.0
    assert line["missed"] == (exact & ~housner).mean() > 0.0
    assert f"{100.0 * (line['false'] + line['missed']):.2g} %" in overturning.finding(tables)
    assert overturning.window_of(tables["window"]) == WINDOW


def test_squat_blocks_lift_off_and_slender_ones_do_not():
    squat, slender = (
        overturning.forces(Window(aspect=aspect, columns=9, rows=9, onsets=4.0)).query(
            "outcome == 'rocked'"
        )
        for aspect in (1.0, 4.0)
    )
    assert squat["min_normal"].min() < 0.0 <= slender["min_normal"].min()
    # the uplift itself needs B/H
    assert slender["friction_needed"].min() >= 0.25


def test_engines_are_asked_on_planes_alone_and_beside_maps_of_models():
    alone = overturning.jobs(("mujoco:default",), True, Options())
    assert {job.source for job in alone} == {"exact", "mujoco:default"}
    assert all("width_m" in job.labels for job in alone)
    both = overturning.jobs(("housner", "mujoco:default"), True, Options())
    assert [job.source for job in both[:2]] == ["exact", "housner"]
    assert [job.key for job in both[2:]] == [job.key for job in alone]


@pytest.fixture(scope="module")
def exact():
    return pd.DataFrame(run(overturning.plane_jobs(("exact",), True), overturning.measure))


def test_each_kind_of_wrong_outcome_on_planes_is_counted(exact):
    engine = exact.assign(source="mujoco:default")
    rows = overturning.with_verdicts(pd.concat([exact, engine], ignore_index=True))
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
    found = overturning.tabulate(pd.concat([exact, engine]))
    line = found["parts"].sum(numeric_only=True)
    assert line[["fall_wrong", "rest_wrong", "no_answer", "far"]].tolist() == [3, 1, 1, 1]
    assert (line["false_overturnings"], line["missed_overturnings"]) == (2, 1)
    assert line["close"] == line["cases"] - 6
    assert found["parts"]["p90_error"].max() < 0.21
    assert "MuJoCo" in overturning.finding(found)
