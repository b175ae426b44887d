"""The command line: bad input, JSON, exit codes, pipes."""

import json
import math

import numpy as np
import pandas as pd
import pytest
from commanding import CASE, compared, python, refused
from given import BLOCK

from analytic import SinePulse, Still, simulate
from analytic.response import Response
from engines.registry import OWN
from studies.__main__ import COMMANDS, run
from studies.sources.registry import SOURCES, Effort, Source

FIELDS = [
    *("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message"),
    *("error", "velocity_ratio", "impact_error", "kappa", "sensitivity"),
    *("min_normal", "friction_needed", "valid"),
]


def rocking(*arguments):
    return python("-m", "studies", *arguments)


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
        *("--width", "1.5256313519414122", "--height", "9.174363250019729"),
        *("--pulse", "full-sine", "--omega", "2.10102467443576", "--sources", "exact", "housner"),
    ]
    code, rows = compared(capsys, *near_onset, "--amplitude", "0.17396032278997067")
    assert (code, len(rows)) == (0, 2)
    for row in rows.values():
        assert row["kappa"] == pytest.approx(45.237, abs=1e-3)
        assert row["sensitivity"] == pytest.approx(6775, abs=1)
    onset = 1.5256313519414122 / 9.174363250019729
    _, rows = compared(capsys, *near_onset, "--amplitude", onset * (1.0 + 5e-5))
    assert (rows["exact"]["outcome"], rows["exact"]["sensitivity"]) == ("rocked", None)


def test_a_gentle_pulse_leaves_the_block_at_rest(capsys):
    gentle = [*CASE[:4], "--amplitude", "0.2", *CASE[6:]]
    _, rows = compared(capsys, *gentle, "--sources", "exact", "housner")
    told = [(row["outcome"], row["peak_ratio"]) for row in rows.values()]
    assert told == [("at rest", 0.0)] * 2


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


def test_a_block_is_released_from_a_tilt_in_units_of_alpha(capsys):
    """Its first impact comes after a quarter period, the same in every source."""
    options = ["--tilt", "-0.6", "--duration", "2", "--sources"]
    _, found = compared(capsys, *CASE[:4], *options, "exact", "dop853", "pybullet", "mujoco")
    rows = [*found.values()]
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
    row = compared(capsys, *CASE, *start, "--sources", "exact")[1]["exact"]
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
    row = compared(capsys, *squat[1:], "--amplitude", "2.5")[1]["exact"]
    assert (row["valid"], row["min_normal"] < 0.0) == (False, True)
    assert run([*squat, "--amplitude", "2.5"]) == 0
    assert "the pivot would lift off" in capsys.readouterr().out
    slender = ["--amplitude", "1.0", "--omega", "3", "--sources", "exact"]
    assert compared(capsys, *CASE[:4], *slender)[1]["exact"]["valid"] is True
    assert run(["compare", *CASE[:4], *slender]) == 0
    assert "the normal force stays above" in capsys.readouterr().out


def test_half_cycles_replace_the_pulse(capsys):
    names = ["--sources", "exact", "--duration", "3"]
    two, full, three = (
        compared(capsys, *CASE, *pulse, *names)[1]["exact"]["peak_ratio"]
        for pulse in (["--half-cycles", "2"], ["--pulse", "full-sine"], ["--half-cycles", "3"])
    )
    assert two == full != three


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


BY_NUMBERS = [
    *(ZeroDivisionError("float division"), OverflowError(34, "too large"), FloatingPointError()),
    *(MemoryError(), np.linalg.LinAlgError("singular"), ValueError("math domain error")),
    ValueError("samples[3] is inf; it must be a finite number"),
]
BY_MISTAKE = [TypeError("x"), KeyError("x"), AttributeError("x"), ValueError("shapes differ")]


@pytest.mark.parametrize("error", [*BY_NUMBERS, *BY_MISTAKE], ids=repr)
def test_what_arithmetic_raises_is_one_line_and_what_a_mistake_does_is_not(
    error, monkeypatch, capsys
):
    def broken(*_, **__):
        raise error

    monkeypatch.setattr("studies.compare.command.compare", broken)
    line = ["compare", *CASE, "--sources", "exact"]
    if error in BY_MISTAKE:
        with pytest.raises(type(error)):
            run(line)
    else:
        refused(capsys, line, str(error) or type(error).__name__)


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
    assert all(name in text for name in COMMANDS)
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
