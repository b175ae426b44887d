"""Extreme cases: their boundaries, the verdicts, the search for a step, the sensitivity."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from analytic import Outcome, Response, simulate
from analytic.response import History, Impact
from studies.cases.extreme import QUICK, Extreme, contact_settings, extremes
from studies.old.jobs import ask
from studies.old.options import Running
from studies.old.plan import fill
from studies.measures.differences import with_conditioning
from studies.measures.energy import energy, growth
from studies.measures.verdicts import Verdict, invalidity, judge
from studies.sources.registry import resolve
from studies.stability import STUDY, study
from studies.stability.figure import MARKS
from studies.stability.largest_step import (
    FACTOR,
    LARGEST_STEP,
    PROBLEMS,
    SMALLEST_STEP,
    largest_good,
    search,
    search_job,
    step_jobs,
)
from studies.stability.remedies import NOTHING, answer, remedies
from studies.stability.sensitivity import (
    CASES,
    condition_number,
    exact_change,
    perturbed,
    sensitivity_jobs,
    with_growth,
)

CASE = Extreme(name="plain", group="test")
EXACT = simulate(CASE.block, CASE.motion)


def named(name):
    return next(case for case in extremes(False) if case.name == name)


def job_of(name, source):
    return next(
        job
        for job in study.matrix_jobs([source], False)
        if (job.labels["case"], job.source) == (name, source)
    )


def test_cases_have_names_of_their_own_and_quick_ones_are_among_them():
    names = [case.name for case in extremes(False)]
    assert len(names) == len(set(names))
    assert [case.name for case in extremes(True)] == [name for name in names if name in QUICK]
    assert len(extremes(True)) == len(QUICK)


@pytest.mark.parametrize("name", ["boundary", "boundary after impact"])
def test_boundary_lies_between_its_two_cases(name):
    below, above = named(f"{name} − 1e-6"), named(f"{name} + 1e-6")
    # both are one millionth from the boundary, so two from each other
    assert above.onsets / below.onsets - 1 == pytest.approx(2e-6, rel=1e-3)
    outcomes = [simulate(case.block, case.motion).outcome for case in (below, above)]
    assert outcomes == [Outcome.ROCKED, Outcome.OVERTURNED]


def test_cases_are_asked_of_those_who_have_what_is_extreme():
    assert not named("friction 1").applies("exact")
    assert named("friction 1").applies("mujoco:naive")
    assert not named("contact of 1e-5/p").applies("mujoco:naive")
    assert not named("η 0.999, set").applies("pybullet")
    assert named("η 0.999, set").applies("dop853")
    assert not named("step 1/30 s").applies("dop853")
    assert named("step 1/30 s").applies("rk4")


def test_bullet_is_given_the_friction_that_it_takes():
    assert named("friction 1e9").options("pybullet:naive")["friction"] == 10.0
    assert named("friction 1e9").options("mujoco")["friction"] == 1e9


def test_contact_of_a_time_is_critically_damped():
    settings = contact_settings("mujoco", 0.01, 0.0025)
    assert settings == {"stiffness": 0.0625, "damping": 0.5}
    settings = contact_settings("pybullet", 0.01, 0.0025)
    assert settings["contact_damping"] == 2 * math.sqrt(settings["contact_stiffness"])


@pytest.mark.parametrize(
    ("change", "verdict"),
    [
        ({}, Verdict.GOOD),
        ({"peak_ratio": 1.05 * EXACT.peak_ratio}, Verdict.COARSE),
        ({"peak_ratio": 0.5 * EXACT.peak_ratio}, Verdict.OFF),
        ({"outcome": Outcome.OVERTURNED, "peak_ratio": math.inf}, Verdict.FALL),
        ({"outcome": Outcome.FAILED, "message": "not finite"}, Verdict.FAILED),
        ({"slip_m": 0.02 * CASE.block.width}, Verdict.SLIDES),
    ],
)
def test_verdict_of_a_changed_answer(change, verdict):
    found = judge(CASE, "mujoco", replace(EXACT, **change))
    assert found.verdict is verdict
    assert (found.reason == "") == (verdict is Verdict.GOOD)


def test_energy_that_grows_is_seen_and_one_that_falls_is_not():
    block, motion = CASE.block, CASE.motion
    times = np.linspace(motion.duration, motion.duration + 1.0, 200)
    theta = np.full(200, 0.1 * block.alpha)
    edges = tuple(Impact(motion.duration + s, 1.0, -0.8) for s in (0.0, 1.0))
    for slope, grown in ((0.1, True), (-0.1, False)):
        velocity = block.p * block.alpha * (1.0 + slope * np.linspace(0.0, 1.0, 200))
        history = History(times, theta, velocity)
        moved = replace(EXACT, history=history, impacts=edges)
        assert (judge(CASE, "rk4", moved).verdict is Verdict.ENERGY) == grown
        kept = energy(block, history)[31:169]
        expected = kept[-1] / kept[-1] - kept[0] / kept[-1] if grown else 0.0
        assert growth(block, motion, moved) == pytest.approx(expected, abs=2e-3)


def test_reference_that_does_not_hold_is_not_the_engines_fault():
    lifting = named("H/B 0.8, violent")
    exact = simulate(lifting.block, lifting.motion)
    wrong = replace(exact, peak_ratio=2.0 * exact.peak_ratio)
    assert exact.min_normal < 0.0
    assert judge(lifting, "mujoco", wrong).verdict is Verdict.INVALID
    # a solver solves the same equation, whatever it means
    assert judge(lifting, "rk4", wrong).verdict is Verdict.OFF
    broken = Response.failure("the engine's state is not finite")
    assert judge(lifting, "mujoco", broken).verdict is Verdict.FAILED
    falling = replace(lifting, omega_over_p=0.5)
    fallen = simulate(falling.block, falling.motion)
    assert fallen.outcome is Outcome.OVERTURNED
    assert "lifts off" in invalidity(falling, "mujoco", fallen)
    assert "slides" in invalidity(named("friction 0.3"), "mujoco", EXACT)
    assert invalidity(named("friction 1"), "mujoco", EXACT) == ""


def test_a_rocking_too_small_to_see_is_no_wrong_outcome():
    tiny = named("onset + 1e-6")
    resting = replace(EXACT, outcome=Outcome.AT_REST, peak_ratio=0.0)
    assert judge(tiny, "mujoco", resting).verdict is Verdict.UNSEEN
    assert judge(CASE, "mujoco", resting).verdict is Verdict.REST
    lifted = replace(EXACT, outcome=Outcome.ROCKED, peak_ratio=0.1)
    assert judge(named("60 s at rest"), "mujoco", lifted).verdict is Verdict.REST


@pytest.mark.parametrize("limit", [2e-4, 3e-3, 0.011, 0.3])
def test_edge_is_found_within_its_factor(limit):
    found = largest_good(lambda step: step <= limit, FACTOR)
    assert limit / FACTOR <= found <= limit

    assert largest_good(lambda step: True, FACTOR) == LARGEST_STEP
    assert math.isnan(largest_good(lambda step: step < SMALLEST_STEP, FACTOR))


def test_a_search_is_tried_with_every_contact_time_of_a_source():
    asked = step_jobs(["exact", "rk4", "mujoco:naive", "mujoco:fixed"], True)
    assert [job.source for job in asked] == ["rk4", "mujoco:naive", *["mujoco:fixed"] * 2]
    own = resolve("mujoco:naive").used.contact_s
    times = [math.nan, own, math.nan, 0.01 / CASE.block.p]
    assert [job.labels["contact_s"] for job in asked] == pytest.approx(times, nan_ok=True)


def test_largest_accurate_step_is_accurate_and_the_next_is_not():
    case = Extreme(name="peak after an impact", group="steps")
    source = resolve("average-acceleration")
    found = search(search_job(case, "average-acceleration", math.nan, False), source, 1.0)
    assert found.largest_accurate < found.largest_stable
    for factor, accurate in ((1.0, True), (FACTOR, False)):
        step = factor * found.largest_accurate
        peak = source.call(case.block, case.motion, step=step).peak_ratio
        assert (abs(peak / EXACT.peak_ratio - 1) <= 0.01) == accurate


def test_a_coarse_step_is_mended_by_a_finer_one():
    case = named("step 1/30 s")
    job = job_of("step 1/30 s", "average-acceleration")
    found = answer(case, job, resolve(job.source), 60.0)
    assert judge(case, job.source, found).verdict is Verdict.OFF
    assert found.remedy not in ("", NOTHING)


@pytest.mark.parametrize("source", study.METHODS)
def test_remedies_are_other_settings(source):
    case = named("contact of 1e-5/p")
    found = remedies(case, source)
    assert (source, case.options(source)) not in [(name, options) for _, name, options in found]
    assert all(sentence for sentence, *_ in found)


@pytest.mark.parametrize("case", CASES[:3], ids=lambda case: case.name)
def test_kappa_is_that_of_the_other_studies(case):
    table = pd.DataFrame(
        {
            "aspect": [case.aspect],
            "amplitude_g": [case.onsets / case.aspect],
            "omega_over_p": [case.omega_over_p],
            "half_cycles": [case.half_cycles],
        }
    )
    expected = with_conditioning(table)["kappa"][0]
    assert condition_number(case, "amplitude") == pytest.approx(expected, rel=1e-9)
    up, down = (exact_change(case, "amplitude", sign * 1e-6) for sign in (1, -1))
    assert (up - down) / 2e-6 == pytest.approx(expected, rel=1e-3)
    assert condition_number(case, "friction") == 0.0


def test_a_wider_block_keeps_its_height_and_its_pulse():
    wider = perturbed(CASE, "width", 1e-3)
    assert wider.block.width == pytest.approx(1.001 * CASE.block.width, rel=1e-14)
    assert wider.block.height == pytest.approx(CASE.block.height, rel=1e-14)
    assert wider.motion.amplitude == pytest.approx(CASE.motion.amplitude, rel=1e-14)
    assert wider.motion.omega == pytest.approx(CASE.motion.omega, rel=1e-14)


def test_growth_of_the_exact_solution_is_its_kappa():
    jobs = sensitivity_jobs(["exact"], True)
    pair = [
        {**job.labels, "source": "exact", **study.reduce(job, ask(job, job.asked))}
        for job in jobs
        if job.labels["quantity"] == "amplitude" and job.labels["delta"] in (0.0, 1e-6)
    ]
    moved = with_growth(pd.DataFrame(pair))
    # the second derivative of the peak is the error, some κ times the perturbation
    assert moved["growth_over_kappa"].iloc[1] == pytest.approx(1.0, rel=1e-4)
    assert moved["change_over_exact"].iloc[1] == pytest.approx(1.0, rel=1e-9)
    assert math.isnan(moved["growth"].iloc[0])
    # tables that were read back and reduced again stay as they are
    pd.testing.assert_frame_equal(with_growth(moved), moved)


@pytest.mark.parametrize("source", study.METHODS)
def test_every_method_has_a_row_and_so_has_one_that_was_given_up(source):
    job = job_of("ω/p 10", source)
    answered = study.reduce(job, study.ask_for_table(job, resolve(source), time_limit_s=60.0))
    given_up = study.reduce(job, Response.failure("no result within the time limit"))
    assert answered["outcome"] == "rocked"
    assert answered["verdict"] in [verdict.value for verdict in Verdict]
    assert given_up["verdict"] == Verdict.FAILED.value
    assert list(given_up) == list(answered)
    # what nobody tunes a tuned method away from
    if ":" not in source:
        assert answered["verdict"] == "good"


def test_a_search_that_was_given_up_is_a_row_too():
    job = search_job(PROBLEMS[0], "rk4", math.nan, True)
    row = study.reduce(job, Response.failure("no result within the time limit"))
    assert row["outcome"] == "failed"
    assert math.isnan(row["largest_stable"])


def test_every_verdict_has_a_mark_of_its_own():
    assert set(MARKS) == set(Verdict)
    for looks in ({m.symbol for m in MARKS.values()}, {m.colour for m in MARKS.values()}):
        assert len(looks) == len(Verdict)


def test_only_a_source_without_any_result_is_speechless():
    rows = [
        {"source": "a", "outcome": "failed"},
        {"source": "a", "outcome": "rocked"},
        {"source": "b", "outcome": "failed"},
    ]
    assert study.without_result(rows) == rows[2:]


def test_a_folder_goes_on_with_another_source(tmp_path):
    fill(STUDY, study.plan(["exact"], True, 60.0), tmp_path, Running(jobs=1))
    kept = (tmp_path / "journal.jsonl").read_text().splitlines()
    fill(STUDY, study.plan(["exact", "housner"], True, 60.0), tmp_path, Running(jobs=1))
    assert (tmp_path / "journal.jsonl").read_text().splitlines()[: len(kept)] == kept
    study.report(tmp_path)
    matrix = pd.read_csv(tmp_path / "stability.csv")
    assert set(matrix.loc[matrix["source"] == "exact", "verdict"]) == {"good"}
    assert set(matrix.loc[matrix["source"] == "housner", "verdict"]) != {"good"}
