"""Estimates: an answer beside the one at half the step, and what the difference bounds."""

import json
import math

import numpy as np
import pandas as pd
import pytest
from given import BLOCK, PULSE

from engines import ENGINES
from studies import respond
from studies.__main__ import run
from studies.estimate import study
from studies.old.jobs import Job
from studies.measures.halving import (
    ELSEWHERE,
    FACTORS,
    MOST_TRUSTED,
    NO_BOUND,
    OF_A_PEAK,
    OF_BLOCKS,
    Trust,
    estimate,
    halved,
    published_trust,
    step_of,
)

CORE = [name for name, engine in ENGINES.items() if engine.core]
USES = [f"{name}:{use.name}" for name in CORE for use in ENGINES[name].presets]


def job(source, **options):
    return Job(labels={}, block=BLOCK, motion=PULSE, source=source, options=options)


@pytest.mark.parametrize("source", USES)
def test_half_the_step_takes_about_twice_the_steps(source):
    asked = job(source) if source.endswith("naive") else job(source, step=0.02)
    finer = halved(asked)
    assert finer.options["step"] == 0.5 * step_of(asked)
    whole, half = (respond(j.source, BLOCK, PULSE, **j.options).steps for j in (asked, finer))
    # landing steps spend some on impacts whatever the step is
    assert 1.4 < half / whole < 2.2


def test_the_step_of_a_job_is_that_of_its_preset_or_its_own():
    naive = ENGINES["mujoco"].preset("naive")
    assert step_of(job("mujoco:naive")) == pytest.approx(naive.step_s * BLOCK.p, rel=1e-15)
    assert step_of(job("mujoco", accuracy="tight")) == 1.0 / 800
    assert step_of(job("mujoco", accuracy="tight", step=0.01)) == 0.01
    assert "accuracy" not in halved(job("mujoco", accuracy="tight")).options


@pytest.mark.parametrize("source", ["exact", "rk4", "dop853"])
def test_what_has_no_steps_of_an_engine_is_not_halved(source):
    assert halved(job(source)) is None


@pytest.mark.parametrize(
    ("whole", "half", "found"),
    [
        (("rocked", 0.303), ("rocked", 0.3), 0.01),
        (("rocked", 0.297), ("rocked", 0.3), 0.01),
        (("rocked", 0.3), ("overturned", math.inf), math.inf),
        (("overturned", math.inf), ("overturned", math.inf), 0.0),
        (("at rest", 0.0), ("at rest", 0.0), 0.0),
        (("failed", math.nan), ("rocked", 0.3), math.nan),
        (("rocked", 0.3), ("failed", math.nan), math.nan),
    ],
)
def test_an_estimate_is_the_difference_of_two_runs(whole, half, found):
    rows = [dict(zip(("outcome", "peak_ratio"), pair, strict=True)) for pair in (whole, half)]
    assert estimate(*rows) == pytest.approx(found, nan_ok=True)


def random_rows(errors, differences, use=study.CALIBRATE):
    """Return rows of one case each whose errors and estimates are given."""
    exact = respond("exact", BLOCK, PULSE).peak_ratio
    place = {"aspect": 3.0, "half_cycles": 2, "amplitude_g": PULSE.amplitude / BLOCK.gravity}
    rows = []
    for case, (error, difference) in enumerate(zip(errors, differences, strict=True)):
        peak = exact * (1.0 + error)
        for half, ratio in enumerate((peak, peak / (1.0 + difference))):
            answer = {"outcome": "rocked", "peak_ratio": ratio, "half": half, "set": use}
            rows.append({"case": case, "source": "mujoco:naive", **place, **answer})
    return pd.DataFrame(rows).assign(omega_over_p=PULSE.omega / BLOCK.p)


def test_factors_are_the_quantiles_of_error_over_estimate():
    # errors of 1 to 20 estimates of a thousandth
    lines = study.beside_errors(random_rows([1e-3 * n for n in range(1, 21)], [1e-3] * 20))
    assert lines["over"].to_numpy() == pytest.approx(range(1, 21), rel=1e-6)
    line = study.factors(lines).iloc[0]
    assert line[["factor_50", "factor_95", "factor_all"]].to_list() == pytest.approx([10, 19, 20])
    assert line[["within_3", "within_10"]].to_list() == pytest.approx([0.15, 0.5], abs=0.051)


