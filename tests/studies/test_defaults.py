"""Engines as they come over the plane of pulses: verdicts, similarity, maps."""

import math

import numpy as np
import pandas as pd
import pytest

from analytic import simulate
from studies.__main__ import run
from studies.defaults import study
from studies.defaults.figure import COLOURS, LABELS, draw_maps
from studies.old.jobs import summary
from studies.measures.wrongness import FALL, KINDS, NO_ANSWER, REST


@pytest.fixture(scope="module")
def exact():
    """Return the rows of the exact solution on the quick grid, width by width."""
    rows = []
    for job in study.grid_jobs(("exact",), "base", True):
        row = summary(job, simulate(job.block, job.motion))
        rows.append({**job.labels, "source": "exact", **row})
    return pd.DataFrame(rows).sort_values("width_m", kind="stable", ignore_index=True)


def made_up(exact, **changes):
    """Return exact rows as if an engine had answered them."""
    return exact.assign(source="mujoco:naive", **changes)


def verdicts(exact, engine):
    rows = study.with_verdicts(pd.concat([exact, engine], ignore_index=True))
    return rows[rows["source"] != "exact"].reset_index(drop=True)


def test_an_engine_that_is_exact_is_right_where_it_is_judged(exact):
    rows = verdicts(exact, made_up(exact))
    judged = rows[rows["verdict"] != study.INVALID]
    assert 10 < len(judged) < len(rows)
    assert set(judged["verdict"]) == set(study.RIGHT)
    assert (rows["error"].dropna().abs() < 1e-12).all()


def test_each_kind_of_wrong_answer_is_told(exact):
    needed = exact.apply(study.friction_needed, axis=1)
    holds = (needed <= study.friction_of("mujoco:naive")).to_numpy()
    over, *_ = np.flatnonzero(holds & exact["outcome"].eq("overturned"))
    rocks, *_, last = np.flatnonzero(holds & exact["outcome"].eq("rocked"))
    engine = made_up(exact)
    engine.loc[over, ["outcome", "peak_ratio"]] = ["rocked", 0.5]
    engine.loc[rocks, ["outcome", "peak_ratio"]] = ["overturned", math.inf]
    engine.loc[last, "peak_ratio"] *= 1.2
    rows = verdicts(exact, engine)
    assert rows["verdict"][[over, rocks, last]].tolist() == [study.MISSED, study.FALSE, study.OFF]
    assert rows["error"][last] == pytest.approx(0.2)
    failed = verdicts(exact, made_up(exact, outcome="failed", peak_ratio=math.nan))
    assert set(failed["verdict"]) == {NO_ANSWER, study.INVALID}
    line = study.shares(pd.concat([rows, failed]).assign(wall_s=0.0)).iloc[0]
    assert line[["close", "far", *KINDS]].sum() == line["cases"]
    assert line["false_overturnings"] + line["missed_overturnings"] == line[FALL] == 2


def test_a_block_that_stays_where_it_should_rock_is_a_kind_of_its_own(exact):
    """Its peak is 0: an error of -100 %, but of the outcome."""
    rows = verdicts(exact, made_up(exact, outcome="at rest", peak_ratio=0.0))
    judged = rows["verdict"] != study.INVALID
    rocks = judged & (exact["outcome"] == "rocked").to_numpy()
    assert set(rows["verdict"][rocks]) == {REST} and rocks.any()
    assert set(rows["verdict"][judged & ~rocks]) == {study.MISSED}
    assert rows["error"].isna().all()
    line = study.shares(rows.assign(wall_s=0.0)).iloc[0]
    assert line[REST] + line[FALL] == line["cases"] and line["far"] == 0
    assert set(COLOURS) == set(LABELS) and len(set(COLOURS.values())) == len(COLOURS)


