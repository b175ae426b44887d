"""Advice: the cheapest published setting that keeps an error, and the library's words for it."""

import math
import re
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from commanding import refused
from given import BLOCK

from analytic import Outcome, simulate
from engines import ENGINES
from engines.declaration import AT_REST
from studies.__main__ import run
from studies.advise import study
from studies.advise.choice import TARGETS, advice, cheapest
from studies.advise.evidence import (
    RANDOM,
    TABLES,
    aspects,
    counted,
    declared_step,
    judged,
    published_engines,
    random_runs,
    settings,
)
from studies.advise.steps import off, worth_trying
from studies.advise.words import literal
from studies.cases.drawn import draw
from studies.old.journal import PROVENANCE
from studies.old.provenance import seal
from studies.old.tables import table_in
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.published import PUBLISHED

CORE = [name for name, engine in ENGINES.items() if engine.core]


@pytest.fixture(scope="module")
def known():
    return settings(PUBLISHED, CORE)


def test_the_published_advice_follows_from_the_published_tables():
    kept = table_in(PUBLISHED / "advice", "advice")
    engines = tuple(kept["engine"].unique())
    today = advice(PUBLISHED, engines, TARGETS, BLOCK)
    pd.testing.assert_frame_equal(today, kept, check_dtype=False, rtol=1e-12)


def test_a_setting_stands_for_all_the_cases_on_which_it_was_asked(known):
    ladder, paper = 24, 960
    landing = known[(known["engine"] == "mujoco") & (known["preset"] == "landing")]
    by_step = landing.set_index("value")["cases"]
    assert by_step[0.005] == ladder + paper
    assert by_step[0.05] == ladder
    naive = known[(known["engine"] == "pybullet") & (known["preset"] == "naive")]
    own = naive[naive["value"].isna()].iloc[0]
    assert own["cases"] == paper
    assert own["max_error"] == math.inf  # 11 of its outcomes are wrong


@pytest.mark.parametrize("target", [1.0, 0.1, 1e-2, 1e-3, 1e-4, 1e-9])
def test_what_is_advised_keeps_the_error_with_every_finer_step_and_nothing_cheaper_does(target):
    known = counted(settings(PUBLISHED, list(ENGINES)), random_runs(PUBLISHED), target)
    engines = list(known["engine"].unique())
    for row in advice(PUBLISHED, engines, [target], BLOCK).itertuples():
        preset = ENGINES[row.engine].preset(row.preset)
        mine = known[(known["engine"] == row.engine) & (known["preset"] == row.preset)]
        finest = mine["value"].fillna(declared_step(preset))
        misses = (mine["max_error"] > target) | (mine["random_calm_off"] > 0)
        reached = finest[misses].min()  # nan where none misses: nothing is below
        kept = mine[~(finest >= reached)]
        if row.message:
            assert row.message.startswith("nothing does")
            assert math.isnan(row.wall_s)
            assert kept.empty
            continue
        assert row.max_error <= target
        assert row.wall_s == kept["wall_s"].min()
        own = math.nan if preset.accuracy_knob else preset.step_s if math.isnan(row.value) else None
        assert row.dt_s == pytest.approx(own or row.value / BLOCK.p, nan_ok=True)


def line(value, wall_s, error, calm_off=0, off=0):
    random = {"random_cases": 50, "random_off": off or calm_off, "random_calm_off": calm_off}
    return {"value": value, "wall_s": wall_s, "cases": 24, "max_error": error, **random}


def test_a_lucky_step_is_not_advised():
    lucky = [line(5e-3, 0.02, 4e-3), line(2e-3, 0.09, math.inf), line(1e-3, 0.1, 6e-3)]
    assert cheapest(pd.DataFrame(lucky), 1e-2)["value"] == 1e-3
    assert cheapest(pd.DataFrame([*lucky, line(5e-4, 0.3, 2e-2)]), 1e-2) is None
    assert cheapest(pd.DataFrame([*lucky, line(5e-4, 0.3, 2e-3)]), 1e-2)["value"] == 1e-3


def test_random_cases_with_a_small_kappa_count_at_the_very_step():
    steps = [line(5e-3, 0.02, 4e-3, off=3), line(2e-3, 0.09, 3e-3, off=2)]
    assert cheapest(pd.DataFrame(steps), 1e-2)["value"] == 5e-3
    steps[1] = line(2e-3, 0.09, 3e-3, calm_off=2)
    assert cheapest(pd.DataFrame(steps), 1e-2) is None
    steps[1] = line(2e-3, 0.09, 3e-3)
    steps[0] = line(5e-3, 0.02, 4e-3, calm_off=1)
    assert cheapest(pd.DataFrame(steps), 1e-2)["value"] == 2e-3


