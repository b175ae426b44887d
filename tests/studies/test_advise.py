"""Advice: the cheapest published setting that keeps an error, what halves a symptom, in words."""

import math
import re
from pathlib import Path

import pandas as pd
import pytest
from given import BLOCK

from engines import ENGINES
from engines.declaration import AT_REST
from engines.factors import DEFAULT, OWN_STEPS
from studies.__main__ import run
from studies.advise import find, keeps, why, write
from studies.advise import symptoms as seen
from studies.kit.tables import read_table, table_in
from studies.measures.costs import cheapest_kept
from studies.measures.published import PUBLISHED, RANDOM, TARGETS, along_steps, counted, settings

CORE = [name for name, engine in ENGINES.items() if engine.core]
KNOWN = list(along_steps(PUBLISHED, list(ENGINES))["engine"].unique())
LANDING = ENGINES["mujoco"].preset("landing")


@pytest.fixture(scope="module")
def symptoms():
    return seen.find(KNOWN)


def test_the_published_advice_follows_from_the_published_tables(symptoms):
    for name, today in (("advice", find(KNOWN, TARGETS, BLOCK)), ("symptoms", symptoms)):
        kept = table_in(PUBLISHED / name, name, *seen.TEXTS)
        pd.testing.assert_frame_equal(today, kept, check_dtype=False, rtol=1e-12)


@pytest.mark.parametrize("target", [1.0, 1e-2, 1e-9])
def test_what_is_advised_keeps_the_error_with_every_finer_step_and_nothing_cheaper_does(target):
    known = counted(settings(PUBLISHED, CORE), pd.read_csv(PUBLISHED / RANDOM), target)
    lines = find(CORE, [target], BLOCK)
    uses = {(name, use.name) for name in CORE for use in ENGINES[name].presets}
    asked = set(zip(lines["engine"], lines["preset"], strict=True))
    assert {use for use in uses if use[1] != AT_REST} == asked
    for row in lines.itertuples():
        mine = known[(known["engine"] == row.engine) & (known["preset"] == row.preset)]
        kept = []
        for line in list(mine.itertuples())[::-1]:  # from fine to coarse, to the first that misses
            if line.max_error > target or line.random_calm_off:
                break
            kept.append(line.wall_s)
        assert (row.message == "") == bool(kept)
        if kept:
            assert row.wall_s == min(kept) and row.max_error <= target
            assert row.dt_s == pytest.approx(row.value / BLOCK.p)
        else:
            assert math.isnan(row.wall_s) and not row.cheapest


LUCKY = [(5e-3, 0.02, 4e-3, 0), (2e-3, 0.09, math.inf, 0), (1e-3, 0.1, 6e-3, 0)]


@pytest.mark.parametrize(
    ("lines", "value", "reason"),
    [
        (LUCKY, 1e-3, ""),
        ([*LUCKY, (5e-4, 0.3, 2e-2, 0)], None, "0.001 keeps it, but"),
        ([*LUCKY, (5e-4, 0.05, 2e-3, 0)], 5e-4, ""),
        ([(5e-3, 0.02, 4e-3, 1), (2e-3, 0.09, 3e-3, 0)], 2e-3, ""),
        ([(5e-3, 0.02, 4e-3, 0), (2e-3, 0.09, 3e-3, 2)], None, "0.005 keeps it, but"),
        ([(5e-3, 0.02, 4e-3, 3), (2e-3, 0.09, 3e-3, 2)], None, "0.3 % at p dt = 0.002; .* 2"),
        ([(5e-3, 0.02, 0.3, 0), (2e-3, 0.09, 0.2, 0)], None, "best .* 20 % at p dt = 0.002"),
        ([(5e-3, 0.02, math.inf, 0)], None, "wrong at every step"),
        ([], None, "published"),
    ],
)
def test_a_lucky_step_and_one_with_a_well_conditioned_miss_are_not_advised(lines, value, reason):
    table = pd.DataFrame(lines, columns=["value", "wall_s", "max_error", "random_calm_off"])
    best = cheapest_kept(table, keeps(table, 1e-2)) if lines else None
    assert (best is None) == (value is None) and (best is None or best["value"] == value)
    if best is None:
        assert re.search(reason, why(table, LANDING, 1e-2))


