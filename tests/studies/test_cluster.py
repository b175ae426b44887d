"""Studies on a Dask cluster: a real scheduler and real workers, each a process of its own."""

import json
import math
import os
import signal
import subprocess
import sys
import time
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pandas as pd
import pytest

from analytic import RigidBlock, SinePulse, simulate
from studies.__main__ import run
from studies.kit import cluster
from studies.kit.cluster import Cluster, ClusterError
from studies.kit.executors import Local
from studies.kit.jobs import Job, summary
from studies.kit.journal import Journal
from studies.kit.runner import run_jobs
from studies.sources.registry import SOURCES, Source
from studies.validate import study as validate

HERE = Path(__file__).parent
DASK = [sys.executable, "-m", "dask"]
BLOCK = RigidBlock(width=0.5, height=1.5)
PULSE = SinePulse(amplitude=0.4 * 9.81, omega=2.0 * math.pi, half_cycles=2)


# sources that misbehave; they stand at the top of the module so that a worker finds them
def exits(block, motion, *, duration, times):
    os._exit(3)


def hangs(block, motion, *, duration, times):
    time.sleep(60.0)


def slow(block, motion, *, duration, times):
    time.sleep(0.05)
    return simulate(block, motion, duration=duration, times=times)


@contextmanager
def process(*arguments, **environment):
    path = os.pathsep.join([str(HERE), str(HERE.parents[1])])
    variables = {**os.environ, "PYTHONPATH": path, "PYTHONUNBUFFERED": "1", **environment}
    with subprocess.Popen(
        [*DASK, *map(str, arguments)],
        env=variables,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    ) as running:
        try:
            yield running
        finally:
            running.kill()


