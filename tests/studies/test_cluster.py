"""Studies on a Dask cluster: a real scheduler and real workers, each a process of its own."""

import json
import signal
import socketserver
import sys
import threading
import time
from concurrent.futures import CancelledError, Future
from contextlib import ExitStack, contextmanager, nullcontext, suppress
from dataclasses import replace
from functools import partial
from pathlib import Path

import dask
import pandas as pd
import pytest
from commanding import wait_for_rows
from dask_station import (
    exits,
    half_held,
    hangs,
    held,
    jobs_of,
    lasts,
    refusal,
    scheduler,
    slow,
    slow_at_first,
    stopped,
    sweeping,
    wait_for_workers,
    working,
)
from distributed import Security
from distributed.comm import CommClosedError
from given import BLOCK, FULL_SINE

from analytic import simulate
from studies.__main__ import run
from studies.old import cluster
from studies.old.cluster import Cluster, ClusterError
from studies.old.jobs import summary
from studies.old.options import Running
from studies.old.plan import fill
from studies.old.runner import run_jobs
from studies.sources.registry import SOURCES, Source, resolve
from studies.validate import STUDY
from studies.validate.study import plan

pytestmark = pytest.mark.processes


@pytest.fixture(autouse=True)
def patience(monkeypatch):
    """Wait for whoever answers, however slow; a test of who does not has less."""
    for limit in ("CONNECT_S", "ANSWER_S"):
        monkeypatch.setattr(cluster, limit, 600.0)


@pytest.fixture(scope="module")
def station(tmp_path_factory):
    """A scheduler and two workers: its address, and the processes."""
    with ExitStack() as stack:
        address, running = stack.enter_context(scheduler(tmp_path_factory.mktemp("station")))
        workers = [stack.enter_context(working(address)) for _ in range(2)]
        wait_for_workers(address, 2)
        yield address, running, workers


def results(folder, running):
    fill(STUDY, plan(3, 3, ["exact", "rk4", "pybullet", "mujoco"]), folder, running)
    return pd.read_csv(folder / "validate.csv", dtype=str).drop(columns="wall_s")


def test_results_are_those_of_this_machine_to_the_bit(station, tmp_path):
    here = results(tmp_path / "here", Running(jobs=1))
    there = results(tmp_path / "there", Running(cluster=station[0]))
    pd.testing.assert_frame_equal(here, there)
    assert set(here["outcome"]) <= {"rocked", "overturned", "at rest"}


@pytest.mark.slow
def test_crashes_and_time_limits_are_rows_and_cost_no_worker(station, monkeypatch):
    for misbehaving in (exits, hangs):
        monkeypatch.setitem(SOURCES, misbehaving.__name__, Source("engine", misbehaving))
    asked = [*jobs_of("exits"), *jobs_of("hangs"), *jobs_of("exact")]
    rows = run_jobs(asked, executor=Cluster(station[0], 6.0), reduce=summary)
    assert [row["outcome"] for row in rows] == ["failed", "failed", "rocked"]
    assert "exit code 3" in rows[0]["message"]
    assert "time limit of 6 s" in rows[1]["message"]


@pytest.mark.slow
def test_what_compiles_itself_does_so_outside_the_time_limit(station, monkeypatch, tmp_path):
    source = Source("engine", slow_at_first, resolve("mujoco").engine)
    assert source.declared.compiles
    monkeypatch.setitem(SOURCES, "slow_at_first", source)
    marker = {"marker": str(tmp_path / "compiled")}
    asked = [replace(job, options=marker) for job in jobs_of("slow_at_first", 2)]
    rows = run_jobs(asked, executor=Cluster(station[0], 3.0), reduce=summary)
    assert [(row["outcome"], row["message"]) for row in rows] == [("rocked", "")] * 2


def test_a_worker_of_another_version_is_refused(station, monkeypatch, tmp_path, capsys):
    """Its code is that by which a results folder knows its own."""
    monkeypatch.setattr(cluster, "everything", lambda: "other code")
    cluster.fitness.cache_clear()
    try:
        line = refusal(station[0], capsys, tmp_path)
    finally:
        cluster.fitness.cache_clear()
    assert "its worker tcp://127.0.0.1:" in line
    assert "code " in line
    assert "there, other code here" in line


def test_a_workers_address_is_no_schedulers(station, tmp_path, capsys):
    first, _ = wait_for_workers(station[0], 2)
    assert "scheduler (TypeError: Worker." in refusal(first, capsys, tmp_path)


