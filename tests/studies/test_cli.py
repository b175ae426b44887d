"""The command line: bad input, JSON, exit codes, pipes."""

import json
import math

import pandas as pd
import pytest
from commanding import CASE, python, refused
from given import BLOCK

from analytic import SinePulse, Still, simulate
from analytic.response import Response
from engines.registry import OWN
from studies.__main__ import COMMANDS, run
from studies.catalogue import STUDIES
from studies.sources.registry import SOURCES, Effort, Source

FIELDS = [
    *("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message"),
    *("error", "velocity_ratio", "impact_error", "kappa", "sensitivity"),
    *("min_normal", "friction_needed", "valid"),
]


def rocking(*arguments):
    return python("-m", "studies", *arguments)


def compare_with(**changed):
    arguments = ["compare", *CASE]
    for name, value in changed.items():
        arguments[arguments.index(f"--{name}") + 1] = value
    return arguments


# (command, the argument that is named, the value that is shown, part of what is allowed)
BAD_INPUT = [
    (compare_with(width="0"), "--width", "'0'", "positive"),
    (compare_with(height="-1.5"), "--height", "'-1.5'", "positive"),
    (compare_with(width="inf"), "--width", "'inf'", "finite"),
    (compare_with(height="nan"), "--height", "'nan'", "finite"),
    (compare_with(width="wide"), "--width", "'wide'", "number"),
    (compare_with(amplitude="0"), "--amplitude", "'0'", "positive"),
    (compare_with(amplitude="-0.4"), "--amplitude", "'-0.4'", "positive"),
    (compare_with(amplitude="-inf"), "--amplitude", "'-inf'", "positive"),
    (compare_with(omega="0"), "--omega", "'0'", "positive"),
    (compare_with(omega="nan"), "--omega", "'nan'", "positive"),
    (compare_with(omega="fast"), "--omega", "'fast'", "positive"),
    (compare_with(amplitude="1e308"), "--amplitude", "inf", "finite"),
    (["compare", *CASE, "--sources", "exact", "bullet"], "--sources", "'bullet'", "modified"),
    (["compare", *CASE, "--sources", "mujoco:best"], "--sources", "'mujoco:best'", "naive"),
    (["compare", *CASE, "--sources", "exact", "exact"], "--sources", "'exact'", "once"),
    (["compare", *CASE, "--sources"], "--sources", "empty", "housner"),
    (["compare", *CASE, "--pulse", "quarter"], "--pulse", "quarter", "half-sine"),
    (["compare", *CASE, "--half-cycles", "1.5"], "--half-cycles", "'1.5'", "whole"),
    (["compare", *CASE, "--duration", "0.5"], "--duration", "0.5", "0.999998 s"),
    (["compare", *CASE, "--step", "-1"], "--step", "'-1'", "positive"),
    (["compare", *CASE, "--jobs", "0"], "--jobs", "'0'", "positive"),
    (["compare", *CASE, "--plot", "a.txt"], "--plot", "'a.txt'", ".png"),
    (["compare", *CASE, "--plot", "/nowhere/a.png"], "--plot", "'/nowhere/a.png'", "written"),
    (["compare", *CASE, "--tilt", "nan"], "--tilt", "'nan'", "finite"),
    (["compare", *CASE, "--rate", "fast"], "--rate", "'fast'", "finite"),
    (["compare", *CASE, "--rate", "1e308"], "--rate", "1e+308", "less"),
    (["compare", *CASE, "--tilt", "-4.9"], "--tilt", "-4.9", "between -4.88"),
    (["compare", *CASE, "--tilt", "90", "--degrees"], "--tilt", "90", "between -90 and 90"),
    (["compare", *CASE[:4], "--tilt", "-1"], "--tilt", "-1", "balances"),
    (["compare", *CASE[:4], "--tilt", "1", "--omega", "3"], "--amplitude", "", "requires"),
    (["compare", *CASE[:4], "--tilt", "0"], "--amplitude", "", "--tilt"),
    (["compare", *CASE, "--phase", "inf"], "--phase", "'inf'", "finite"),
    (["compare", *CASE[2:]], "--width", "", "requires"),
    (["compare", *CASE, "--hight", "2"], "--hight", "", "--height"),
    (["sweep", "--figure", "5", "--out", "DIR"], "--figure", "'5'", "6, 7, 8, 9"),
    (["sweep", "--figure", "6.5", "--out", "DIR"], "--figure", "'6.5'", "6, 7, 8, 9"),
    (["sweep", "--figure", "6", "6", "--out", "DIR"], "--figure", "6", "once"),
    (["sweep", "--sources", "nobody", "--out", "DIR"], "--sources", "'nobody'", "mujoco"),
    (["sweep", "--out", "/dev/null/results"], "--out", "'/dev/null/results'", "folder"),
    (["sweep", "--time-limit", "0", "--out", "DIR"], "--time-limit", "'0'", "positive"),
    (["histories", "--figure", "3", "--out", "DIR"], "--figure", "'3'", "2, 4, 5"),
    (["redraw", "DIR"], "FOLDER", "DIR", "sweep.csv"),
    (["weep"], "weep", "", "sweep"),
    (["contact", "--out", ""], "--out", "empty", "given"),
    (["precision", "--out", "DIR", "--time-limit", "nan"], "--time-limit", "'nan'", "positive"),
    (["stability", "--out", "DIR", "--sources", "exact", "exact"], "--sources", "exact", "once"),
    (["free", "--out", "DIR", "--jobs", "1.5"], "--jobs", "'1.5'", "whole"),
    (["report", "--out", "/dev/null"], "--out", "'/dev/null'", "folder"),
    (["cost", "--out", "/dev/null"], "--out", "'/dev/null'", "folder"),
]


