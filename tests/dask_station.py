"""A Dask scheduler and workers of the tests' own, each a process, and sources that misbehave."""

import json
import os
import signal
import subprocess
import sys
import time
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

from commanding import refused
from distributed import Client
from given import BLOCK, FULL_SINE

from analytic import simulate
from studies.old.jobs import Job

HERE = Path(__file__).parent
KNOWN = os.pathsep.join(map(str, (HERE, HERE / "plugin", HERE.parent)))
WITH_TESTS = {**os.environ, "PYTHONPATH": KNOWN}
DASK = [sys.executable, "-m", "dask"]


# sources that misbehave; they stand at the top of the module so that a worker finds them
def exits(block, motion, *, duration, times):
    os._exit(3)


def hangs(block, motion, *, duration, times):
    time.sleep(60.0)


def lasts(block, motion, *, duration, times, note):
    """Start somebody, and wait for nobody; neither listens to a SIGTERM."""
    signal.signal(signal.SIGTERM, signal.SIG_IGN)
    child = subprocess.Popen(["sleep", "1000"], start_new_session=True)
    Path(note).write_text(f"{os.getpid()} {child.pid}\n")
    time.sleep(1000.0)


def slow(block, motion, *, duration, times):
    time.sleep(0.05)
    return simulate(block, motion, duration=duration, times=times)


def held(block, motion, *, duration, times, until="/nowhere"):
    """Answer about slow pulses at once, and about no other until there is a file."""
    while motion.omega > block.p and not Path(until).exists():
        time.sleep(0.05)
    return simulate(block, motion, duration=duration, times=times)


def slow_at_first(block, motion, *, duration, times, marker):
    """Take four seconds where nothing was compiled yet."""
    if not Path(marker).exists():
        time.sleep(4.0)
        Path(marker).touch()
    return simulate(block, motion, duration=duration, times=times)


@contextmanager
def process(*arguments, **environment):
    with subprocess.Popen(
        [*DASK, *map(str, arguments)],
        env=WITH_TESTS | environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as running:
        try:
            yield running
        finally:
            running.kill()


@contextmanager
def scheduler(folder, *options):
    """Start a scheduler that gives a case up when two workers died of it; yield its address."""
    file = folder / "scheduler.json"
    here = ("--host", "127.0.0.1", "--port", 0, "--no-dashboard", "--scheduler-file", file)
    allowed = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
    with process("scheduler", *here, *options, **allowed) as running:
        # it is there before it is written
        while not file.exists() or not file.read_text().endswith("}"):
            assert running.poll() is None
            time.sleep(0.05)
        yield json.loads(file.read_text())["address"], running


def working(address, *options):
    chosen = options or ("--no-nanny",)
    return process("worker", address, "--nthreads", 1, "--no-dashboard", *chosen)


@contextmanager
def stopped(running):
    """Stop a process meanwhile."""
    running.send_signal(signal.SIGSTOP)
    try:
        yield
    finally:
        running.send_signal(signal.SIGCONT)


def wait_for_workers(address, count):
    """Wait for workers, and return the address of each."""
    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count)
        return list(client.nthreads())


def jobs_of(source, count=1):
    return [
        Job(labels={"case": n}, block=BLOCK, motion=FULL_SINE, source=source) for n in range(count)
    ]


def half_held(until):
    """Return two jobs, of which `held` answers one."""
    (fast,) = jobs_of("held")
    fast = replace(fast, labels={"case": 1}, options={"until": str(until)})
    return [replace(fast, labels={"case": 0}, motion=replace(FULL_SINE, omega=0.5 * BLOCK.p)), fast]


def refusal(address, capsys, folder):
    """Return the one line with which a study on this cluster is refused."""
    arguments = ["sweep", "--figure", "6", "--sources", "exact", "--out", str(folder / "new")]
    line = refused(capsys, [*arguments, "--cluster", address], f"--cluster is {address!r}")
    assert not (folder / "new").exists()
    return line


SWEEP = """
import sys
import dask_station
from studies.__main__ import run
from studies.sources.registry import SOURCES, Source
SOURCES["held"] = Source("model", dask_station.held)
sys.exit(run(sys.argv[1:]))
"""


@contextmanager
def sweeping(*arguments):
    """Run the command line in a process that knows the source `held`."""
    with subprocess.Popen(
        [sys.executable, "-c", SWEEP, *arguments], env=WITH_TESTS, stderr=subprocess.PIPE, text=True
    ) as running:
        try:
            yield running
        finally:
            running.kill()