def advised(engine):
    """Return the line of advice with an engine's tuned contact at a p dt of 0.01."""
    line = {"engine": engine, "preset": "tuned", "value": 0.01, "dt_s": 0.01 / BLOCK.p}
    return pd.DataFrame([{**line, "message": ""}])


@pytest.mark.parametrize("engine", CORE)
def test_settings_are_written_for_the_block_the_step_and_the_friction(engine):
    (text,) = write(advised(engine), BLOCK, 0.7)
    assert f"{0.01 / BLOCK.p:.6g}"[:6] in text and "0.7" in text.partition("\n")[2]
    assert "375.0" in text or "0.25" in text  # its mass [kg], or half its width [m]


@pytest.mark.parametrize("friction", [None, 10.0])
def test_impratio_is_written_with_the_friction_that_it_belongs_to(friction):
    """Its root is at most 10 times the friction: beyond, the solver errs."""
    (text,) = write(advised("mujoco"), BLOCK, friction)
    assert set(re.findall(r' friction="(\S+)', text)) == {f"{friction or 0.8}"}
    (ratio,) = map(float, re.findall(r'impratio="(.*?)"', text))
    assert ratio == pytest.approx((10.0 * (friction or 0.8)) ** 2)


def test_a_dial_is_no_step(capsys):
    pytest.importorskip("pydrake")  # its settings are those of a scene that is built
    assert run(["advise", "--engine", "drake", "--error", "0.01"]) == 0
    own = 1e-8 * BLOCK.alpha * max(1.0, BLOCK.R)
    text = capsys.readouterr().out
    assert "accuracy = 1e-08" in text and repr(own) in text


def singles(name, engine, column):
    """Return what the defaults leave, and what each setting that breaks nothing does."""
    table = read_table(PUBLISHED / name, "factor", "level")
    mine = table[(table["preset"] == DEFAULT) & (table["engine"] == engine)]
    base = mine[mine["factor"] == ""].iloc[0]
    found = mine[(mine["factor"] != "") & (mine["factor"] != OWN_STEPS)]
    sound = found[(found["failed"] == 0) & (found["wrong"] <= base["wrong"])]
    if column == "max_error" and not base["failed"]:
        sound = sound[sound["median_error"] < base["median_error"]]
    left = {
        f"{each.factor}: {each.level}": abs(getattr(each, column)) for each in sound.itertuples()
    }
    return math.inf if base["failed"] else base[column], left


@pytest.mark.parametrize("symptom", seen.SYMPTOMS, ids=lambda symptom: symptom.column)
def test_no_other_single_setting_helps_more(symptom, symptoms):
    for row in symptoms[symptoms["symptom"] == symptom.name].to_dict("records"):
        before, left = singles(seen.VARIANTS, row["engine"], symptom.column)
        before_own, left_own = singles(seen.OWN, row["engine"], symptom.column)
        assert (row["before"], row["before_own"]) == (before, before_own)
        helping = {
            name: size
            for name, size in left.items()
            if before and name in left_own and size <= 0.5 * abs(before)
            if left_own[name] <= 0.5 * abs(before_own)
        }
        assert bool(row["setting"]) == bool(helping)
        if helping:
            assert abs(row["after"]) == helping[row["setting"]] == min(helping.values())
            assert abs(row["after_own"]) == left_own[row["setting"]]


def test_a_setting_is_quoted_in_the_library_s_words_for_a_friction():
    text = "".join(seen.write(seen.find(["pybullet"]), BLOCK, None))
    assert "damping: as in the best" in text and "linearDamping=0.0, angularDamping=0.0" in text
    text = "".join(seen.write(seen.find(["mujoco"]), BLOCK, 0.35))
    assert '"0.35 0.35' in text


@pytest.mark.parametrize("mode", [[], ["--symptoms"]])
def test_a_folder_holds_what_is_printed_with_its_figure(mode, tmp_path, capsys):
    name = "symptoms" if mode else "advice"
    asked = ["advise", *mode, "--engines", "mujoco", "pymunk", "--out", str(tmp_path / name)]
    for _ in range(2):
        assert run(asked) == 0
        text = capsys.readouterr().out
        assert text.startswith(Path(tmp_path / name / "findings.txt").read_text())
    kept, mine = (table_in(place / name, name) for place in (PUBLISHED, tmp_path))
    assert list(kept) == list(mine)
    assert [path.name for path in (tmp_path / name).glob("*.png")] == ["advice.png"] * (not mode)