@pytest.fixture
def tried(tmp_path):
    """The published tables, and random cases of MuJoCo that are off at some steps."""
    for name in (*TABLES, RANDOM):
        (tmp_path / name).parent.mkdir(exist_ok=True)
        for path in (Path(name), Path(name).with_name(PROVENANCE)):
            (tmp_path / path).write_bytes((PUBLISHED / path).read_bytes())
    offs = {0.05: (2.0, 0.03), 0.02: (50.0, 0.03), 0.01: (1.0, 1e-3)}
    rows = [
        {"engine": "mujoco", "preset": "landing", "value": step, "case": case}
        | {"condition": condition if case == 7 else 1.0, "error": error if case == 7 else 1e-5}
        for step, (condition, error) in offs.items()
        for case in range(40)
    ]
    pd.DataFrame(rows).to_csv(tmp_path / RANDOM, index=False)
    seal((tmp_path / RANDOM).parent)
    return tmp_path


def test_what_is_off_is_counted_at_the_step_that_is_advised(tried, capsys):
    lines = advice(tried, ["mujoco"], [0.01], BLOCK).set_index("preset")
    landing = lines.loc["landing"]
    assert landing["value"] == 0.02  # at 0.05 a case with a small κ is off
    assert landing[["random_cases", "random_off", "random_calm_off"]].tolist() == [40, 1, 0]
    assert landing["extreme_cases"] == 0  # these were run with the preset as it is declared
    assert run(["advise", "--engine", "mujoco", "--error", "0.01", "--published", str(tried)]) == 0
    told = capsys.readouterr().out
    line = next(line for line in told.splitlines() if "mujoco  landing" in line).split()
    assert line[-5:-3] == ["1", "40"]
    assert RANDOM in " ".join(told.split())


def test_a_target_that_only_a_lucky_step_keeps_says_what_misses(tried):
    rows = pd.read_csv(tried / RANDOM)
    finest = rows[rows["value"] == 0.01].assign(value=2e-4, condition=1.0, error=0.2)
    pd.concat([rows, finest]).to_csv(tried / RANDOM, index=False)
    lines = advice(tried, ["mujoco"], [0.1], BLOCK).set_index("preset")
    assert lines.loc["landing", "message"] == (
        "nothing does: p dt = 0.0005 would, but all 40 random cases are off at p dt = 0.0002 "
        "(40 of them with κ < 10)"
    )


def test_random_cases_are_run_at_every_step_worth_it(tmp_path, capsys):
    out = tmp_path / "steps"
    asked = ["steps", "--engines", "mujoco", "--cases", "2", "--jobs", "1", "--out", str(out)]
    assert run(asked) == 0
    table = pd.read_csv(out / "random.csv")
    worth = worth_trying(settings(PUBLISHED, ["mujoco"]))
    assert len(worth) > 5
    assert set(zip(table["preset"], table["value"], strict=True)) == set(
        zip(worth["preset"], worth["value"], strict=True)
    )
    assert (table.groupby(["preset", "value"])["case"].nunique() == 2).all()
    told = capsys.readouterr().out
    assert "2 random cases at a setting" in " ".join(told.split())
    worse = table["error"] > 1e-3
    calm = worse & (table["condition"] < WELL_CONDITIONED)
    for name, wrong in (("random_off", worse), ("random_calm_off", calm)):
        shown = off(table, name).set_index("preset")
        assert shown["0.001"].to_dict() == wrong.groupby(table["preset"]).sum().to_dict()
        assert shown["random_cases"].to_dict() == table.groupby("preset").size().to_dict()
    assert told == (out / "findings.txt").read_text()


def test_another_outcome_is_off_and_an_overturning_near_the_edge_is_no_calm_case():
    case = next(case for case in draw(1) if simulate(case.block, case.motion).peak_ratio < 0.5)
    low, high = (
        next(
            replace(case, amplitude_g=case.amplitude_g * factor)
            for factor in np.geomspace(1.0, 50.0, 4000)
            if factor > above and fate(case, factor) is Outcome.OVERTURNED
        )
        for above in (1.0, 30.0)
    )
    rows = [
        {"engine": "mujoco", "preset": "landing", "value": 0.01, **asdict(posed)}
        | {"outcome": outcome, "peak_ratio": 0.3, "source": "mujoco"}
        for posed in (low, high)
        for outcome in ("rocked", "overturned")
    ]
    found = judged(rows)
    assert found["error"].tolist() == [math.inf, 0.0, math.inf, 0.0]
    assert found["condition"].tolist() == [math.inf, math.inf, 1.0, 1.0]


def fate(case, factor):
    posed = replace(case, amplitude_g=case.amplitude_g * factor)
    return simulate(posed.block, posed.motion).outcome


def test_an_engine_that_was_not_published_is_a_line_that_says_so():
    lines = advice(PUBLISHED, ["moreau"], [0.1], BLOCK)
    assert set(lines["message"]) == {"nothing does: not in the published tables"}
    assert not lines["cheapest"].any()


@pytest.mark.parametrize("engine", CORE)
def test_settings_are_written_out_for_the_block_and_the_step(engine):
    declared = ENGINES[engine]
    text = literal(declared, declared.preset("fixed"), BLOCK, 2e-4, 0.8)
    assert repr(2e-4 / BLOCK.p) in text
    assert "375.0" in text or "0.25" in text  # its mass [kg], or half its width [m]
    landing = literal(declared, declared.best, BLOCK, 0.02, 0.8)
    assert "by no setting of the library: steps that land on impacts" in landing