@contextmanager
def scheduler(folder):
    """Start a scheduler that gives a case up when two workers died of it; yield its address."""
    file = folder / "scheduler.json"
    options = ("--host", "127.0.0.1", "--port", 0, "--no-dashboard", "--scheduler-file", file)
    allowed = {"DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "1"}
    with process("scheduler", *options, **allowed) as running:
        deadline = time.monotonic() + 40.0
        while not file.exists():
            assert time.monotonic() < deadline
            time.sleep(0.05)
        yield json.loads(file.read_text())["address"], running


def worker(address, *options):
    chosen = options or ("--no-nanny",)
    return process("worker", address, "--nthreads", 1, "--no-dashboard", *chosen)


@pytest.fixture(scope="module")
def station(tmp_path_factory):
    """A scheduler and two workers."""
    with ExitStack() as stack:
        address, _ = stack.enter_context(scheduler(tmp_path_factory.mktemp("station")))
        for _ in range(2):
            stack.enter_context(worker(address))
        yield address


def jobs_of(source, count=1):
    return [Job(labels={"case": n}, block=BLOCK, motion=PULSE, source=source) for n in range(count)]


def results(folder, executor):
    validate.validate(6, 3, ["exact", "rk4", "pybullet", "mujoco"], folder, executor=executor)
    return pd.read_csv(folder / "validate.csv", dtype=str).drop(columns="wall_s")


def test_results_are_those_of_this_machine_to_the_bit(station, tmp_path):
    here = results(tmp_path / "here", Local(1, 60.0))
    there = results(tmp_path / "there", Cluster(station, 60.0))
    pd.testing.assert_frame_equal(here, there)
    assert set(here["outcome"]) <= {"rocked", "overturned", "at rest"}


@pytest.mark.slow
def test_crashes_and_time_limits_are_rows_and_cost_no_worker(station, monkeypatch):
    for misbehaving in (exits, hangs):
        monkeypatch.setitem(SOURCES, misbehaving.__name__, Source("engine", misbehaving))
    asked = [*jobs_of("exits"), *jobs_of("hangs"), *jobs_of("exact")]
    rows = run_jobs(asked, executor=Cluster(station, 6.0), reduce=summary)
    assert [row["outcome"] for row in rows] == ["failed", "failed", "rocked"]
    assert "exit code 3" in rows[0]["message"]
    assert "time limit of 6 s" in rows[1]["message"]


def test_a_worker_of_another_version_is_refused(station, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(cluster, "fitness", lambda: {"code": "another"})
    arguments = ["sweep", "--figure", "6", "--sources", "exact", "--out", str(tmp_path / "new")]
    assert run([*arguments, "--cluster", station]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    assert "another here" in error
    assert not (tmp_path / "new").exists()


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nowhere", "::::", "tcp://"])
def test_an_address_where_nobody_answers_is_one_line(address, tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(cluster, "CONNECT_S", 0.5)
    arguments = ["sweep", "--figure", "6", "--sources", "exact", "--out", str(tmp_path / "new")]
    assert run([*arguments, "--cluster", address]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    for part in ("--cluster", address, "scheduler"):
        assert part in error
    assert not (tmp_path / "new").exists()


def test_missing_dask_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"rocking\[cluster\]"):
        Cluster("tcp://127.0.0.1:1", 1.0).check()


@pytest.mark.slow
def test_workers_are_needed_and_a_nanny_is_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(cluster, "CONNECT_S", 1.0)
    with scheduler(tmp_path) as (address, _):
        with pytest.raises(ClusterError, match="no workers; start one"):
            Cluster(address, 1.0).check()
        monkeypatch.setattr(cluster, "CONNECT_S", 30.0)
        with (
            worker(address, "--nworkers", 1, "--nanny"),
            pytest.raises(ClusterError, match="nanny"),
        ):
            Cluster(address, 1.0).check()


def wait_for_workers(address, count):
    from distributed import Client

    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=40.0)


def killing(running, count, append):
    """Return a Journal.append that kills a process after so many rows."""

    def counted(self, key, row):
        append(self, key, row)
        if len(self.rows) == count:
            running.kill()

    return counted


def test_a_killed_worker_and_a_killed_scheduler_lose_nothing(tmp_path, monkeypatch, capsys):
    monkeypatch.setitem(SOURCES, "slow", Source("model", slow))
    folder = tmp_path / "out"
    arguments = ["sweep", "--figure", "6", "--sources", "slow", "--out", str(folder)]
    with scheduler(tmp_path) as (address, running), worker(address) as first, worker(address):
        wait_for_workers(address, 2)
        answers = Cluster(address, 10.0)(jobs_of("slow", 60))
        got = [next(answers)]
        first.send_signal(signal.SIGKILL)
        got += list(answers)
        assert sorted(number for number, _ in got) == list(range(60))
        assert {response.outcome.value for _, response in got} == {"rocked"}

        with monkeypatch.context() as patch:
            patch.setattr(Journal, "append", killing(running, 20, Journal.append))
            assert run([*arguments, "--cluster", address]) == 2
    error = capsys.readouterr().err
    assert len(error.splitlines()) == 1
    assert "scheduler has gone" in error
    assert "the same command goes on" in error
    kept = (folder / "journal.jsonl").read_text().splitlines()
    assert len(kept) >= 21
    monkeypatch.setitem(SOURCES, "slow", Source("model", simulate))
    assert run(arguments) == 0
    lines = (folder / "journal.jsonl").read_text().splitlines()
    assert lines[: len(kept)] == kept
    keys = [json.loads(line)["key"] for line in lines[1:]]
    assert len(keys) == len(set(keys)) == 240


@pytest.mark.slow
def test_a_case_that_kills_every_worker_is_a_row(tmp_path, monkeypatch):
    monkeypatch.setitem(SOURCES, "deadly", Source("model", exits))
    with scheduler(tmp_path) as (address, _), worker(address) as first, worker(address) as second:
        wait_for_workers(address, 2)
        ((_, response),) = Cluster(address, 10.0)(jobs_of("deadly"))
        assert response.outcome.value == "failed"
        assert "died" in response.message
        assert {first.wait(timeout=10.0), second.wait(timeout=10.0)} == {3}
