"""How a process ends: signals at any moment, streams that are closed or full, few open files."""

import json
import os
import resource
import signal
from pathlib import Path

import pytest
from commanding import CASE, PATIENCE_S, python

from analytic import RigidBlock, SinePulse
from analytic.response import Response
from studies.kit import signals
from studies.kit.executors import Local
from studies.kit.jobs import Job, summary
from studies.kit.runner import run_jobs
from studies.precision import cost
from studies.sources.registry import SOURCES, Source

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


def tells_what_is_blocked(block, motion, *, duration, times):
    return Response.failure(",".join(sorted(blocked(0.0))))


def blocked(_):
    return {signal.Signals(number).name for number in signal.pthread_sigmask(signal.SIG_BLOCK, [])}


def count_blocked(_):
    return float(len(blocked(0.0) & {"SIGINT", "SIGHUP"}))


def test_the_terminal_s_signals_are_left_to_the_process_that_ends_the_others(monkeypatch):
    monkeypatch.setitem(SOURCES, "tells", Source("engine", tells_what_is_blocked))
    block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=4.0, omega=6.0)
    job = Job(labels={}, block=block, motion=pulse, source="tells")
    rows = run_jobs([job] * 3, executor=Local(2, PATIENCE_S), reduce=summary)
    assert {row["message"] for row in rows} == {"SIGHUP,SIGINT"}
    assert cost.in_a_new_process(count_blocked, 0.0) == 2.0
    assert not blocked(0.0) & {number.name for number in signals.ENDING}


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
