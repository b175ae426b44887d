"""The commands of worst cases: they give the rows that they stand by."""

import json
import math
from pathlib import Path

import pytest
from given import BLOCK, PULSE

from analytic import RigidBlock
from analytic.motion import Delayed
from studies.__main__ import run
from studies.kit.tables import read_table
from studies.measures.again import commands, written_out
from studies.measures.published import PUBLISHED
from studies.page import page
from studies.stability.study import again as failures
from studies.sweep.study import again as swept
from studies.validate.study import again as drawn

SAMPLE = [
    *((swept, "sweep/sweep", source, "") for source in ("housner", "modified", "mujoco")),
    *((swept, "presets/sweep", source, "") for source in ("mujoco:fixed", "pymunk:naive")),
    *((drawn, "validate/errors", source, "") for source in ("mujoco", "pymunk")),
    (failures, "stability/stability", "rk4", "boundary after impact + 1e-6"),
    (failures, "stability/stability", "mujoco:naive", "ω/p 0.01"),
    (failures, "stability/stability", "pymunk:naive", "60 s at rest"),
    (failures, "stability/stability", "pymunk:naive", "friction 1e9"),
    (failures, "stability/stability", "mujoco:fixed", "step 1/240 s"),
]


@pytest.mark.parametrize(("again", "table", "source", "case"), SAMPLE)
def test_a_command_gives_the_row_that_it_stands_by(again, table, source, case, capsys):
    path = PUBLISHED / f"{table}.csv"
    told = again(path.parent)
    line = told[(told["source"] == source) & ((told["case"] == case) if case else True)].iloc[0]
    row = read_table(path).loc[line.name]
    run([*line["compare"].split()[1:], "--json", "--jobs", "1"])
    found = json.loads(capsys.readouterr().out.splitlines()[-1])
    assert [found["source"], found["outcome"]] == [*row[["source", "outcome"]]]
    if math.isfinite(row["peak_ratio"]):
        assert found["peak_ratio"] == pytest.approx(row["peak_ratio"], rel=1e-6)


def test_an_engine_is_written_out_with_the_peak_of_its_row(tmp_path, capsys):
    line = swept(PUBLISHED / "presets").set_index("source").loc["mujoco:naive"]
    assert run(line["export"].replace("DIR", str(tmp_path)).split()[1:]) == 0
    off = float(capsys.readouterr().out.split("expect: ")[1].split()[0]) / line["exact_peak"] - 1.0
    assert off == pytest.approx(line["error"], rel=1e-6)


def test_what_has_no_option_is_said():
    squat = RigidBlock(width=0.5, height=1.5, restitution=0.9)
    for block, motion, options, words in (
        (BLOCK, PULSE, {"density": 1.0, "step": 0.01}, "density"),
        (BLOCK, Delayed(PULSE, 1.0), {}, "its motion of the base"),
        (squat, PULSE, {}, "such a body, or its restitution"),
    ):
        asked = commands(block, motion, "mujoco:naive", options)
        assert asked == (f"no option asks for {words}", "")
    assert commands(BLOCK, PULSE, "mujoco:naive", {}, outcome="failed")[1] == ""


def test_a_start_is_asked_in_the_units_of_the_command_line():
    start = {"start": (0.25 * BLOCK.alpha, -0.5 * BLOCK.alpha * BLOCK.p)}
    words = commands(BLOCK, PULSE, "exact", start)[0].split()
    assert [float(words[words.index(name) + 1]) for name in ("--tilt", "--rate")] == [0.25, -0.5]


@pytest.mark.parametrize("source", ["exact", "mujoco", "mujoco:naive"])
def test_the_page_has_the_same_words(source):
    script = pytest.importorskip("quickjs").Context()
    script.eval(Path(page.__file__).with_name("rocking.js").read_text(encoding="utf-8"))
    values = f"0.5, 3, 2, 0.4, 6.2832, '{source}', {str(written_out(source)).lower()}"
    found = json.loads(script.eval(f"JSON.stringify(commands({values}))"))
    assert found == [words for words in commands(BLOCK, PULSE, source, {}) if words]