def test_settings_of_an_engine_without_words_are_this_project_s():
    moreau = ENGINES["moreau"]
    text = literal(moreau, moreau.best, BLOCK, 0.02, 0.8)
    assert "in this project's names" in text and "friction=0.8" in text


def test_the_command_says_what_to_set_and_from_which_tables(capsys):
    assert run(["advise", "--error", "1e-2", "--engine", "mujoco", "--width", "1"]) == 0
    text = capsys.readouterr().out
    assert "For a block of 1 x 1.5 m" in text
    assert 'solref="-' in text
    assert "nothing does" in text and "rocking advise --engine" not in text
    assert all(name in " ".join(text.split()) for name in TABLES)


@pytest.mark.parametrize("asked", [[], ["--friction", "0.8"], ["--friction", "10"]])
def test_impratio_is_written_out_with_the_friction_that_it_belongs_to(asked, capsys):
    """Its root is at most 10 times the friction: beyond, the solver errs."""
    friction = float(asked[-1]) if asked else 0.8
    assert run(["advise", "--dt", "0.002", "--engine", "mujoco", *asked]) == 0
    text = capsys.readouterr().out
    heads, ratios = (
        re.findall(words, text) for words in (r"DT = \S+ s, (.*)", r'impratio="(.*?)"')
    )
    assert set(heads) == {f"friction {friction:g}"}
    assert set(re.findall(r' friction="(\S+)', text)) == {f"{friction}"}
    assert max(map(float, ratios)) == pytest.approx((10.0 * friction) ** 2)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--error", "0"], "--error is '0'; it must be a positive finite number"),
        (["--error", "0.1", "0.1"], "--error names 0.1 twice"),
        (["--engine", "havok"], "--engines is 'havok'; it must be among"),
        (["--published", "tests"], "--published is 'tests'; it must hold precision/work-precision"),
    ],
)
def test_refusals(arguments, words, capsys):
    refused(capsys, ["advise", *arguments], words)


def test_advice_is_kept_drawn_and_told(tmp_path, capsys):
    out = tmp_path / "advice"
    assert run(["advise", "--engines", *CORE, "--out", str(out)]) == 0
    assert capsys.readouterr().out == (out / "findings.txt").read_text()
    assert (out / "advice.png").stat().st_size > 7_000
    assert study.STUDY.finding(out).startswith("An error of 10 % ")
    assert Path(out / "provenance.json").is_file()


def test_each_preset_of_each_engine_that_was_published_has_a_row(capsys):
    assert run(["advise"]) == 0
    told = capsys.readouterr().out
    engines = published_engines(PUBLISHED)
    assert {*CORE, "drake", "newton"} <= set(engines)
    lines = advice(PUBLISHED, engines, TARGETS, BLOCK)
    uses = {(name, use.name) for name in engines for use in ENGINES[name].presets}
    uses = {use for use in uses if use[1] != AT_REST}  # no use of its own
    for _, group in lines.groupby("target"):
        assert set(zip(group["engine"], group["preset"], strict=True)) == uses
        assert len(group) == len(uses)
    kept, missed, *_ = told.partition("\n\n")[2].split("\n\n")
    found = lines["message"] == ""
    assert len(kept.splitlines()) == 3 + found.sum()
    assert len(missed.splitlines()) == 2 + len(lines[~found].drop_duplicates(["engine", "preset"]))
    assert told.count("rocking advise --engine ") == 1 and "solref" not in told


def test_a_dial_is_no_step(capsys):
    lines = advice(PUBLISHED, ["drake"], [0.1, 1e-2], BLOCK).set_index(["target", "preset"])
    loose, close = (lines.loc[(target, "error-controlled")] for target in (0.1, 1e-2))
    drake = ENGINES["drake"].preset("error-controlled")
    assert {loose["value"], close["value"]} <= set(drake.accuracy_knob[1])
    assert loose["value"] > close["value"]
    assert math.isnan(loose["dt_s"])
    assert loose["cheapest"]
    assert run(["advise", "--engine", "drake", "--error", "0.01"]) == 0
    told = capsys.readouterr().out
    assert f"accuracy = {close['value']:g}" in told
    own = float(close["value"]) * BLOCK.alpha * max(1.0, BLOCK.R)
    assert f"integrator.set_target_accuracy({own!r})" in told
    assert re.search(r"AddContactMaterial\(.*point_stiffness=", told)
    assert "CoulombFriction(0.8, 0.8)" in told


def test_a_block_of_no_published_shape_is_told_so(capsys):
    asked = ["advise", "--engine", "mujoco", "--error", "0.01"]
    assert run(asked) == 0
    assert "Its H/B" not in capsys.readouterr().out
    assert run([*asked, "--width", "2", "--height", "1"]) == 0
    words = f"Its H/B is 0.5, and that of the published cases from {aspects(PUBLISHED)[0]:.3g} to"
    assert words in capsys.readouterr().out