@pytest.mark.slow
def test_who_was_stopped_is_not_waited_for(station, monkeypatch, tmp_path, capsys):
    address, running, workers = station
    for limit, process in (("ANSWER_S", workers[0]), ("CONNECT_S", running)):
        with monkeypatch.context() as patch, stopped(process):
            patch.setattr(cluster, limit, 1.0)
            assert "no answer within 1 s" in refusal(address, capsys, tmp_path)
    monkeypatch.setitem(SOURCES, "held", Source("model", held))
    answers = Cluster(address, 10.0)(half_held(tmp_path / "released"))
    assert next(answers)[0] == 0
    with stopped(running):
        monkeypatch.setattr(cluster, "ANSWER_S", 1.0)
        with pytest.raises(ClusterError, match="no answer within 1 s"):
            list(answers)
    (tmp_path / "released").touch()


@pytest.mark.slow
def test_workers_are_needed_and_a_nanny_is_refused(tmp_path, monkeypatch):
    with scheduler(tmp_path) as (address, _):
        with monkeypatch.context() as patch, pytest.raises(ClusterError, match="no workers; start"):
            patch.setattr(cluster, "CONNECT_S", 1.0)
            Cluster(address, 1.0).check()
        with (
            working(address, "--nworkers", 1, "--nanny"),
            pytest.raises(ClusterError, match="nanny"),
        ):
            Cluster(address, 1.0).check()


@pytest.mark.slow
def test_a_killed_worker_loses_nothing(station, monkeypatch):
    monkeypatch.setitem(SOURCES, "slow", Source("model", slow))
    with working(station[0]) as third:
        wait_for_workers(station[0], 3)
        answers = Cluster(station[0], 10.0)(jobs_of("slow", 60))
        got = [next(answers)]
        third.send_signal(signal.SIGKILL)
        got += list(answers)
    assert sorted(number for number, _ in got) == list(range(60))
    assert {response.outcome.value for _, response in got} == {"rocked"}


@pytest.mark.slow
def test_a_killed_scheduler_loses_nothing_and_is_one_line(tmp_path, monkeypatch):
    folder = tmp_path / "out"
    journal = folder / "journal.jsonl"
    arguments = ["sweep", "--figure", "6", "--sources", "held", "--out", str(folder)]
    with (
        scheduler(tmp_path) as (address, running),
        working(address),
        sweeping(*arguments, "--cluster", address) as study,
    ):
        wait_for_rows(folder, study, 2)
        running.kill()
        (line,) = study.communicate()[1].splitlines()
    assert study.returncode == 2
    assert "scheduler has gone" in line
    assert "the same command goes on" in line
    kept = journal.read_text().splitlines()
    # the same source, which holds nothing any more: "/" is there
    monkeypatch.setitem(SOURCES, "held", Source("model", partial(held, until="/")))
    assert run(arguments) == 0
    lines = journal.read_text().splitlines()
    assert lines[: len(kept)] == kept
    keys = [json.loads(line)["key"] for line in lines if '"row"' in line]
    assert len(keys) == len(set(keys)) == 240


@pytest.mark.slow
def test_a_worker_that_is_terminated_soon_ends_with_all_it_started(tmp_path, monkeypatch):
    monkeypatch.setitem(SOURCES, "lasts", Source("engine", lasts))
    note = tmp_path / "note"
    (lasting,) = jobs_of("lasts")
    lasting = replace(lasting, options={"note": str(note)})
    with scheduler(tmp_path) as (address, _), working(address) as ending:
        wait_for_workers(address, 1)
        answers = Cluster(address, 900.0)([*jobs_of("exact"), lasting])
        assert next(answers)[0] == 0
        while not (note.exists() and note.read_text().endswith("\n")):
            time.sleep(0.05)
        ending.send_signal(signal.SIGTERM)
        # a tenth of its time limit; what it takes is a second, and ten where nothing stops a case
        ending.wait(90.0)
        started = [int(word) for word in note.read_text().split()]
        assert [process for process in started if Path(f"/proc/{process}").exists()] == []
        answers.close()


@pytest.mark.slow
def test_a_case_that_kills_every_worker_is_a_row(tmp_path, monkeypatch):
    monkeypatch.setitem(SOURCES, "deadly", Source("model", exits))
    with scheduler(tmp_path) as (address, _), working(address) as first, working(address) as second:
        wait_for_workers(address, 2)
        ((_, response),) = Cluster(address, 10.0)(jobs_of("deadly"))
        assert response.outcome.value == "failed"
        assert "died" in response.message
        assert {first.wait(), second.wait()} == {3}


@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nowhere", "::::", "tcp://"])
def test_an_address_where_nobody_answers(address, tmp_path, capsys):
    assert "scheduler" in refusal(address, capsys, tmp_path)


class Silent(socketserver.BaseRequestHandler):
    """Accepts, and never answers."""

    said = b""

    def handle(self):
        with suppress(ConnectionError):
            self.request.sendall(self.said)
            while self.request.recv(1024):
                pass