def test_the_cases_that_test_a_factor_are_not_those_that_gave_it():
    drawn = [*study.both_sets(12, 8, seed=5)]
    uses = [use for use, _ in drawn]
    assert (uses.count(study.CALIBRATE), uses.count(study.TEST)) == (12, 8)
    assert len({(case.aspect, case.width_m, case.amplitude_g) for _, case in drawn}) == 20
    outcomes = {respond("exact", case.block, case.motion).outcome.value for _, case in drawn}
    assert outcomes == {"rocked"}


@pytest.mark.parametrize(
    ("count", "last"), [(0, math.inf), (71, math.inf), (72, 72.0), (300, 293.0)]
)
def test_the_upper_end_of_a_factor_is_one_of_the_values_or_there_is_none(count, last):
    """All of 71 values are below the 95 % quantile with 0.95^71 = 0.026 > 2.5 %."""
    assert study.interval(pd.Series(np.arange(1.0, count + 1.0)), 0.95)[1] == last


@pytest.mark.slow
def test_the_interval_holds_the_factor_as_often_as_it_says():
    """Errors over estimates with a heavy tail, drawn 2000 times: 95 % or more, within 3 sigma."""
    generator = np.random.default_rng(1)
    for count in (100, 300):
        ends = [study.interval(pd.Series(generator.pareto(1.0, count)), 0.95) for _ in range(2000)]
        held = np.mean([low <= 19.0 < high for low, high in ends])
        assert 0.935 < held < 0.99
        assert np.mean([high > 19.0 for _, high in ends]) > 0.965


def test_a_factor_is_tried_on_other_cases_than_those_that_gave_it():
    found = random_rows([1e-3 * n for n in range(1, 101)], [1e-3] * 100)
    other = random_rows([0.02, 0.2], [1e-3] * 2, use=study.TEST)
    line = study.factors(study.beside_errors(pd.concat([found, other]))).iloc[0]
    assert line["factor_95_low"] < line["factor_95"] == pytest.approx(95, rel=1e-6)
    assert line["factor_95_high"] > 95
    assert (line["cases"], line["tested"], line["bounded"]) == (100, 2, 1)
    alone = study.factors(study.beside_errors(found)).iloc[0]
    assert alone.drop(["tested", "bounded"]).equals(line.drop(["tested", "bounded"]))


def test_above_thirty_estimates_there_is_no_bound():
    table = pd.DataFrame(
        {
            "source": ["mujoco", "box2d", "dart"],
            "factor_95_high": [1.6, 48.0, math.inf],
            "tested": [100, 100, 100],
            "bounded": [96, 99, 100],
        }
    )
    claim = study.finding(table)
    assert "times 1.6, bounds 95 % of the errors with 1 of 3 presets (96 of 100 on" in claim
    assert claim.endswith(f"; it gives {NO_BOUND} with box2d and dart.")
    assert study.finding(table[1:]).startswith("The difference from half the step gives no bound")
    assert MOST_TRUSTED == 30.0
    assert Trust(29.0, 300).holds and not Trust(31.0, 300).holds


def test_an_error_that_is_none_needs_no_estimate():
    assert study.beside_errors(random_rows([1e-11], [0.0]))["over"].to_list() == [0.0]
    assert study.beside_errors(random_rows([1e-3], [0.0]))["over"].to_list() == [math.inf]


def test_published_factors_say_whose_estimates_are_trusted():
    table = pd.read_csv(FACTORS).set_index("source")
    assert set(table.index) >= set(CORE)
    for source in table.index:
        trust = published_trust(source)
        assert trust.factor == table.loc[source, "factor_95_high"]
        assert trust.holds == (trust.warning() == "")
    # a preset by its name is the plain engine
    assert published_trust("mujoco:landing") == published_trust("mujoco")
    assert published_trust("moreau") is None
    assert Trust(31.0, 90).warning() == (
        f"{NO_BOUND}: from 90 random cases it may take 31 estimates to bound 95 % of the errors"
    )
    assert f"{NO_BOUND}: 7 random cases tell no factor" in Trust(math.inf, 7).warning()


def test_published_factors_follow_from_the_published_rows():
    kept = pd.read_csv(FACTORS)
    lines = pd.read_csv(FACTORS.parent / "estimates.csv", keep_default_na=False, na_values=["nan"])
    pd.testing.assert_frame_equal(study.factors(lines), kept, check_dtype=False, rtol=1e-12)


