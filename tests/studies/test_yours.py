"""A reader's own friction and step: in a comparison, an export, advice, symptoms, from Python."""

import csv
import json
import math
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from commanding import CASE, compared
from given import BLOCK, PULSE

import studies
from analytic import simulate
from engines import ENGINES
from studies import respond, side_by_side
from studies.__main__ import run
from studies.advise.advice import find_errors
from studies.cases.drawn import RandomCase
from studies.measures.formulas import at_step
from studies.measures.published import PUBLISHED, along_steps, too_slippery

NEEDED = simulate(BLOCK, PULSE).friction_needed


def test_an_engine_is_asked_with_the_friction_and_the_step_that_are_given(capsys):
    own = ["--friction", "0.8", "--dt", "0.002"]
    code, rows = compared(capsys, *CASE, *own, "--sources", "exact", "mujoco:naive", "rk4")
    assert code == 0
    window = PULSE.duration + 8.0 / BLOCK.p
    given = {"step": 0.002 * BLOCK.p, "duration": window}
    for name, options in (("mujoco:naive", {**given, "friction": 0.8}), ("rk4", given)):
        answer = respond(name, BLOCK, PULSE, **options)
        assert rows[name]["peak_ratio"] == answer.peak_ratio
        assert rows[name]["steps"] == answer.steps
    other = respond("mujoco:naive", BLOCK, PULSE, duration=window, step=0.002 * BLOCK.p)
    assert other.peak_ratio != rows["mujoco:naive"]["peak_ratio"]
    assert rows["exact"]["message"] == ""


@pytest.mark.parametrize(("part", "says"), [(0.5, True), (1.1, False)])
def test_the_exact_row_says_where_friction_is_too_low_for_it(part, says, capsys):
    friction = part * NEEDED
    code, rows = compared(
        capsys, *CASE, "--friction", str(friction), "--sources", "exact", "pymunk:fixed"
    )
    words = f"slides: needs {NEEDED:.3g}, has {friction:.3g}"
    assert rows["exact"]["message"] == (words if says else "")
    slid = "slid" in rows["pymunk:fixed"]["message"]
    assert slid == says
    assert code == int(slid)


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


@pytest.mark.parametrize("kind", ["pulse", "record"])
def test_an_answer_that_hangs_on_a_hundredth_of_the_amplitude_says_so(kind, tmp_path, capsys):
    def amplified(factor):
        if kind == "pulse":
            return ["--amplitude", str(factor), "--omega", "6.2832"]
        path = tmp_path / "record.csv"
        times = [0.01 * i for i in range(101)]
        lines = [f"{time},{math.sin(6.2832 * time)}" for time in times]
        path.write_text("time_s,acceleration_g\n" + "\n".join(lines) + "\n")
        return ["--record", str(path), "--scale", str(factor), "--baseline", "none"]

    def told(factor):
        sources = ["--sources", "exact"]
        assert (
            run(["compare", "--width", "0.5", "--height", "1.5", *amplified(factor), *sources]) == 0
        )
        return capsys.readouterr().out

    low, high = 0.4, 0.6
    assert "overturned" in told(high) and "overturned" not in told(low)
    while high - low > 1e-6:
        middle = 0.5 * (low + high)
        low, high = (low, middle) if "overturned" in told(middle) else (middle, high)
    words = "the answer hangs on less than 1 % of the amplitude: at {} times it, the exact block {}"
    assert words.format("1.01", "overturns") in told(low / 1.005)
    assert words.format("0.99", "does not overturn") in told(high * 1.005)
    assert "hangs" not in told(low / 1.02) + told(high * 1.02)


def test_side_by_side_is_what_compare_tells(capsys):
    names = ["exact", "housner", "mujoco:fixed"]
    _, rows = compared(capsys, *CASE, "--friction", "0.8", "--sources", *names)
    table = side_by_side(BLOCK, PULSE, (name for name in names), friction=0.8)
    assert list(table["source"]) == names
    assert list(table.columns) == list(rows["exact"])
    for row in table.drop(columns="wall_s").to_dict("records"):
        for name, value in row.items():
            kept = rows[row["source"]][name]
            finite = not isinstance(value, float) or math.isfinite(value)
            assert kept == (value if finite else None)
    assert table.set_index("source").loc["housner", "peak_ratio"] == math.inf
    assert isinstance(table, pd.DataFrame)


@pytest.mark.parametrize(
    ("options", "problem"),
    [
        ({"sources": []}, r"sources is \[\]; it must be a list of one name or more"),
        ({"sources": "exact"}, "sources is 'exact'; it must be a list"),
        ({"sources": ["exat"]}, "source is 'exat', perhaps 'exact'; it must be one of exact"),
        ({"sources": ["mujoco"], "dt": 0.002}, "^dt is 0.002; it must come with equal steps"),
        ({"sources": ["rk4"], "dt": -1.0}, "^dt is -1; it must be"),
        ({"sources": ["rk4"], "friction": 1.0}, "^friction is 1; it must come with an engine"),
        ({"sources": ["mujoco"], "friction": math.nan}, "friction is nan; it must be a finite"),
        ({"sources": ["exact"], "duration": 0.1}, "^duration is 0.1; it must be at least"),
        ({"sources": ["rk4"], "dt": math.nan}, "^dt is nan; it must be a finite number"),
        ({"sources": ["exact"], "duration": math.nan}, "^duration is nan; it must be a finite"),
        ({"sources": ["exact"], "start": (math.nan, 0.0)}, "^start is nan; it must be a finite"),
        ({"sources": ["exact"], "start": (0.1, 0.0, 0.0)}, "^start is .* must be theta"),
    ],
)
def test_side_by_side_refuses_what_cannot_be(options, problem):
    with pytest.raises(ValueError, match=problem):
        side_by_side(BLOCK, PULSE, **options)


