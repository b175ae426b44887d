"""Recorded accelerograms: what is read, what is refused, and how."""

import json

import numpy as np
import pytest
from commanding import BLOCK, refused
from records import AT2, COLUMNS, SAMPLES
from scipy.signal import detrend

from analytic import Record, RigidBlock, simulate
from studies.__main__ import run
from studies.cases.accelerograms import UNITS, read_record

HEADER, BODY = AT2["series"][: -len(COLUMNS)], COLUMNS
ASKED = ["compare", *BLOCK]


def written(tmp_path, text):
    path = tmp_path / "motion.txt"
    path.write_text(text)
    return path


@pytest.mark.parametrize("header", ["", "t,a\n", "# a comment\n", "time_s;acc_g\n"])
@pytest.mark.parametrize("separator", [",", ";", " ", "\t", "   "])
def test_tables(header, separator, tmp_path):
    rows = "".join(f"{1 + 0.02 * i:.2f}{separator}{a}\n" for i, a in enumerate(SAMPLES))
    record = read_record(written(tmp_path, header + rows), "g")
    assert record.dt == pytest.approx(0.02, rel=1e-12)
    assert record.duration == pytest.approx(0.12)
    assert record.samples == pytest.approx(9.81 * SAMPLES)


@pytest.mark.parametrize(
    ("names", "unit"),
    [
        ("Time (s), Acceleration (m/s2)", "m/s2"),
        ("Time [sec], Acceleration [m/s²]", "m/s2"),
        ("t_s,acc_g", "g"),
        ("# units: cm/s^2", "cm/s2"),
        ("% UNITS OF CM/SEC/SEC", "cm/s2"),
        ("time (s) acceleration (Gal)", "gal"),
    ],
)
def test_units_that_a_header_states(names, unit, tmp_path):
    path = written(tmp_path, f"{names}\n0 0.5\n0.1 1.5\n")
    record = read_record(path)
    assert record.samples == pytest.approx(UNITS[unit] * np.array([0.5, 1.5]))
    assert record == read_record(path, unit)


def test_times_printed_in_few_decimals_are_equal_steps(tmp_path):
    rows = "".join(f"{i / 256:.4f} {i % 3}\n" for i in range(600))
    record = read_record(written(tmp_path, rows), "m/s2")
    assert record.dt == pytest.approx(1 / 256, rel=1e-4)


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ["--record", "FILE", "--omega", "3"],
            "--omega is 3.0; it may be given only without --record",
        ),
        (["--record", "FILE", "--pulse", "half-sine"], "--pulse is half-sine"),
        (["--record", "FILE", "--half-cycles", "2"], "--half-cycles is 2"),
        (["--record", "FILE", "--scale", "2", "--pga", "1"], "give one or the other"),
        (["--record", "FILE", "--scale", "-2"], "--scale is '-2'; it must be a positive"),
        (["--record", "FILE", "--units", "ft"], "--units"),
        (["--record", "FILE", "--duration", "0.01"], "length of the motion, 0.03 s"),
        (["--record", "/nowhere/at.all"], "it must be a file that can be read"),
        (["--record", "FILE", "--baseline", "spline"], "--baseline"),
        (["--amplitude", "0.4", "--omega", "3", "--baseline", "none"], "only with --record"),
        (["--amplitude", "0.4"], "--omega missing"),
        (["--omega", "3"], "--amplitude missing"),
        (["--amplitude", "0.4", "--omega", "3", "--pga", "1"], "given only with --record"),
    ],
)
def test_contradictions_are_one_clear_line(options, words, tmp_path, capsys):
    path = written(tmp_path, HEADER + BODY)
    asked = [path if item == "FILE" else item for item in options]
    refused(capsys, [*ASKED, *asked], words)


def test_compare_takes_a_record(tmp_path, capsys):
    """A pulse as AT2 file gives the pulse's answer, within its samples' (omega dt)^2/8."""
    times = np.linspace(0.0, 1.0, 401)
    samples = "\n".join(f"{a:.10e}" for a in 0.2 * np.sin(2 * np.pi * times))
    header = HEADER.replace("    7", "401").replace(".0050", ".0025")
    path = written(tmp_path, f"{header}{samples}\n")
    plot = tmp_path / "plot.png"
    arguments = [*ASKED, "--record", str(path), "--sources", "exact", "rk45"]
    assert run([*arguments, "--pga", "0.4", "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [row["peak_ratio"] for row in rows] == pytest.approx([0.385153] * 2, rel=1e-3)
    assert run([*arguments, "--scale", "2", "--plot", str(plot)]) == 0
    text = capsys.readouterr().out
    assert "ground  record, 0.4 g, 1.25 m/s, 401 samples every 0.0025 s, 1 s" in text
    assert plot.stat().st_size > 4_000


def shaken(tmp_path, offset):
    """Write 2 s of a sine of 0.25 g at 1 Hz with an offset [g]."""
    times = np.linspace(0.0, 2.0, 401)
    samples = "\n".join(f"{a:.10e}" for a in 0.25 * np.sin(2.0 * np.pi * times) + offset)
    header = HEADER.replace("    7", "401")
    return written(tmp_path, f"{header}{samples}\n")


def compared(path, capsys, *options):
    arguments = [*ASKED, "--record", str(path), "--sources", "exact", "housner", *options]
    assert run(arguments) == 0
    return capsys.readouterr().out


def test_a_velocity_that_does_not_end_at_zero_is_reported(tmp_path, capsys):
    """An offset of 0.01 g for 2 s is 0.1962 m/s. It is said, and nothing is changed."""
    path = shaken(tmp_path, 0.01)
    said = "the record's velocity ends at 0.196 m/s, 0.21 of its largest, and the base keeps it"
    assert f"\nbase    {said}; --baseline corrects it\n" in compared(path, capsys)
    rows = [json.loads(line) for line in compared(path, capsys, "--json").splitlines()]
    assert [row["message"] for row in rows] == [f"{said}; --baseline corrects it"] * 2
    assert compared(path, capsys, "--json", "--baseline", "none").count(said) == 2
    quiet = shaken(tmp_path, 0.0)
    assert "velocity ends" not in compared(quiet, capsys)
    rows = [json.loads(line) for line in compared(quiet, capsys, "--json").splitlines()]
    assert [row["message"] for row in rows] == ["", ""]


@pytest.mark.parametrize("baseline", ["constant", "linear"])
def test_a_baseline_is_corrected_by_a_named_method(baseline, tmp_path, capsys):
    """As SciPy's detrend does, before the record is scaled; and the answer says so."""
    path = shaken(tmp_path, 0.03)
    left = detrend(read_record(path).samples, type=baseline)
    record = Record(dt=0.005, samples=left).scaled_to(0.35 * 9.81)
    expected = simulate(RigidBlock(width=0.5, height=1.5), record).peak_ratio
    options = ["--baseline", baseline, "--pga", "0.35", "--json"]
    row = json.loads(compared(path, capsys, *options).splitlines()[0])
    assert row["peak_ratio"] == pytest.approx(expected, rel=1e-9)
    assert row["message"].startswith(f"baseline corrected by detrend, {baseline}")
    text = compared(path, capsys, *options[:-1])
    assert f"\nbase    baseline corrected by detrend, {baseline}" in text


def test_nothing_but_a_trend_is_refused(tmp_path, capsys):
    path = written(tmp_path, "# units: g\n0 0.3\n0.1 0.3\n0.2 0.3\n")
    asked = [*ASKED, "--record", path, "--baseline", "constant", "--pga", "1"]
    refused(capsys, asked, "--record: the record is its own constant trend")
