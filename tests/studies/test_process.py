"""How a process ends: signals at any moment, streams that are closed or full, few open files."""

import json
import os
import resource
import signal
import subprocess
import sys
from pathlib import Path

import pytest
from commanding import BLOCK as SIZES
from commanding import CASE, PATIENCE_S, python
from given import BLOCK, FULL_SINE

from analytic.response import Response
from studies.kit.executors import Local
from studies.kit.jobs import Job

pytestmark = pytest.mark.processes

COMPARE = ["compare", *CASE, "--sources", "exact", "--json"]
ENDING = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.mark.parametrize(("number", "count"), [*((n, 20) for n in ENDING), (ENDING[0], 1)])
@pytest.mark.parametrize("loading", ["cyclopts", "numpy", "tqdm"])
def test_a_signal_while_modules_are_loaded_is_no_traceback(loading, number, count, tmp_path):
    module = tmp_path / "modules" / f"{loading}.py"
    module.parent.mkdir()
    module.write_text(
        f"import os\nfor _ in range({count}):\n    os.kill(os.getpid(), {int(number)})\n"
        "raise SystemExit('the signal was lost')"
    )
    arguments = ["sweep", "--figure", "6", "--sources", "exact", "--out", tmp_path / "out"]
    done = python("-m", "studies", *arguments, path=[module.parent])
    kind = "interrupted" if number == signal.SIGINT else number.name
    assert done.stderr == f"rocking: {kind}\n"
    assert (done.returncode, done.stdout) == (128 + number, "")


LOST = """
import os, signal
from studies.kit import signals

class Swallows:
    def __del__(self):
        os.kill(os.getpid(), signal.SIGTERM)
        while True:
            pass

signals.install()
try:
    Swallows()
    while True:
        pass
except signals.Ended as stop:
    print(stop.number)
"""


def test_a_signal_that_a_destructor_swallows_ends_the_run_after_all():
    done = python("-c", LOST)
    assert (done.returncode, done.stderr, done.stdout) == (0, "", f"{int(signal.SIGTERM)}\n")


def test_a_signal_that_is_to_be_ignored_stays_so():
    program = (
        "import signal; from studies.kit import signals; signals.install();"
        "print(signal.getsignal(signal.SIGHUP) == signal.SIG_IGN)"
    )
    done = python("-c", program, before=lambda: signal.signal(signal.SIGHUP, signal.SIG_IGN))
    assert done.stdout == "True\n", done.stderr


def tells_what_is_blocked(*_):
    kept = signal.pthread_sigmask(signal.SIG_BLOCK, [])
    return Response.failure(" ".join(sorted(signal.Signals(number).name for number in kept)))


def test_the_terminal_s_signals_are_left_to_the_process_that_ends_the_others():
    """Also by processes that first compiled what an engine needs, as those of PyBullet's cases."""
    jobs = [Job(labels={}, block=BLOCK, motion=FULL_SINE, source="pybullet")] * 3
    local = Local(2, PATIENCE_S, tells_what_is_blocked)
    assert [response.message for _, response in local(jobs)] == ["SIGHUP SIGINT"] * 3
    assert not signal.pthread_sigmask(signal.SIG_BLOCK, []) & {*ENDING}


def closing(*numbers):
    def before():
        for number in numbers:
            os.close(number)

    return before


@pytest.mark.parametrize(
    "numbers",
    [*(pytest.param((one,), marks=pytest.mark.slow) for one in (0, 1, 2)), (0, 1, 2)],
)
def test_closed_streams_change_no_exit_code_and_no_result(numbers, tmp_path):
    before = closing(*numbers)
    out = ["--sources", "exact", "mujoco:fixed", "--cases", "5", "--out", tmp_path / "out"]
    done = python("-m", "studies", *COMPARE, before=before)
    assert (done.returncode, done.stderr) == (0, "")
    assert (done.stdout == "") == (1 in numbers)
    done = python("-m", "studies", "compare", "--width", "0", before=before)
    assert (done.returncode, done.stdout) == (2, "")
    assert (done.stderr == "") == (2 in numbers)
    if numbers == (0, 1, 2):
        assert python("-m", "studies", "validate", *out, before=before).returncode == 0
        lines = (tmp_path / "out" / "journal.jsonl").read_text().splitlines()
        assert [json.loads(line).get("crc") is not None for line in lines] == [True] * (1 + 2 + 10)


def test_output_that_cannot_be_written_is_one_line():
    with Path("/dev/full").open("w") as full:
        done = python("-m", "studies", *COMPARE, stdout=full)
    assert done.returncode == 2
    assert done.stderr.splitlines() == ["rocking: [Errno 28] No space left on device"]


@pytest.mark.parametrize("count", [7, 13])
def test_too_few_open_files_are_one_line(count, tmp_path):
    arguments = ["sweep", "--figure", "6", "--sources", "exact", "mujoco", "--jobs", "2"]
    done = python(
        *("-m", "studies", *arguments, "--out", tmp_path / "out"),
        before=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (count, count)),
    )
    assert (done.returncode, done.stdout) == (2, "")
    assert len(done.stderr.splitlines()) == 1
    assert "Too many open files" in done.stderr
    assert "rows are kept" in done.stderr


def test_the_longest_pulse_fits_into_memory(tmp_path):
    pulse = ["--amplitude", "0.4", "--omega", "60", "--half-cycles", "1000000"]
    few = ["--sources", "mujoco:naive", "--time-limit", "1", "--jobs", "1"]
    done = python(
        *("-m", "studies", "compare", *SIZES, *pulse, *few),
        before=lambda: resource.setrlimit(resource.RLIMIT_DATA, (2 * 10**9,) * 2),
        cwd=tmp_path,
    )
    assert done.returncode == 1
    assert "no result within the time limit" in done.stdout
    assert "MemoryError" not in done.stdout + done.stderr


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