@pytest.mark.parametrize("option", ["friction", "dt", "duration", "start"])
def test_side_by_side_takes_numbers_of_any_type(option):
    def peak(value):
        given = {option: (value, 0.0) if option == "start" else value}
        return side_by_side(BLOCK, PULSE, ["mujoco:naive"], **given)["peak_ratio"].item()

    value = np.float32({"duration": 2.7, "dt": 0.0021}.get(option, 0.3))
    assert peak(value) == peak(float(value))


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


def test_the_guide_s_python_runs_as_a_script_of_one_s_own(tmp_path):
    """It has no guard by which other processes could be started from it."""
    guide = (Path(studies.__file__).parent / "GUIDE.md").read_text()
    code, _ = re.findall(r"^```python\n(.*?)^```$", guide, flags=re.DOTALL | re.MULTILINE)
    script = tmp_path / "mine.py"
    script.write_text(code + "print(table['peak_ratio'].tolist())\n")
    root = str(Path(studies.__file__).parents[1])
    done = subprocess.run(
        [sys.executable, "-c", f"import sys, runpy; sys.path.insert(0, {root!r});"
         f"runpy.run_path({str(script)!r}, run_name='__main__')"],
        capture_output=True, text=True, timeout=120,
    )  # fmt: skip
    assert done.returncode == 0, done.stderr
    (line,) = done.stdout.splitlines()
    exact, engine = json.loads(line)
    assert exact == pytest.approx(simulate(BLOCK, PULSE).peak_ratio, rel=1e-12)
    assert 0.0 < engine < 1.0


def test_every_engine_takes_a_friction_and_a_step():
    names = [f"{name}:fixed" for name in ENGINES if ENGINES[name].installed and name != "newton"]
    table = side_by_side(BLOCK, PULSE, names, friction=1.0, dt=0.001, duration=PULSE.duration)
    assert set(table["outcome"]) <= {"rocked", "overturned"}
    steps = table["steps"] * 0.001
    assert steps.between(0.9 * PULSE.duration, 1.2 * PULSE.duration).all()


def columns_of(text):
    """Return the cells of a comparison's table by source and column; no cell has a blank in it."""
    lines = text.splitlines()
    head = next(number for number, line in enumerate(lines) if line.split()[:1] == ["source"])
    names = lines[head].replace("vs exact", "vs-exact").replace("bound 95 %", "bound").split()
    rows = (re.sub(r"(?<=[0-9]) (?=[mµ]?s\b)", "", line).split() for line in lines[head + 1 :])
    return {row[0]: dict(zip(names, row, strict=True)) for row in rows if len(row) == len(names)}


def test_the_table_has_kappa_and_the_sensitivity_and_estimates_where_asked_for(capsys):
    asked = ["--sources", "exact", "mujoco:fixed", "--estimate"]
    _, rows = compared(capsys, *CASE, *asked)
    assert run(["compare", *CASE, *asked]) == 0
    table = columns_of(capsys.readouterr().out)
    for source, row in rows.items():
        assert table[source]["κ"] == f"{row['kappa']:.2g}"
        assert table[source]["sens"] == f"{row['sensitivity']:.2g}"
    assert table["exact"]["estimate"] == "-" == table["exact"]["bound"]
    engine = rows["mujoco:fixed"]
    assert float(table["mujoco:fixed"]["estimate"]) == pytest.approx(engine["estimate"], rel=0.05)
    told = side_by_side(BLOCK, PULSE, ["exact", "mujoco:fixed"], estimate=True)
    found = told.set_index("source").loc["mujoco:fixed"]
    assert [found["estimate"], found["bound"]] == [engine["estimate"], engine["bound"]]
    assert engine["bound"] >= engine["estimate"] > 0.0


def test_what_has_no_kappa_says_so(capsys):
    strong = ["--amplitude", "2", "--omega", "3", "--sources", "exact"]
    assert run(["compare", *CASE[:4], *strong]) == 0
    row = columns_of(capsys.readouterr().out)["exact"]
    assert (row["outcome"], row["κ"], row["sens"]) == ("overturned", "-", "0")


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
    assert run(["estimate", *few, *own, "--out", str(tmp_path / "a")]) == 0
    rows = pd.read_csv(tmp_path / "a" / "estimate.csv", dtype={"message": str})
    assert len(rows) == 4
    for row in rows.to_dict("records"):
        names = ("case", "aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p")
        case = RandomCase(**{name: row[name] for name in names})
        step = 0.003 * case.block.p / (2.0 if row["half"] else 1.0)
        answer = respond("pymunk:naive", case.block, case.motion, friction=0.9, step=step)
        assert row["peak_ratio"] == answer.peak_ratio and row["steps"] == answer.steps
    assert run(["estimate", *few, "--out", str(tmp_path / "a")]) == 2