class Shell(Silent):
    """Speaks first, as an SSH server does."""

    said = b"SSH-2.0-OpenSSH_9.6\r\n"


@pytest.mark.parametrize(
    ("handler", "limit_s", "reason"),
    [
        (Silent, 1.0, "no answer within 1 s"),
        (Shell, 600.0, "MemoryError"),
    ],
)
def test_a_server_that_is_no_scheduler(handler, limit_s, reason, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(cluster, "CONNECT_S", limit_s)
    with socketserver.ThreadingTCPServer(("127.0.0.1", 0), handler) as serving:
        serving.daemon_threads = True
        threading.Thread(target=serving.serve_forever, daemon=True).start()
        place = "127.0.0.1:{1}".format(*serving.server_address)
        assert reason in refusal(f"tcp://{place}", capsys, tmp_path)
        assert "TLS configuration" in refusal(f"tls://{place}", capsys, tmp_path)
        serving.shutdown()


def test_missing_dask_is_named(monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    with pytest.raises(ClusterError, match=r"rocking\[cluster\]"):
        Cluster("tcp://127.0.0.1:1", 1.0).check()


class Breaking:
    """A client, and its executor: a question is an error, and so is the answer if there is one."""

    nthreads = None

    def __init__(self, status, error, answering=True):
        self.status, self.error, self.answering = status, error, answering

    def sync(self, *_, **__):
        raise self.error

    def get_executor(self, **_):
        return self

    def submit(self, *_):
        future = Future()
        if self.answering:
            future.set_exception(self.error)
        return future


def asked_of(client, monkeypatch):
    """Return the answer to a job that is put to a cluster with this client."""
    monkeypatch.setattr(Cluster, "_client", lambda _: nullcontext(client))
    monkeypatch.setattr(cluster, "LOOK_S", 0.01)
    ((_, response),) = Cluster("tcp://127.0.0.1:1", 1.0)(jobs_of("exact"))
    return response


BROKEN = [CommClosedError("in <TCP>: Stream is closed"), OSError("gone"), CancelledError()]
GONE = [
    ("running", BROKEN[-1], True),
    *(("running", error, False) for error in BROKEN[:2]),
    *((status, error, True) for status in ("connecting", "closed") for error in BROKEN),
]


@pytest.mark.parametrize(("status", "error", "answering"), GONE)
def test_a_connection_that_breaks_is_a_scheduler_that_has_gone(
    status, error, answering, monkeypatch
):
    with pytest.raises(ClusterError, match="scheduler has gone"):
        asked_of(Breaking(status, error, answering), monkeypatch)


def test_an_error_of_a_job_is_a_row(monkeypatch):
    response = asked_of(Breaking("running", OSError("no room")), monkeypatch)
    assert response.outcome.value == "failed"
    assert "no room" in response.message


def certificates(folder):
    """Make a certificate that signs itself, and return the files of authority, it and its key."""
    made = Security.temporary()
    texts = (made.tls_ca_file, made.tls_client_cert, made.tls_client_key)
    folder.mkdir()
    files = [folder / name for name in ("ca.pem", "cert.pem", "key.pem")]
    for file, text in zip(files, texts, strict=True):
        file.write_text(text)
    return files


@contextmanager
def configured(files):
    """Let Dask's own configuration name these files."""
    names = ("ca-file", "client.cert", "client.key")
    places = zip((f"distributed.comm.tls.{name}" for name in names), map(str, files), strict=True)
    with dask.config.set(dict(places)):
        yield


@pytest.mark.slow
def test_an_encrypted_cluster_answers_who_has_its_certificate(tmp_path, capsys):
    ours, others = certificates(tmp_path / "ours"), certificates(tmp_path / "others")
    options = [
        *("--tls-ca-file", ours[0], "--tls-cert", ours[1], "--tls-key", ours[2]),
        *("--protocol", "tls"),
    ]
    with scheduler(tmp_path, *options) as (address, _), working(address, "--no-nanny", *options):
        assert address.startswith("tls://")
        with configured(ours):
            wait_for_workers(address, 1)
            ((_, response),) = Cluster(address, 10.0)(jobs_of("exact"))
            plain = address.replace("tls:", "tcp:")
            with dask.config.set({"distributed.comm.require-encryption": True}):
                assert "encryption required" in refusal(plain, capsys, tmp_path)
        assert response.peak_ratio == simulate(BLOCK, FULL_SINE).peak_ratio
        assert "TLS configuration" in refusal(address, capsys, tmp_path)
        with configured(others):
            assert "certificate does not match" in refusal(address, capsys, tmp_path)
        with configured([tmp_path / "missing.pem"] * 3):
            assert "No such file" in refusal(address, capsys, tmp_path)
