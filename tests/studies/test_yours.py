"""A reader's own friction and step: in a comparison, an export, advice, symptoms, from Python."""

import csv
import math
import re
import subprocess
import sys

import numpy as np
import pandas as pd
import pytest
from commanding import CASE, compared
from given import BLOCK, PULSE

from engines import ENGINES
from studies import respond
from studies.__main__ import run
from studies.advise.advice import find_errors
from studies.cases.drawn import RandomCase
from studies.measures.formulas import at_step
from studies.measures.published import PUBLISHED, along_steps, too_slippery


def test_a_scene_is_exported_with_them(tmp_path, capsys):
    own = ("--friction", "0.8", "--dt", "0.002")
    _, rows = compared(capsys, *CASE, *own, "--sources", "mujoco:naive")
    scene = ["--engine", "mujoco:naive", "--out", str(tmp_path / "scene")]
    assert run(["export", *CASE, *own, *scene]) == 0
    told = float(re.search(r"to expect: (\S+)", capsys.readouterr().out)[1])
    assert told == pytest.approx(rows["mujoco:naive"]["peak_ratio"], rel=1e-11)
    script = tmp_path / "scene" / "block.py"
    done = subprocess.run([sys.executable, str(script)], capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "DT = 0.002 " in script.read_text()
    assert 'friction="0.8 ' in (tmp_path / "scene" / "block.xml").read_text()


@pytest.mark.parametrize("source", ["mujoco:fixed", "drake:fixed"])
def test_a_setting_takes_a_number_of_any_type(source):
    if not ENGINES[source.partition(":")[0]].installed:
        pytest.skip("not installed")
    value = np.float32(0.83)
    told = [
        respond(source, BLOCK, PULSE, step=0.05, settings={"friction": number})
        for number in (value, np.float64(value), float(value))
    ]
    assert len({response.peak_ratio for response in told}) == 1


PUBLISHED_ENGINES = list(along_steps(PUBLISHED, list(ENGINES))["engine"].unique())
SETS = ("typical", "near overturning")


def ladder(method):
    """Return (set, p dt, largest error) of a method, read line by line."""
    with (PUBLISHED / "precision" / "work-precision.csv").open(newline="") as file:
        lines = [line for line in csv.DictReader(file) if line["method"] == method]
    return [
        (line["set"], float(line["value"]),
         math.inf if int(line["failed"]) else float(line["max_error"]))
        for line in lines
    ]  # fmt: skip


@pytest.mark.parametrize("dt", [1e-4, 0.002, 0.01])
@pytest.mark.parametrize("engine", PUBLISHED_ENGINES)
def test_the_error_of_a_step_is_the_largest_at_the_next_coarser_and_all_finer(engine, dt):
    p_dt = dt * BLOCK.p
    kept = find_errors(PUBLISHED, [engine], BLOCK, dt)
    assert list(kept["preset"]) == ["naive", "recommended", "fixed"]
    for _, line in kept.iterrows():
        known = ladder(f"{engine} {line['preset']}")
        coarser = min(value for _, value, _ in known if value >= p_dt)
        assert line["coarser"] == coarser
        for name in SETS:
            errors = [e for of, value, e in known if of == name and value <= coarser]
            assert line[name] == max(errors)
    finer = find_errors(PUBLISHED, [engine], BLOCK, 0.5 * dt)
    assert all((finer[name] <= kept[name]).all() for name in SETS)


def test_a_published_step_is_its_own_and_none_is_as_coarse_as_a_long_one():
    exactly = find_errors(PUBLISHED, ["mujoco"], BLOCK, 0.01 / BLOCK.p)
    assert exactly["coarser"].tolist() == [0.01, 0.01, 0.01]
    long = find_errors(PUBLISHED, ["mujoco"], BLOCK, 0.9)
    assert long[["coarser", *SETS]].isna().all(axis=None)


def written_at(dt, engine, capsys):
    """Return the lines of each preset's settings at a step."""
    assert run(["advise", "--dt", str(dt), "--engine", engine, "--friction", "0.7"]) == 0
    parts = re.split(rf"\n\n(?=[^\n]*DT = {dt:g} s)", capsys.readouterr().out)[1:]
    return [part.split("\n\n")[0].splitlines() for part in parts]


@pytest.mark.parametrize("engine", PUBLISHED_ENGINES)
def test_settings_are_formulas_of_the_step_and_their_values(engine, capsys):
    dt = 0.0037
    parts, elsewhere = (written_at(step, engine, capsys) for step in (dt, 0.5 * dt))
    assert len(parts) == 3
    for (head, *lines), (_, *others) in zip(parts, elsewhere, strict=True):
        assert "0.7" in "".join(lines)
        if "that is" not in lines:
            # what follows the step otherwise than as a power of it, or not at all
            assert ("at another step other numbers" in head) == (lines != others)
            continue
        middle = lines.index("that is")
        formulas, values = lines[:middle], lines[middle + 1 :]
        assert "DT" in "".join(formulas) and "DT" not in "".join(values)
        for formula, value in zip(formulas, values, strict=True):
            found, told = (re.findall(r"[-\d.e+]+", at) for at in (at_step(formula, dt), value))
            pairs = [(a, b) for a, b in zip(found, told, strict=True) if a != b]
            # formulas are written in ten digits
            assert all(math.isclose(float(a), float(b), rel_tol=1e-8) for a, b in pairs)


def test_advice_is_written_out_with_the_friction_that_is_given(capsys):
    assert run(["advise", "--error", "0.1", "--engine", "mujoco", "--friction", "0.35"]) == 0
    text = capsys.readouterr().out
    assert 'friction="0.35 0.005' in text and "1000.0 0.005" not in text
    assert "With friction 0.35 a block slides in" in text


def test_which_of_the_paper_s_cases_slide():
    """In the paper's cases a block lifts at a ground of g B/H, and B/H is 1/2 at most."""
    assert too_slippery(None) == ""
    assert too_slippery(10.0) == ""
    counts = [int(re.search(r"slides in (\d+) of the paper's 960", too_slippery(mu))[1])
              for mu in (0.2, 0.3, 0.45)]  # fmt: skip
    assert counts[0] == 960 and counts == sorted(counts, reverse=True) and counts[-1] >= 320


def test_symptoms_are_mended_with_the_friction_that_is_given(tmp_path, capsys):
    def literals(name, *options):
        asked = ["advise", "--symptoms", "--engines", "mujoco", *options]
        assert run([*asked, "--out", str(tmp_path / name)]) == 0
        return " ".join(pd.read_csv(tmp_path / name / "symptoms.csv")["literal"].dropna())

    usual, mine = literals("usual"), literals("mine", "--friction", "0.35", "--dt", "0.004")
    assert "0.35" in mine and "0.35" not in usual
    assert "slides in" in capsys.readouterr().out


@pytest.mark.slow
def test_estimates_are_made_with_a_friction_and_a_step(tmp_path):
    few = ["--cases", "1", "--tests", "1", "--sources", "pymunk:naive"]
    own = ["--friction", "0.9", "--dt", "0.003"]
    assert run(["validate", "--halves", *few, *own, "--out", str(tmp_path / "a")]) == 0
    rows = pd.read_csv(tmp_path / "a" / "estimate.csv", dtype={"message": str})
    assert len(rows) == 4
    for row in rows.to_dict("records"):
        names = ("case", "aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p")
        case = RandomCase(**{name: row[name] for name in names})
        step = 0.003 * case.block.p / (2.0 if row["half"] else 1.0)
        answer = respond("pymunk:naive", case.block, case.motion, friction=0.9, step=step)
        assert row["peak_ratio"] == answer.peak_ratio and row["steps"] == answer.steps
    assert run(["validate", "--halves", *few, "--out", str(tmp_path / "a")]) == 2
