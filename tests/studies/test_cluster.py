"""Jobs on a Dask cluster: a real scheduler and real workers, each a process of its own."""

import json
import os
import signal
import subprocess
import sys
import threading
import time
from contextlib import ExitStack, contextmanager

import pandas as pd
import pytest
from commanding import ROOT, refused
from distributed import Client
from given import BLOCK, FULL_SINE

from engines.registry import FURTHER
from studies.cases.refusal import BadInputError
from studies.kit import run as cluster
from studies.kit.jobs import Job, Question, answer
from studies.kit.run import local, on_cluster
from studies.sources.registry import announce

pytestmark = pytest.mark.processes
CASE = Question(system=BLOCK, motion=FULL_SINE)
KNOWN = os.pathsep.join(map(str, (ROOT / "tests", ROOT / "tests/plugin", ROOT)))
DASK = [sys.executable, "-m", "dask"]
PATIENCE_S = 120.0


@contextmanager
def scheduler(folder):
    place = folder / "scheduler.json"
    options = ["--port", "0", "--no-dashboard", "--scheduler-file", str(place)]
    with started("scheduler", *options):
        while not (place.exists() and place.read_text().endswith("}")):
            time.sleep(0.05)
        yield json.loads(place.read_text())["address"]


def working(address, nanny="--no-nanny", **environment):
    options = ("--nthreads", "1", "--no-dashboard")
    return started("worker", address, nanny, *options, **environment)


@contextmanager
def started(*words, **environment):
    known = {**os.environ, "PYTHONPATH": KNOWN, **environment}
    process = subprocess.Popen([*DASK, *words], env=known, stderr=subprocess.DEVNULL)
    try:
        yield process
    finally:
        process.kill()
        process.wait()


def wait_for_workers(address, count):
    with Client(address, set_as_default=False) as client:
        client.wait_for_workers(count, timeout=PATIENCE_S)


def jobs_of(*sources):
    return [Job(labels={}, case=CASE, source=name) for name in sources]


@pytest.fixture(scope="module")
def station(tmp_path_factory):
    with ExitStack() as stack:
        address = stack.enter_context(scheduler(tmp_path_factory.mktemp("station")))
        for _ in range(2):
            stack.enter_context(working(address))
        wait_for_workers(address, 2)
        yield address


def test_rows_are_those_of_this_machine_to_the_bit(station):
    jobs = jobs_of("exact", "rk4", "pybullet", "mujoco", "mujoco:default")
    here, there = (
        pd.DataFrame(dict(rows)).T.sort_index().drop(columns="wall_s")
        for rows in (local(jobs, answer, 1, 60.0), on_cluster(station, 60.0, jobs, answer))
    )
    pd.testing.assert_frame_equal(here, there, check_exact=True)
    assert set(here["outcome"]) == {"rocked"}


def test_a_worker_of_other_code_is_refused(station, monkeypatch):
    made = cluster.makers_of
    monkeypatch.setattr(
        cluster,
        "makers_of",
        lambda *given: {name: {**of, "analytic": "other"} for name, of in made(*given).items()},
    )
    with pytest.raises(BadInputError, match=r"its worker tcp.*: exact: analytic is .* other here"):
        list(on_cluster(station, 60.0, jobs_of("exact"), answer))


def test_an_address_where_nobody_answers_is_refused_and_so_are_jobs_beside_it(tmp_path, capsys):
    for address in ("tcp://127.0.0.1:9", "nowhere", "::::"):
        asked = ["sweep", "--sources", "exact", "--cluster", address, "--out", tmp_path]
        refused(capsys, asked, f"--cluster is {address!r}", "running Dask scheduler")
    refused(capsys, [*asked, "--jobs", "2"], "--jobs is 2", "without --cluster")


@pytest.mark.slow
def test_a_crash_is_a_row_and_costs_no_worker(tmp_path, alone):
    announce("hostile:Crashes", lambda _: "Crashes")
    with scheduler(tmp_path) as address, working(address, **{FURTHER: os.environ[FURTHER]}):
        wait_for_workers(address, 1)
        rows = dict(on_cluster(address, 60.0, jobs_of("Crashes", "exact"), answer))
        assert [rows[number]["outcome"] for number in range(2)] == ["failed", "rocked"]
        assert "SIGSEGV" in rows[0]["message"]


@pytest.mark.slow
def test_a_killed_worker_loses_nothing_and_the_last_one_ends_the_run(tmp_path, monkeypatch):
    with scheduler(tmp_path) as address, working(address) as first, working(address) as second:
        wait_for_workers(address, 2)
        monkeypatch.setattr(cluster, "ALONE_S", 5.0)
        rows = on_cluster(address, 60.0, jobs_of(*["mujoco"] * 40), answer)
        got = [next(rows)]
        first.send_signal(signal.SIGKILL)
        got += list(rows)
        assert sorted(number for number, _ in got) == list(range(40))
        threading.Timer(1.0, second.kill).start()
        with pytest.raises(BadInputError, match="no worker any more"):
            list(on_cluster(address, 60.0, jobs_of(*["mujoco:tuned"] * 400), answer))


@pytest.mark.slow
def test_a_nanny_is_refused(tmp_path):
    with scheduler(tmp_path) as address, working(address, "--nanny"):
        wait_for_workers(address, 1)
        with pytest.raises(BadInputError, match="nanny"):
            list(on_cluster(address, 60.0, jobs_of("exact"), answer))