@pytest.mark.parametrize(("arguments", "name", "value", "allowed"), BAD_INPUT)
def test_bad_input_is_one_clear_line(arguments, name, value, allowed, tmp_path, capsys):
    folder = tmp_path / "DIR"
    arguments = [str(folder) if argument == "DIR" else argument for argument in arguments]
    refused(capsys, arguments, name, value, allowed)
    assert not folder.exists()


@pytest.mark.parametrize(("arguments", "name", "value", "allowed"), BAD_INPUT[::20])
def test_bad_input_ends_the_process_with_2(arguments, name, value, allowed, tmp_path):
    done = rocking(*[tmp_path / "DIR" if item == "DIR" else item for item in arguments])
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert name in line
    assert value in line


def test_json_is_one_object_a_line_and_nothing_else():
    sources = ["exact", "housner", "modified", "pybullet", "mujoco"]
    arguments = ["compare", *CASE, "--pulse", "full-sine", "--sources", *sources, "--json"]
    done = rocking(*arguments)
    assert done.returncode == 0, done.stderr
    assert done.stderr == ""
    rows = [json.loads(line, parse_constant=pytest.fail) for line in done.stdout.splitlines()]
    assert [row["source"] for row in rows] == sources
    assert all(list(row) == FIELDS for row in rows)
    by_source = {row["source"]: row for row in rows}
    assert by_source["housner"]["outcome"] == "overturned"
    assert by_source["housner"]["peak_ratio"] is None
    assert by_source["housner"]["error"] is None
    exact = by_source["exact"]
    late = {name: row["impact_error"] for name, row in by_source.items()}
    assert max(late["pybullet"], late["mujoco"]) < 1e-4 < late["modified"] < 0.3
    assert late["housner"] is None
    assert (exact["error"], exact["impact_error"], exact["valid"]) == (0.0, 0.0, True)
    for name in ("exact", "modified", "pybullet", "mujoco"):
        assert by_source[name]["outcome"] == "rocked"
        assert by_source[name]["peak_ratio"] == pytest.approx(0.3852, rel=0.07)
        relative = by_source[name]["peak_ratio"] / exact["peak_ratio"] - 1.0
        assert by_source[name]["error"] == pytest.approx(relative, rel=1e-12)
        assert by_source[name]["velocity_ratio"] == pytest.approx(0.85, rel=1e-4)
        assert by_source[name]["friction_needed"] == exact["friction_needed"]
        assert by_source[name]["impacts"] >= 3
        assert by_source[name]["steps"] > 0
        assert by_source[name]["wall_s"] > 0.0


