"""Advice: the cheapest published setting that keeps an error, and the library's words for it."""

import math
import tomllib
from pathlib import Path

import pandas as pd
import pytest

from analytic import RigidBlock
from engines import ENGINES
from studies.__main__ import run
from studies.advise import study
from studies.advise.choice import advice, cheapest
from studies.advise.evidence import TABLES, declared_step, settings
from studies.advise.words import literal
from studies.measures.halving import FACTORS
from studies.measures.published import PUBLISHED
from studies.symptoms.lines import LADDER, VARIANTS

BLOCK = RigidBlock(width=0.5, height=1.5)
CORE = [name for name, engine in ENGINES.items() if engine.core]


@pytest.fixture(scope="module")
def known():
    return settings(PUBLISHED, CORE)


def test_the_published_advice_follows_from_the_published_tables():
    kept = study._read(PUBLISHED / "advice")
    engines = tuple(kept["engine"].unique())
    today = advice(PUBLISHED, engines, study.TARGETS, BLOCK)
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
def test_what_is_advised_keeps_the_error_and_nothing_cheaper_does(known, target):
    for row in advice(PUBLISHED, CORE, [target], BLOCK).itertuples():
        preset = ENGINES[row.engine].preset(row.preset)
        mine = known[(known["engine"] == row.engine) & (known["preset"] == row.preset)]
        if row.message:
            assert row.message.startswith("nothing does")
            assert math.isnan(row.wall_s)
            continue
        assert row.max_error <= target
        cheaper = mine[mine["wall_s"] < row.wall_s]
        kept = cheaper[cheaper["max_error"] <= target]
        finest = declared_step(preset)
        assert (kept["value"] > finest).all() or kept.empty
        assert row.dt_s == pytest.approx(
            preset.step_s if math.isnan(row.value) else row.value / BLOCK.p
        )


def line(value, wall_s, cases, error):
    return {"value": value, "wall_s": wall_s, "cases": cases, "max_error": error}


def test_a_coarse_step_is_not_trusted_where_a_finer_one_misses_on_more_cases():
    fixed = ENGINES["mujoco"].preset("fixed")
    few = [line(1e-3, 0.04, 24, 5e-3), line(1e-4, 0.4, 24, 4e-3)]
    assert cheapest(pd.DataFrame(few), fixed, 1e-2)["value"] == 1e-3
    many = pd.DataFrame([*few, line(fixed.step, 0.2, 960, 0.02)])
    assert cheapest(many, fixed, 1e-2)["value"] == 1e-4
    assert cheapest(many, fixed, 1e-3) is None


def test_an_engine_that_was_not_published_is_a_line_that_says_so():
    lines = advice(PUBLISHED, ["moreau"], [0.1], BLOCK)
    assert set(lines["message"]) == {"nothing does: not in the published tables"}
    assert not lines["cheapest"].any()


@pytest.mark.parametrize("engine", CORE)
def test_settings_are_written_out_for_the_block_and_the_step(engine):
    declared = ENGINES[engine]
    text = literal(declared, declared.preset("fixed"), BLOCK, 2e-4)
    assert repr(2e-4 / BLOCK.p) in text
    assert "375.0" in text or "0.25" in text  # its mass [kg], or half its width [m]
    landing = literal(declared, declared.best, BLOCK, 0.02)
    assert "by no setting of the library: steps that land on impacts" in landing


def test_settings_of_an_engine_without_words_are_this_project_s():
    moreau = ENGINES["moreau"]
    text = literal(moreau, moreau.best, BLOCK, 0.02)
    assert "in this project's names" in text and "friction=10.0" in text


def test_the_command_says_what_to_set_and_from_which_tables(capsys):
    assert run(["advise", "--error", "1e-2", "--engine", "mujoco", "--width", "1"]) == 0
    text = capsys.readouterr().out
    assert "For a block of 1 x 1.5 m" in text
    assert 'solref="-' in text
    assert "nothing does" in text
    assert all(name in " ".join(text.split()) for name in TABLES)


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
    assert run(["advise", *arguments]) == 2
    told = capsys.readouterr().err
    assert words in told
    assert len(told.strip().splitlines()) == 1


