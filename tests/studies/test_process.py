"""The process of a command: signals, closed streams, few files, what other programs set."""

import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from commanding import CASE, python

pytestmark = pytest.mark.processes
COMPARE = ["compare", *CASE, "--sources", "exact", "--json"]
ENDING = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.mark.parametrize("number", ENDING)
def test_a_signal_while_modules_are_loaded_is_no_traceback(number, tmp_path):
    module = tmp_path / "modules" / "numpy.py"
    module.parent.mkdir()
    module.write_text(
        f"import os\nos.kill(os.getpid(), {int(number)})\nraise SystemExit('the signal was lost')"
    )
    asked = ["sweep", "--figure", "6", "--sources", "exact", "--out", tmp_path / "out"]
    done = python("-m", "studies", *asked, path=[module.parent])
    kind = "interrupted" if number == signal.SIGINT else number.name
    assert done.stderr == f"rocking: {kind}\n"
    assert (done.returncode, done.stdout) == (128 + number, "")


@pytest.mark.slow
def test_closed_streams_change_no_exit_code_and_no_result(tmp_path):
    def close():
        for number in range(3):
            os.close(number)

    done = python("-m", "studies", "compare", "--width", "0", before=close)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "")
    asked = ["validate", "--sources", "exact", "mujoco:tuned", "--cases", "5"]
    done = python("-m", "studies", *asked, "--out", tmp_path / "out", before=close)
    assert done.returncode == 0
    assert len((tmp_path / "out" / "errors.csv").read_text().splitlines()) == 11


def test_output_that_cannot_be_written_is_one_line():
    with Path("/dev/full").open("w") as full:
        done = python("-m", "studies", *COMPARE, stdout=full)
    assert done.returncode == 2
    assert done.stderr.splitlines() == ["rocking: [Errno 28] No space left on device"]


def test_too_few_open_files_are_one_line(tmp_path):
    asked = ["sweep", "--figure", "6", "--sources", "exact", "mujoco", "--jobs", "2"]
    done = python(
        *("-m", "studies", *asked, "--out", tmp_path / "out"),
        before=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (13, 13)),
    )
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert "Too many open files" in line


@pytest.mark.parametrize("asked", [["--help"], ["--version"], [*COMPARE[:-1]]])
def test_output_that_nobody_reads_to_its_end_is_no_failure_of_rows(asked):
    command, pipe = [sys.executable, "-m", "studies", *asked], subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 141  # as of any program that a pipe ends


def test_settings_of_other_programs_change_nothing(tmp_path):
    plot = tmp_path / "plot.png"
    others = {"MPLBACKEND": "nonsense", "NUMBA_NUM_THREADS": "0"}
    done = python("-m", "studies", *COMPARE, "--plot", plot, env=others)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1
    assert plot.read_bytes().startswith(b"\x89PNG")
