"""Advice: the cheapest published setting that keeps an error, and the library's words for it."""

import math
import re
from pathlib import Path

import pandas as pd
import pytest
from commanding import refused
from given import BLOCK

from engines import ENGINES
from engines.declaration import AT_REST
from studies.__main__ import run
from studies.advise.advice import TABLES, find, finding, keeps, why, write
from studies.kit.tables import table_in
from studies.measures.finer import cheapest_kept
from studies.measures.published import (
    PUBLISHED,
    RANDOM,
    TARGETS,
    counted,
    random_runs,
    settings,
)

CORE = [name for name, engine in ENGINES.items() if engine.core]
LANDING = ENGINES["mujoco"].preset("landing")


def test_the_published_advice_follows_from_the_published_tables():
    kept = table_in(PUBLISHED / "advice", "advice")
    today = find(PUBLISHED, list(kept["engine"].unique()), TARGETS, BLOCK)
    assert ((today["message"] == "") == (kept["message"] == "")).all()
    numbers = [name for name in kept if name != "message"]
    pd.testing.assert_frame_equal(today[numbers], kept[numbers], check_dtype=False, rtol=1e-12)


@pytest.mark.parametrize("target", [1.0, 1e-2, 1e-9])
def test_what_is_advised_keeps_the_error_with_every_finer_step_and_nothing_cheaper_does(target):
    known = counted(settings(PUBLISHED, CORE), random_runs(PUBLISHED), target)
    lines = find(PUBLISHED, CORE, [target], BLOCK)
    uses = {(name, use.name) for name in CORE for use in ENGINES[name].presets}
    assert {use for use in uses if use[1] != AT_REST} == set(
        zip(lines["engine"], lines["preset"], strict=True)
    )
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


def table_of(*lines):
    """Return settings from coarse to fine: value, time, error, and off among 50 random cases."""
    names = ["value", "wall_s", "max_error", "random_off", "random_calm_off"]
    return pd.DataFrame(lines, columns=names).assign(random_cases=50)


LUCKY = [(5e-3, 0.02, 4e-3, 0, 0), (2e-3, 0.09, math.inf, 0, 0), (1e-3, 0.1, 6e-3, 0, 0)]


@pytest.mark.parametrize(
    ("lines", "value", "reason"),
    [
        (LUCKY, 1e-3, ""),
        ([*LUCKY, (5e-4, 0.3, 2e-2, 0, 0)], None, r"0.001 keeps it.* 2 % at p dt = 0.0005"),
        ([*LUCKY, (5e-4, 0.05, 2e-3, 0, 0)], 5e-4, ""),
        ([(5e-3, 0.02, 4e-3, 3, 0), (2e-3, 0.09, 3e-3, 2, 0)], 5e-3, ""),
        ([(5e-3, 0.02, 4e-3, 1, 1), (2e-3, 0.09, 3e-3, 0, 0)], 2e-3, ""),
        ([(5e-3, 0.02, 4e-3, 0, 0), (2e-3, 0.09, 3e-3, 9, 2)], None, r"9 of 50 .*0.002, 2 of "),
        ([(5e-3, 0.02, 0.3, 0, 0), (2e-3, 0.09, 0.2, 0, 0)], None, r"best .* 20 % at p dt = 0.002"),
        ([(5e-3, 0.02, math.inf, 0, 0)], None, "wrong at every step"),
        ([], None, "published"),
    ],
)
def test_a_lucky_step_and_one_with_a_well_conditioned_miss_are_not_advised(lines, value, reason):
    table = table_of(*lines)
    best = cheapest_kept(table, keeps(table, 1e-2)) if lines else None
    assert (best is None) == (value is None) and (best is None or best["value"] == value)
    if best is None:
        assert re.search(reason, why(table, LANDING, 1e-2))


def test_the_finding_names_the_cheapest_of_the_smallest_error():
    lines = find(PUBLISHED, CORE, [0.1, 1e-4], BLOCK)
    best = lines[lines["target"] == 1e-4].nsmallest(1, "wall_s").iloc[0]
    sentence = finding({"advice": lines})
    assert ENGINES[best["engine"]].title in sentence and "0.01 %" in sentence
    assert f"{1e3 * best['wall_s']:.3g} ms" in sentence
    assert "0.01 %" in finding({"advice": lines.assign(target=1e-4, message="none")})


@pytest.mark.parametrize("engine", CORE)
def test_settings_are_written_for_the_block_and_the_step(engine):
    line = {"engine": engine, "preset": "fixed", "value": 2e-4, "dt_s": 2e-4 / BLOCK.p}
    (text,) = write(pd.DataFrame([{**line, "message": ""}]), BLOCK, 0.8)
    assert repr(2e-4 / BLOCK.p) in text and "0.8" in text and "DT" not in text.partition("\n")[2]
    assert "375.0" in text or "0.25" in text  # its mass [kg], or half its width [m]
    (text,) = write(pd.DataFrame([line]), BLOCK, 0.8)  # of a given step
    assert "DT" in text.partition("\n")[2] and repr(2e-4 / BLOCK.p) in text


@pytest.mark.parametrize(("asked", "friction"), [([], 0.8), (["--friction", "10"], 10.0)])
def test_impratio_is_written_with_the_friction_that_it_belongs_to(asked, friction, capsys):
    """Its root is at most 10 times the friction: beyond, the solver errs."""
    assert run(["advise", "--dt", "0.002", "--engine", "mujoco", *asked]) == 0
    text = capsys.readouterr().out
    assert set(re.findall(r' friction="(\S+)', text)) == {f"{friction}"}
    ratios = map(float, re.findall(r'impratio="(.*?)"', text))
    assert max(ratios) == pytest.approx((10.0 * friction) ** 2)


def test_a_dial_is_no_step(capsys):
    assert run(["advise", "--engine", "drake", "--error", "0.01"]) == 0
    text = capsys.readouterr().out
    own = 1e-8 * BLOCK.alpha * max(1.0, BLOCK.R)
    assert "accuracy = 1e-08" in text and f"integrator.set_target_accuracy({own!r})" in text
    assert all(name in " ".join(text.split()) for name in (*TABLES, RANDOM))


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
    assert (tmp_path / name / f"{name}.png").stat().st_size > 7_000


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--error", "0"], "--error is '0'; it must be a positive finite number"),
        (["--error", "0.1", "0.1"], "--error names 0.1 twice"),
        (["--engine", "havok"], "--engines is 'havok'; it must be among"),
        (["--published", "tests"], "--published is 'tests'; it must hold precision/work-precision"),
        (["--symptoms", "--published", "tests"], "it must hold contact/variants.csv"),
        (["--symptoms", "--error", "0.1"], "--error is 0.1; it may be given only without --sym"),
    ],
)
def test_refusals(arguments, words, capsys):
    refused(capsys, ["advise", *arguments], words)