def test_json_says_how_far_the_exact_peak_moves(capsys):
    """Of the case, and so the same for all; no number where an outcome changes."""
    near_onset = [
        *("compare", "--width", "1.5256313519414122", "--height", "9.174363250019729"),
        *("--pulse", "full-sine", "--omega", "2.10102467443576", "--sources", "exact", "housner"),
    ]
    assert run([*near_onset, "--amplitude", "0.17396032278997067", "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    for row in rows:
        assert row["kappa"] == pytest.approx(45.237, abs=1e-3)
        assert row["sensitivity"] == pytest.approx(6775, abs=1)
    onset = 1.5256313519414122 / 9.174363250019729
    assert run([*near_onset, "--amplitude", str(onset * (1.0 + 5e-5)), "--json"]) == 0
    row, _ = map(json.loads, capsys.readouterr().out.splitlines())
    assert (row["outcome"], row["sensitivity"]) == ("rocked", None)


def test_a_gentle_pulse_leaves_the_block_at_rest(capsys):
    assert run([*compare_with(amplitude="0.2"), "--sources", "exact", "housner", "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [(row["outcome"], row["peak_ratio"]) for row in rows] == [("at rest", 0.0)] * 2


def test_the_table_fits_the_screen_and_states_its_window(capsys, tmp_path):
    plot = tmp_path / "histories.png"
    arguments = ["compare", *CASE, "--duration", "2.5", "--sources", "rk4", "average-acceleration"]
    assert run([*arguments, "housner", "--plot", str(plot)]) == 0
    text = capsys.readouterr().out
    assert max(len(line) for line in text.splitlines()) <= 100
    assert "observed for 2.5 s" in text
    assert "η = 0.85" in text
    assert "0.850000" in text
    assert "exact " not in text.splitlines()[-3]
    assert plot.read_bytes().startswith(b"\x89PNG")


def compared(capsys, *options):
    assert run(["compare", *CASE[:4], *options, "--json"]) == 0
    return [json.loads(line) for line in capsys.readouterr().out.splitlines()]


def test_a_block_is_released_from_a_tilt_in_units_of_alpha(capsys):
    """Its first impact comes after a quarter period, the same in every source."""
    options = ["--tilt", "-0.6", "--duration", "2", "--sources"]
    rows = compared(capsys, *options, "exact", "dop853", "pybullet", "mujoco")
    assert [row["peak_ratio"] for row in rows] == pytest.approx([0.6] * 4, rel=1e-12)
    # landing steps of p dt = 1/200 are of second order
    assert all(row["impact_error"] < 200**-2 for row in rows)
    start = (-0.6 * BLOCK.alpha, 0.0)
    exact = simulate(BLOCK, Still(), start=start, duration=2.0)
    assert rows[0]["impacts"] == len(exact.impacts)
    assert rows[0]["min_normal"] == exact.min_normal


@pytest.mark.parametrize("turned", [[], ["--degrees"]])
def test_rate_phase_and_degrees(turned, capsys):
    """0.2 and -0.3 times alpha and alpha p, and a phase: in either unit the same answer."""
    theta, rate = 0.2 * BLOCK.alpha, -0.3 * BLOCK.alpha * BLOCK.p
    unit = (BLOCK.alpha, BLOCK.alpha * BLOCK.p, 1.0)
    if turned:
        unit = (math.radians(1.0),) * 3
    tilt, turning, phase = (repr(x / u) for x, u in zip((theta, rate, 2.0), unit, strict=True))
    start = ["--tilt", tilt, "--rate", turning, "--phase", phase, *turned]
    (row,) = compared(capsys, *CASE[4:], *start, "--sources", "exact")
    pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2, phase=2.0)
    window = pulse.duration + 8.0 / BLOCK.p
    exact = simulate(BLOCK, pulse, start=(theta, rate), duration=window)
    assert row["peak_ratio"] == pytest.approx(exact.peak_ratio, rel=1e-9)
    assert row["impacts"] == len(exact.impacts)


def test_the_table_says_how_a_block_started(capsys):
    arguments = ["compare", *CASE[:4], "--rate", "-0.5", "--sources", "exact", "housner"]
    assert run(arguments) == 0
    text = capsys.readouterr().out
    assert "ground  at rest; observed" in text
    assert "start   θ = 0 α, θ' = -0.5 αp" in text
    assert run([*arguments, "--tilt", "3", "--degrees"]) == 0
    text = capsys.readouterr().out
    assert "start   θ = 3°, θ' = -0.5°/s" in text
    assert "θmax [°]" in text
    assert "3.000000" in text


def test_where_the_reference_is_not_valid(capsys):
    """A squat block would have to be held down; of one that falls its fall does not count."""
    squat = ["compare", "--width", "1", "--height", "1", "--omega", "15", "--sources", "exact"]
    assert run([*squat, "--amplitude", "2.5", "--json"]) == 0
    row = json.loads(capsys.readouterr().out)
    assert (row["valid"], row["min_normal"] < 0.0) == (False, True)
    assert run([*squat, "--amplitude", "2.5"]) == 0
    assert "the pivot would lift off" in capsys.readouterr().out
    slender = ["--amplitude", "1.0", "--omega", "3", "--sources", "exact"]
    assert compared(capsys, *slender)[0]["valid"] is True
    assert run(["compare", "--width", "0.5", "--height", "1.5", *slender]) == 0
    assert "the normal force stays above" in capsys.readouterr().out


def test_half_cycles_replace_the_pulse(capsys):
    names = ["--sources", "exact", "--json", "--duration", "3"]
    peaks = []
    for pulse in (["--half-cycles", "2"], ["--pulse", "full-sine"], ["--half-cycles", "3"]):
        assert run(["compare", *CASE, *pulse, *names]) == 0
        peaks.append(json.loads(capsys.readouterr().out)["peak_ratio"])
    assert peaks[0] == peaks[1] != peaks[2]


def test_a_failed_row_is_named_and_the_exit_code_is_1(monkeypatch, capsys, tmp_path):
    def never(block, motion, *, duration, times):
        return Response.failure("it never converged")

    monkeypatch.setitem(SOURCES, "never", Source("model", never))
    assert run(["compare", *CASE, "--sources", "exact", "never", "--json"]) == 1
    output = capsys.readouterr()
    assert output.err.splitlines() == ["failed: never: it never converged"]
    assert json.loads(output.out.splitlines()[1])["peak_ratio"] is None
    arguments = ["sweep", "--figure", "6", "--sources", "exact", "never", "--out", str(tmp_path)]
    assert run(arguments) == 1
    errors = capsys.readouterr().err.splitlines()
    assert len(errors) == 11
    assert "figure 6, aspect 2, width_m 0.5, omega_over_p 0.1" in errors[0]
    assert errors[-1] == "failed: 230 more"
    table = pd.read_csv(tmp_path / "sweep.csv", keep_default_na=False)
    failed = table[table["outcome"] == "failed"]
    assert len(failed) == 240
    assert set(failed["peak_ratio"]) == {"nan"}
    assert set(failed["message"]) == {"it never converged"}


def test_a_sweep_through_the_command_line(tmp_path, capsys):
    arguments = ["--figure", "6", "7", "--sources", "exact", "modified", "--jobs", "2"]
    assert run(["sweep", *arguments, "--out", str(tmp_path / "made" / "here")]) == 0
    assert capsys.readouterr().err == ""  # no progress bar in a pipe
    made = {path.name for path in (tmp_path / "made" / "here").iterdir()}
    assert made >= {
        *("sweep.csv", "summary.csv", "findings.txt", "provenance.json"),
        *("figure-6.png", "figure-7.png"),
    }
    table = pd.read_csv(tmp_path / "made" / "here" / "sweep.csv")
    assert table.groupby(["figure", "source"]).size().to_dict() == {
        (figure, source): 240 for figure in (6, 7) for source in ("exact", "modified")
    }
    assert not table.duplicated(["figure", "aspect", "width_m", "omega_over_p", "source"]).any()


def test_help_explains_units(capsys):
    assert run(["--help"]) == 0
    text = capsys.readouterr().out
    assert all(study.name in text for study in COMMANDS)
    assert run(["compare", "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    for unit in ("[m]", "[g]", "[rad/s]", "[s]"):
        assert unit in text
    here = [name for name in SOURCES if name in OWN or SOURCES[name].kind != "engine"]
    assert all(name in text for name in here)


def test_accuracy_and_step_reach_only_the_sources_they_are_for():
    effort = Effort(step=1e-3, accuracy="tight")
    assert effort.options("exact") == {}
    assert effort.options("rk4") == {"step": 1e-3}
    assert effort.options("pybullet:fixed") == {"step": 1e-3}
    assert effort.options("mujoco") == {"step": 1e-3, "accuracy": "tight"}


@pytest.mark.parametrize(
    "study",
    [study for study in STUDIES if any(chapter.quick for chapter in study.chapters)],
    ids=lambda study: study.name,
)
def test_a_table_of_unknown_origin_is_left_alone(study, tmp_path, capsys):
    chapter = study.chapters[0]
    table = tmp_path / study.table
    table.write_text("mine")
    refused(capsys, study.command_line(chapter, tmp_path, full=False), "unknown origin")
    assert table.read_text() == "mine"
    refused(capsys, ["redraw", tmp_path])
