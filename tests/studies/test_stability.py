"""Extreme cases: their boundaries, the verdicts, the tables."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analytic import History, Impact, Outcome, Response, simulate
from studies import stability
from studies.__main__ import run as rocking
from studies.cases.extreme import QUICK, SPRINGS, Extreme, extremes
from studies.kit.run import lost_row, run
from studies.kit.study import Study
from studies.measures.history import energy, growth
from studies.stability import Verdict, judge

CASE = Extreme(name="plain", group="test")
EXACT = simulate(CASE.block, CASE.motion)


def named(name):
    return next(case for case in extremes(False) if case.name == name)


def test_cases_have_names_of_their_own_and_quick_ones_are_among_them():
    names = [case.name for case in extremes(False)]
    assert len(names) == len(set(names))
    assert len(extremes(True)) == len(QUICK)


@pytest.mark.parametrize("name", ["boundary", "boundary after impact"])
def test_boundary_lies_between_its_two_cases(name):
    below, above = named(f"{name} − 1e-6"), named(f"{name} + 1e-6")
    # both are one millionth from the boundary, so two from each other
    assert above.onsets / below.onsets - 1 == pytest.approx(2e-6, rel=1e-3)
    outcomes = [simulate(case.block, case.motion).outcome for case in (below, above)]
    assert outcomes == [Outcome.ROCKED, Outcome.OVERTURNED]


@pytest.mark.parametrize(
    ("case", "source", "asked"),
    [
        ("friction 1", "exact", False),
        ("friction 1", "mujoco:default", True),
        ("contact of 1e-5/p", "mujoco:default", False),
        ("η 0.999, set", "pybullet", False),
        ("η 0.999, set", "dop853", True),
        ("step 1/30 s", "dop853", False),
        ("step 1/30 s", "rk4", True),
    ],
)
def test_cases_are_asked_of_those_who_have_what_is_extreme(case, source, asked):
    assert named(case).applies(source) is asked


def test_a_case_becomes_options_of_an_engine():
    assert named("friction 1e9").options("pybullet:default")["friction"] == 10.0  # Bullet's largest
    assert named("friction 1e9").options("mujoco")["friction"] == 1e9
    settings = SPRINGS["mujoco"](0.01, 0.0025)
    assert settings == {"stiffness": 0.0625, "damping": 0.5}
    settings = SPRINGS["pybullet"](0.01, 0.0025)  # critically damped
    assert settings["contact_damping"] == 2 * math.sqrt(settings["contact_stiffness"])


AT_REST = {"outcome": Outcome.AT_REST, "peak_ratio": 0.0}
DOUBLE = {"outcome": Outcome.ROCKED, "peak_ratio": 0.2}


@pytest.mark.parametrize(
    ("case", "source", "change", "verdict"),
    [
        ("", "mujoco", {}, Verdict.GOOD),
        ("", "mujoco", {"peak_ratio": 1.05 * EXACT.peak_ratio}, Verdict.COARSE),
        ("", "mujoco", {"peak_ratio": 0.5 * EXACT.peak_ratio}, Verdict.OFF),
        ("", "mujoco", {"outcome": Outcome.OVERTURNED, "peak_ratio": math.inf}, Verdict.FALL),
        ("", "mujoco", {"outcome": Outcome.FAILED, "message": "not finite"}, Verdict.FAILED),
        ("", "mujoco", {"slip_m": 0.02 * CASE.block.width}, Verdict.SLIDES),
        ("", "mujoco", AT_REST, Verdict.REST),
        ("onset + 1e-6", "mujoco", AT_REST, Verdict.UNSEEN),
        ("60 s at rest", "mujoco", DOUBLE, Verdict.REST),
        ("60 s at rest", "mujoco", {**AT_REST, "peak_ratio": 2e-3}, Verdict.GOOD),
        ("friction 0.3", "mujoco", DOUBLE, Verdict.INVALID),
        ("friction 1", "mujoco", DOUBLE, Verdict.OFF),
        # the pivot lifts off: not the engine's fault, but a solver solves the same equation
        ("H/B 0.8, violent", "mujoco", DOUBLE, Verdict.INVALID),
        ("H/B 0.8, violent", "rk4", DOUBLE, Verdict.OFF),
        ("H/B 0.8, violent", "mujoco", {"outcome": Outcome.FAILED}, Verdict.FAILED),
    ],
)
def test_verdict_of_a_changed_answer(case, source, change, verdict):
    found = judge(named(case) if case else CASE, source, replace(EXACT, **change))
    assert found["verdict"] == verdict.value


def test_energy_that_grows_is_seen_and_one_that_falls_is_not():
    block, motion = CASE.block, CASE.motion
    times = np.linspace(motion.duration, motion.duration + 1.0, 200)
    theta = np.full(200, 0.1 * block.alpha)
    edges = tuple(Impact(motion.duration + s, 1.0, -0.8) for s in (0.0, 1.0))
    for slope, grown in ((0.1, True), (-0.1, False)):
        velocity = block.p * block.alpha * (1.0 + slope * np.linspace(0.0, 1.0, 200))
        moved = replace(EXACT, history=History(times, theta, velocity), impacts=edges)
        assert (judge(CASE, "rk4", moved)["verdict"] == "energy") == grown
        kept = energy(block, moved.history)[31:169]
        expected = 1.0 - kept[0] / kept[-1] if grown else 0.0
        assert growth(block, motion, moved) == pytest.approx(expected, abs=2e-3)


def test_a_job_that_was_given_up_is_a_row_too():
    job = stability.jobs(["rk4"], True)[0]
    row = lost_row(stability.measure, job, Response.failure("no result within the time limit"))
    assert (row["outcome"], row["message"]) == ("failed", "no result within the time limit")
    assert row["verdict"] == "no_answer"


def test_tables_and_what_they_say():
    jobs = stability.jobs(("rk4", "average-acceleration"), True)
    asked = [job for job in jobs if job.labels["case"] == "step 1/30 s"]
    tables = stability.tabulate(pd.DataFrame(run(asked, stability.measure)))
    assert tables["stability"]["verdict"].tolist() == ["good", "off"]
    assert "1 of 2" in stability.finding(tables)
    words = {
        "pybullet:default": ["off", "no_answer", "good", "invalid"],
        "mujoco": ["good", "good", "unseen", "invalid"],
        "pymunk": ["good", "coarse"],
    }
    matrix = pd.DataFrame(
        [{"source": source, "verdict": verdict, "case": place}
         for source in words for place, verdict in enumerate(words[source])]
    )  # fmt: skip
    by_case = stability.by_case(matrix).set_index("case")
    assert by_case["landing"].tolist() == ["2 of 2", "1 of 2", "0 of 1"]
    scores = stability.scores(matrix).set_index("preset")
    # what goes unseen is not right, what is invalid not counted
    assert scores.loc["default"].tolist() == [1, 1, 3]
    assert scores.loc["landing"].tolist() == [2, 3, 5]
    assert "33 %" in stability.finding({"stability": matrix})
    assert "60 %" in stability.finding({"stability": matrix})
    assert len(stability.failures(matrix)) == 3


def test_only_a_source_without_any_result_is_needed():
    rows = [("a", "failed"), ("a", "rocked"), ("b", "failed")]
    rows = [{"source": source, "outcome": outcome} for source, outcome in rows]
    assert stability.without_result(rows) == rows[2:]


@pytest.mark.parametrize(("words", "limit"), [("--jobs 2", 600.0), ("--time-limit 5", 5.0)])
def test_the_time_limit_is_that_of_all_or_the_one_given(words, limit, tmp_path, monkeypatch):
    seen = []
    monkeypatch.setattr(
        Study, "carry_out", lambda self, out, jobs, running, **_: seen.append(running)
    )
    rocking(["stability", "--out", str(tmp_path), "--sources", "exact", *words.split()])
    assert [running.time_limit for running in seen] == [limit]
