"""Processes: what is timed in them, and how they end, at signals, closed streams or few files."""

import ast
import errno
import json
import math
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import numpy as np
import pytest
from commanding import BLOCK as SIZES
from commanding import CASE, PATIENCE_S, python, refused
from given import BLOCK, FULL_SINE

from analytic import SinePulse
from analytic.response import Response
from studies.old.executors import Local
from studies.old.jobs import Job, summary
from studies.old.pool import Pool
from studies.old.refusing import reason
from studies.old.runner import run_jobs
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
from studies.old import signals

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
        "import signal; from studies.old import signals; signals.install();"
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
    assert done.stderr.splitlines() == [
        "rocking: the output cannot be written; No space left on device"
    ]


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


@pytest.mark.slow
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


def job(source, motion=FULL_SINE, **more):
    return Job(labels={}, block=BLOCK, motion=motion, source=source, **more)


def test_a_long_solve_has_a_time_limit_too():
    long = SinePulse(amplitude=0.34 * 9.81, omega=100.0, half_cycles=10**9)
    rows = run_jobs([job("rk4", long)], executor=Local(2, 0.5), reduce=summary)
    assert ["time limit" in row["message"] for row in rows] == [True]


def dies_soon():
    threading.Timer(0.2, os._exit, [3]).start()
    return os.getpid()


def test_a_process_that_ended_between_two_tasks_is_replaced():
    with Pool(1) as pool:
        first = pool.schedule(dies_soon, (), PATIENCE_S).result()
        while Path(f"/proc/{first}").exists():
            time.sleep(0.05)
        time.sleep(0.2)  # and whoever keeps it
        assert pool.schedule(os.getpid, (), PATIENCE_S).result() != first


ASKED = []


def remembers(block, motion, *, duration, times, step=1e-3):
    """Tell what this process was asked so far."""
    ASKED.append((motion.duration, duration, len(times), step))
    return Response.failure(repr(ASKED))


def test_a_long_solve_is_not_timed_while_its_kernels_are_loaded(monkeypatch):
    monkeypatch.setitem(SOURCES, "remembers", Source("solver", remembers))
    slow = SinePulse(amplitude=0.34 * 9.81, omega=1e-5, half_cycles=2)
    window = {"duration": slow.duration, "times": np.arange(100.0)}
    jobs = [job("remembers", slow, **window, options={"step": step}) for step in (1e-9, 1e-8)]
    assert all(asked.needs_process for asked in jobs)
    rows = run_jobs(jobs, executor=Local(1, PATIENCE_S), reduce=summary)
    first, second = (ast.literal_eval(row["message"]) for row in rows)
    # a short question once in each process, and then what was to be timed
    assert first[0][0] * BLOCK.p == pytest.approx(math.pi / 4.0)
    assert first[0][2:] == (3, 1e-3)
    assert first[1:] == [(slow.duration, slow.duration, 100, 1e-9)]
    assert second == [*first, (slow.duration, slow.duration, 100, 1e-8)]


KERNELS = """
import sys
import numpy as np
from analytic import Record, RigidBlock, SinePulse
from analytic.kernels.compiled import Kernel, compile_all
from studies.old.jobs import Job, ask, short
from studies.sources.registry import resolve

def loaded():
    modules = [m for name, m in sys.modules.items() if name.startswith("analytic")]
    return {
        f"{f.__module__}.{f.__name__}": len(f.compiled.signatures)
        for m in modules for f in vars(m).values()
        if isinstance(f, Kernel) and f.compiled.signatures
    }

compile_all()

block = RigidBlock(width=0.5, height=1.5)
pulse = SinePulse(amplitude=0.36 * 9.81, omega=4.0, half_cycles=3)
record = Record(dt=0.01, samples=3.6 * np.sin(0.04 * np.arange(400)))
for name in ("exact", "modified", "rk4", "average-acceleration"):
    for motion in (pulse, record):
        for window in ({}, {"duration": motion.duration + 2.0, "times": np.linspace(0.0, 3.0, 50)}):
            job = Job(labels={}, block=block, motion=motion, source=name, **window)
            quick, source = short(job), resolve(name)
            assert not quick.needs_process
            assert ask(quick, source).outcome.value == "rocked"
            before = loaded()
            assert ask(job, source).outcome.value in ("rocked", "overturned")
            assert before == loaded() != {}, (name, motion, window)
"""


def test_a_short_question_loads_the_kernels_of_the_long_one():
    done = python("-c", KERNELS)
    assert (done.returncode, done.stderr) == (0, "")


def test_settings_of_other_programs_change_nothing(tmp_path):
    plot = tmp_path / "plot.png"
    others = {"MPLBACKEND": "nonsense", "NUMBA_NUM_THREADS": "0"}
    done = python("-m", "studies", *COMPARE, "--plot", plot, env=others)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1
    assert plot.read_bytes().startswith(b"\x89PNG")


def test_the_cause_of_a_command_that_cannot_be_loaded_is_told(tmp_path):
    hidden = "import sys; sys.modules['studies.cases.paper'] = None"
    code = f"{hidden}; from studies.__main__ import main; main()"
    done = python("-c", code, "sweep", "--out", tmp_path)
    assert done.returncode == 2
    assert (
        done.stderr.startswith("rocking: ModuleNotFoundError: ") and "studies.cases" in done.stderr
    )


LONG = 256 * "x"


@pytest.mark.parametrize(
    "arguments",
    [
        ["sweep", "--figure", "6", "--sources", "exact", f"--out={LONG}"],
        ["symptoms", "--engines", "mujoco", "--out", LONG],
        ["report", "--out", LONG],
    ],
)
def test_a_folder_of_too_long_a_name_is_refused_by_its_option(arguments, capsys):
    refused(capsys, arguments, "--out is 'x", "File name too long")


@pytest.mark.parametrize(
    ("arguments", "told"),
    [
        (["--out", "a/b"], "--out is 'a/b'; c/d.csv: No space left on device"),
        (["--out=a/b/c"], "--out is 'a/b/c'; d.csv: No space left on device"),
        (["--record", "x", "a/b/c/d.csv"], "--record is 'a/b/c/d.csv'; No space left on device"),
        (["--out", "elsewhere"], "[Errno 28] No space left on device: 'a/b/c/d.csv'"),
    ],
)
def test_what_is_full_is_told_by_its_option(arguments, told):
    full = OSError(errno.ENOSPC, os.strerror(errno.ENOSPC), "a/b/c/d.csv")
    assert reason(full, ["sweep", *arguments]) == told