def test_cases_that_test_come_first_each_with_its_half(tmp_path):
    few = ["estimate", "--seed", "3", "--sources", "mujoco:naive", "--jobs", "1", "--tests", "2"]
    assert run([*few, "--cases", "4", "--out", str(tmp_path)]) == 0
    rows = pd.read_csv(tmp_path / "estimate.csv")
    assert list(rows["half"]) == [0, 1] * 6
    assert list(rows["set"]) == [study.TEST] * 4 + [study.CALIBRATE] * 8


def test_cases_that_do_not_rock_calibrate_nothing():
    overturned = random_rows([0.0], [0.0]).assign(outcome="overturned", peak_ratio=math.inf)
    (line,) = study.factors(study.beside_errors(overturned)).to_dict("records")
    assert line["survivors"] == 0
    assert math.isnan(line["factor_95"]) and line["factor_95_high"] == math.inf


def test_pairs_are_asked_at_another_step(tmp_path):
    few = ["estimate", "--seed", "3", "--sources", "mujoco", "--jobs", "1", "--cases", "1"]
    assert run([*few, "--tests", "1", "--step", "0.02", "--out", str(tmp_path)]) == 0
    rows = pd.read_csv(tmp_path / "estimate.csv")
    rows = rows[rows["set"] == study.TEST].set_index(["case", "half"])
    ((_, case),) = study.both_sets(0, 1, 3)
    for half, step in ((0, 0.02), (1, 0.01)):
        answer = respond("mujoco", case.block, case.motion, step=step)
        assert rows.loc[(0, half), "peak_ratio"] == pytest.approx(answer.peak_ratio, rel=1e-12)
        assert rows.loc[(0, half), "steps"] == answer.steps


def test_frames_are_asked_at_half_their_steps_too(tmp_path, capsys):
    asked = ["--scene", "frame", "--cases", "2", "--tests", "1", "--sources", "mujoco:landing"]
    assert run(["estimate", "--out", str(tmp_path), *asked, "--jobs", "1"]) == 0
    lines = pd.read_csv(tmp_path / "estimates.csv")
    assert set(lines["set"]) == {study.TEST, study.CALIBRATE}
    # of second order: half the step has a fourth of the error, the difference is three fourths
    assert lines["over"].to_numpy() == pytest.approx([4.0 / 3.0] * 3, rel=0.1)


def test_a_slide_s_estimate_is_of_its_slips(capsys):
    asked = ["--scene", "slide", "--friction", "0.2", "--width", "1", "--height", "0.5"]
    pulse = ["--amplitude", "0.4", "--omega", "6.2832", "--sources", "pymunk:fixed", "mujoco:fixed"]
    assert run(["compare", *asked, *pulse, "--estimate", "--json"]) == 0
    for line in map(json.loads, capsys.readouterr().out.splitlines()):
        assert line["error"] < 2.5 * line["estimate"] < 5.0 * line["error"]
        assert line["bound"] is None
        assert OF_A_PEAK in line["message"]


def test_a_frame_s_estimate_has_no_bound_from_blocks(capsys):
    frame = ["--scene", "frame", "--load", "2", "--width", "0.5", "--height", "1.5"]
    pulse = ["--amplitude", "0.4", "--omega", "6.2832", "--duration", "1.6"]
    assert run(["compare", *frame, *pulse, "--sources", "mujoco", "--estimate", "--json"]) == 0
    (line,) = map(json.loads, capsys.readouterr().out.splitlines())
    assert 0.0 < line["estimate"] < 1e-5
    assert (line["bound"], OF_BLOCKS in line["message"]) == (None, True)


def test_a_comparison_carries_estimates(capsys):
    case = ["compare", "--width", "0.5", "--height", "1.5", "--amplitude", "0.4"]
    asked = [*case, "--omega", "6.2832", "--step", "0.02", "--jobs", "1", "--estimate"]
    assert run([*asked, "--sources", "exact", "mujoco"]) == 0
    table = capsys.readouterr().out
    assert "estimate bound 95 %" in table
    assert " +0 " in table  # how far the exact solution is off itself
    whole, half = (
        respond("mujoco", BLOCK, PULSE, step=step, duration=PULSE.duration + 8.0 / BLOCK.p)
        for step in (0.02, 0.01)
    )
    difference = abs(whole.peak_ratio / half.peak_ratio - 1.0)
    assert f"{difference:.1e}" in table
    assert f"{difference * published_trust('mujoco').factor:.1e}" in table
    # the step is not the preset's own
    assert ELSEWHERE in table
    own = [word for word in asked if word not in ("--step", "0.02")]
    assert run([*own, "--sources", "mujoco"]) == 0
    assert ELSEWHERE not in capsys.readouterr().out