def test_a_block_that_slides_or_lifts_off_is_not_judged():
    for job in study.grid_jobs(("exact",), "base", True)[::7]:
        found = simulate(job.block, job.motion)
        wanted = found.friction_needed if found.min_normal > 0.0 else math.inf
        # after a rest, times are rounded anew
        needed = study.friction_needed(pd.Series(job.labels)[study.CASE])
        assert needed == pytest.approx(wanted, rel=1e-9)
    assert study.friction_of("exact") == math.inf
    assert study.friction_of("pybullet:naive") == 1.0


def test_similarity_is_seen_to_be_kept_and_to_be_broken(exact):
    def said(engine):
        table = study.similarity(study.with_verdicts(pd.concat([exact, engine], ignore_index=True)))
        return dict(table.to_numpy().tolist())

    assert said(made_up(exact)) == {"exact": 0.0, "mujoco:naive": 0.0}
    large = (exact["width_m"] == study.WIDTHS_M[-1]) & (exact["outcome"] == "rocked")
    grown = exact["peak_ratio"].where(~large, 2.0 * exact["peak_ratio"])
    judged = verdicts(exact, made_up(exact)).query("verdict != @study.INVALID")
    rocked = (judged["verdict"] == study.RIGHT[0]).mean()
    found = said(made_up(exact, peak_ratio=grown))
    assert found == {"exact": 0.0, "mujoco:naive": pytest.approx(rocked)}


def test_a_map_shows_every_case_of_a_width(exact):
    rows = study.with_verdicts(pd.concat([exact, made_up(exact)], ignore_index=True))
    rows = rows[rows["width_m"] == study.WIDTHS_M[0]]
    drawing = draw_maps(rows)
    image = drawing.axes[0].collections[0].get_array()
    assert image.size == (rows["source"] == "mujoco:naive").sum()
    assert drawing.axes[0].get_title() == "MuJoCo: 100 % right"


def test_the_study_asks_the_exact_solution_too(tmp_path, monkeypatch):
    monkeypatch.setattr(study, "QUICK_EVERY", 8)
    out = tmp_path / "defaults"
    code = run(["defaults", "--quick", "--sources", "pybullet:naive", "--out", str(out)])
    assert code == 0
    rows = pd.read_csv(out / "defaults.csv")
    assert list(rows["source"].unique()) == ["exact", "pybullet:naive"]
    assert study.STUDY.finding(out).startswith("As documented, outcome and peak (within 10 %)")
    assert set(study.STUDY.pictures(out)) == {"small", "large"}


def test_every_other_pulse_begins_after_a_rest():
    jobs = study.grid_jobs(("exact",), None, True)
    rested = [job for job in jobs if job.labels["rest_s"]]
    assert len(rested) == len(jobs) // 2
    for job in rested[::9]:
        ahead, alone = simulate(job.block, job.motion), simulate(job.block, job.motion.motion)
        assert ahead.outcome is alone.outcome
        assert ahead.peak_ratio == pytest.approx(alone.peak_ratio, rel=1e-9)


def test_an_engine_that_sleeps_through_a_rest_is_named(exact):
    asleep = exact["rest_s"] > 0.0
    lost = made_up(exact)
    lost.loc[asleep, ["outcome", "peak_ratio"]] = ["failed", math.nan]
    assert study.rest_claim(study.rests(verdicts(exact, made_up(exact)))) == ""
    said = "After 1 s of rest MuJoCo falls from all to 0 %."
    assert study.rest_claim(study.rests(verdicts(exact, lost))) == said
    sleepy = study.rests(verdicts(exact, lost.assign(source="dart:naive")))
    assert study.rest_claim(sleepy) == "After 1 s of rest DART falls from all to 0 %, asleep."


def test_a_moving_base_is_asked_of_engines_alone():
    jobs = study.grid_jobs(("exact", "pybullet:naive"), "world", True)
    frames = {job.source: job.options.get("frame", "base") for job in jobs}
    assert frames == {"exact": "base", "pybullet:naive": "world"}