def test_advice_is_kept_drawn_and_told(tmp_path, capsys):
    out = tmp_path / "advice"
    assert run(["advise", "--engines", *CORE, "--out", str(out)]) == 0
    assert capsys.readouterr().out == (out / "findings.txt").read_text()
    assert (out / "advice.png").stat().st_size > 20_000
    assert study.headline(out).startswith("Errors are kept cheapest: 10 % ")
    assert "None of these is kept by naive (pybullet, mujoco)." in study.paragraph(out)
    assert Path(out / "provenance.json").is_file()


def test_the_tables_that_are_read_come_with_an_installation():
    project = tomllib.loads((PUBLISHED.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
    packed = set(project["tool"]["setuptools"]["package-data"]["studies"])
    beside = f"{TABLES[0].partition('/')[0]}/provenance.json"
    read = [*TABLES, VARIANTS, LADDER, str(FACTORS.relative_to(PUBLISHED)), beside]
    assert {f"published/{name}" for name in read} == packed
    assert all((PUBLISHED.parent / name).is_file() for name in packed)


@pytest.fixture
def wider(tmp_path):
    """The published tables, with ladders of further engines that are made up of MuJoCo's."""
    for name in TABLES:
        (tmp_path / name).parent.mkdir(exist_ok=True)
        table = pd.read_csv(PUBLISHED / name, keep_default_na=False, na_values=["nan"])
        # what is published of these engines themselves would tell more than what is made up
        asked = table["source" if "source" in table else "method"]
        mine = asked.str.startswith(MADE_UP)
        table[~mine].to_csv(tmp_path / name, index=False, na_rep="nan")
    ladder = pd.read_csv(tmp_path / TABLES[0])
    fixed, landing = (ladder[ladder["method"] == f"mujoco {name}"] for name in ("fixed", "landing"))
    steps = sorted(landing["value"].unique(), reverse=True)
    dial = dict(zip(steps, DIAL, strict=False))
    own = landing[landing["value"].isin(list(dial))].assign(method="drake error-controlled")
    rows = [fixed.assign(method=f"{name} fixed") for name in MADE_UP]
    whole = pd.concat([ladder, *rows, own.assign(value=own["value"].map(dial))])
    whole.to_csv(tmp_path / TABLES[0], index=False, na_rep="nan")
    return tmp_path


MADE_UP = ("drake", "newton", "dart")

DIAL = ENGINES["drake"].preset("error-controlled").dial[1]


def test_each_preset_of_each_engine_that_was_published_has_a_row(wider, capsys):
    assert run(["advise", "--published", str(wider)]) == 0
    told = capsys.readouterr().out
    table = told.partition("\n\n")[0].splitlines()
    for target in study.TARGETS:
        for name in (*CORE, "drake", "newton", "dart"):
            for preset in ENGINES[name].presets:
                head = f"{target:g} {name} {preset.name} "
                assert sum(" ".join(line.split()).startswith(head) for line in table) == 1


def test_a_dial_is_no_step(wider, capsys):
    lines = advice(wider, ["drake"], [1e-2, 1e-4], BLOCK).set_index(["target", "preset"])
    loose, close = (lines.loc[(target, "error-controlled")] for target in (1e-2, 1e-4))
    assert DIAL[0] == loose["value"] > close["value"] > DIAL[-1]
    assert math.isnan(loose["dt_s"])
    assert loose["cheapest"]
    assert run(["advise", "--published", str(wider), "--engine", "drake", "--error", "0.01"]) == 0
    told = capsys.readouterr().out
    assert f"accuracy = {DIAL[0]:g}" in told
    own = DIAL[0] * BLOCK.alpha * max(1.0, BLOCK.R)
    assert f"integrator.set_target_accuracy({own!r})" in told
    assert "AddContactMaterial(point_stiffness=" in told
    rough = float(ENGINES["drake"].preset("error-controlled").settings.friction)
    assert f"CoulombFriction({rough!r}, {rough!r})" in told


def test_a_block_of_no_published_shape_is_told_so(capsys):
    asked = ["advise", "--engine", "mujoco", "--error", "0.01"]
    assert run(asked) == 0
    assert "Its H/B" not in capsys.readouterr().out
    assert run([*asked, "--width", "2", "--height", "1"]) == 0
    assert "Its H/B is 0.5, and that of the published cases from 1.23" in capsys.readouterr().out
