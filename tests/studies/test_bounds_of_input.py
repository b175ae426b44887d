"""What asks for more than a computer has, and words that stand for nothing: one line, at once."""

import resource
import subprocess
import sys
import time

import pytest
from commanding import BLOCK, CASE, PULSE, python, refused

EXPORT = ["export", "--engine", "mujoco", "--out", "DIR"]

# (command, what is named, its value, the bound or why)
TOO_MUCH = [
    (["compare", *CASE, "--half-cycles", "1000000000"], "--half-cycles", "1000000000", "memory"),
    (["compare", *CASE, "--half-cycles", "1000001"], "--half-cycles", "1000001", "up to 1000000"),
    ([*EXPORT, *CASE, "--half-cycles", "1000000000"], "--half-cycles", "1000000000", "memory"),
    (["animate", *CASE, "--half-cycles", "1000000000", "--out", "a"], "--half-", "10", "memory"),
    (["compare", *CASE, "--duration", "1e300"], "--duration", "1e+300", "at most 3.278e+05 s"),
    (["compare", *CASE, "--duration", "3.3e5"], "--duration", "330000", "at most 3.278e+05 s"),
    (["compare", *CASE, "--step", "1e-300"], "--step", "'1e-300'", "at least 1e-07"),
    (["compare", *CASE, "--duration", "3e4", "--step", "1e-6"], "--step", "1e-06", "1e+09 steps"),
    ([*EXPORT, *CASE, "--step", "1e-300"], "--step", "'1e-300'", "at least 1e-07"),
    ([*EXPORT, *BLOCK, "--amplitude", "0.4", "--omega", "1e-9"], "--width", "0.5", "at most"),
    (["compare", *BLOCK, "--amplitude", "0.4", "--omega", "1e-140"], "--width", "0.5", "1/p"),
    (["animate", *BLOCK, "--amplitude", "1", "--omega", "1e-9", "--out", "a.gif"], "--", "", "1/p"),
    (["compare", "--width", "1e-99", "--height", "1e-99", *PULSE], "--width", "1e-99", "1/p"),
    (["throughput", "--out", "DIR", "--threads", "1000000000"], "--threads", "10", "at most 1024"),
    (["sweep", "--out", "DIR", "--step", "1e-300"], "--step", "'1e-300'", "at least 1e-07"),
    (["validate", "--out", "DIR", "--step", "9e-8"], "--step", "'9e-8'", "at least 1e-07"),
    (["estimate", "--out", "DIR", "--step", "1e-300"], "--step", "'1e-300'", "at least 1e-07"),
]


@pytest.mark.parametrize(("arguments", "name", "value", "why"), TOO_MUCH)
def test_what_asks_for_too_much_is_one_line_at_once(
    arguments, name, value, why, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    begin = time.process_time()
    refused(capsys, arguments, name, value, why)
    assert time.process_time() - begin < 2.0
    assert not list(tmp_path.iterdir())


def test_the_longest_pulse_fits_into_memory(tmp_path):
    pulse = ["--amplitude", "0.4", "--omega", "60", "--half-cycles", "1000000"]
    few = ["--sources", "mujoco:naive", "--time-limit", "1", "--jobs", "1"]
    done = python(
        *("-m", "studies", "compare", *BLOCK, *pulse, *few),
        before=lambda: resource.setrlimit(resource.RLIMIT_DATA, (2 * 10**9,) * 2),
        cwd=tmp_path,
    )
    assert done.returncode == 1
    assert "no result within the time limit" in done.stdout
    assert "MemoryError" not in done.stdout + done.stderr


NONE = [
    (["compare", *CASE, "--accuracy", "none"], "--accuracy is 'none'", "tight"),
    (["compare", *CASE, "--accuracy", "NULL"], "--accuracy is 'NULL'", "tight"),
    (["compare", *CASE, "--pulse", "none"], "--pulse is 'none'", "half-sine"),
    (["compare", *CASE, "--units", "null"], "--units is 'null'", "gal"),
    (["compare", *CASE, "--baseline", "null"], "--baseline is 'null'", "linear"),
    (["sweep", "--out", "DIR", "--accuracy", "None"], "--accuracy is 'None'", "loose"),
    (["ensemble", "--out", "DIR", "--family", "none"], "--family is 'none'", "ricker"),
    (["--version", "x"], "--version", "alone"),
    (["compare", "--version", "x"], "--version", "alone"),
    (["x", "--version"], "--version", "alone"),
    (["ensemble", "--out", "DIR", "--records", "f", "f"], "--records names 'f' twice", "once"),
]


@pytest.mark.parametrize(("arguments", "named", "allowed"), NONE)
def test_no_word_stands_for_nothing(arguments, named, allowed, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert "Path" not in refused(capsys, arguments, named, allowed)
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    "asked",
    [["--help"], ["compare", "--help"], ["--version"], ["compare", *CASE, "--sources", "exact"]],
)
def test_output_that_nobody_reads_to_its_end_is_no_failure_of_rows(asked):
    command, pipe = [sys.executable, "-m", "studies", *asked], subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 141  # as of any program that a pipe ends


@pytest.mark.parametrize("name", ["thesis.tex", ".hidden", "sweep", "report.html"])
def test_a_report_is_not_written_among_what_is_not_its_own(name, tmp_path, capsys):
    out = tmp_path / "out"
    out.mkdir()
    (out / name).write_text("mine")
    refused(capsys, ["report", "--out", out], "--out is", repr(name))
    assert [path.name for path in out.iterdir()] == [name]


def test_a_report_of_no_known_kind_is_one_line(tmp_path, capsys):
    (tmp_path / "kind.txt").write_bytes(b"\xff\xfe")
    refused(capsys, ["report", "--out", tmp_path])
