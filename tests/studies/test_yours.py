"""A reader's own friction and step: in a comparison, in an exported scene, from Python."""

import json
import math
import re
import subprocess
import sys
from pathlib import Path

import pandas as pd
import pytest
from commanding import CASE, compared
from given import BLOCK, PULSE

import studies
from analytic import simulate
from engines import ENGINES
from studies import respond, side_by_side
from studies.__main__ import run

NEEDED = simulate(BLOCK, PULSE).friction_needed


def test_an_engine_is_asked_with_the_friction_and_the_step_that_are_given(capsys):
    code, rows = compared(
        capsys,
        *CASE,
        "--friction",
        "0.8",
        "--dt",
        "0.002",
        "--sources",
        "exact",
        "mujoco:naive",
        "rk4",
    )
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
    table = side_by_side(BLOCK, PULSE, names, friction=0.8)
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
        ({"sources": ["exat"]}, "source is 'exat'; it must be one of exact"),
        ({"sources": ["mujoco"], "dt": 0.002}, "^dt is 0.002; it must come with equal steps"),
        ({"sources": ["rk4"], "dt": -1.0}, "^dt is -1; it must be"),
        ({"sources": ["rk4"], "friction": 1.0}, "^friction is 1; it must come with an engine"),
        ({"sources": ["mujoco"], "friction": math.nan}, "friction is nan; it must be a finite"),
        ({"sources": ["exact"], "duration": 0.1}, "^duration is 0.1; it must be at least"),
    ],
)
def test_side_by_side_refuses_what_cannot_be(options, problem):
    with pytest.raises(ValueError, match=problem):
        side_by_side(BLOCK, PULSE, **options)


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
