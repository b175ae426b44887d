"""The runner and its results folder: failures, resuming, locks, foreign folders."""

import fcntl
import json
import math
import os
import resource
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from analytic import RigidBlock, SinePulse, simulate
from studies.__main__ import run
from studies.kit.executors import Local
from studies.kit.jobs import Job, summary
from studies.kit.journal import FolderError, open_journal
from studies.kit.provenance import identity
from studies.kit.runner import run_jobs
from studies.sources.registry import SOURCES, Effort, Source, resolve
from studies.sweep import study as sweep

BLOCK = RigidBlock(width=0.5, height=1.5)
PULSE = SinePulse(amplitude=0.4 * 9.81, omega=2.0 * math.pi, half_cycles=2)
HERE = Path(__file__).parent


# sources that misbehave; they stand at the top of the module so that a worker finds them
def exits(block, motion, *, duration, times):
    os._exit(3)


def segfaults(block, motion, *, duration, times):
    os.kill(os.getpid(), signal.SIGSEGV)


def hangs(block, motion, *, duration, times):
    time.sleep(60.0)


def raises(block, motion, *, duration, times):
    raise RuntimeError("the engine\nsaid no")


def slow(block, motion, *, duration, times):
    time.sleep(0.005)
    return simulate(block, motion, duration=duration, times=times)


def full_sweep(folder, room):
    """What a run on a full disk runs: no file may grow beyond `room` bytes."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (room, room))
    slow_sweep(folder)


def slow_sweep(folder):
    """What a killed run runs: figure 6 through a source of 5 ms a case."""
    SOURCES["slow"] = Source("engine", slow)
    arguments = ["sweep", "--figure", "6", "--sources", "slow", "--out", folder, "--jobs", "1"]
    raise SystemExit(run(arguments))


def job(source, **labels):
    return Job(labels=labels, block=BLOCK, motion=PULSE, source=source)


def test_whatever_an_engine_does_becomes_a_row(monkeypatch):
    for misbehaving in (exits, segfaults, hangs, raises, slow):
        monkeypatch.setitem(SOURCES, misbehaving.__name__, Source("engine", misbehaving))
    names = ["exits", "segfaults", "hangs", "raises", "slow", "exact"]
    # the limit also covers a worker's imports, which share the machine with other tests
    rows = run_jobs(
        [job(name) for name in names],
        executor=Local(workers=2, time_limit_s=6.0),
        reduce=summary,
    )
    assert [row["source"] for row in rows] == names
    assert [row["outcome"] for row in rows] == ["failed"] * 4 + ["rocked"] * 2
    assert all(math.isnan(row["peak_ratio"]) for row in rows[:4])
    for row, reason in zip(rows, ("code 3", "SIGSEGV", "limit of 6 s", "said no"), strict=False):
        assert reason in row["message"]
        assert "\n" not in row["message"]


def test_failures_are_tried_again_and_successes_are_not(tmp_path, monkeypatch):
    asked = []

    def sometimes(block, motion, *, duration, times):
        asked.append(len(asked))
        # the first call only loads the source; the second is the job's
        if len(asked) <= 2:
            raise RuntimeError("not yet")
        return simulate(block, motion)

    monkeypatch.setitem(SOURCES, "sometimes", Source("model", sometimes))
    outcomes = []
    for _ in range(3):
        with open_journal(tmp_path, identity("test"), ()) as journal:
            (row,) = run_jobs(
                [job("sometimes")], executor=Local(1, 1.0), reduce=summary, journal=journal
            )
        outcomes.append(row["outcome"])
    assert outcomes == ["failed", "rocked", "rocked"]
    assert len(asked) == 4


def test_a_job_is_known_by_everything_that_changes_it():
    base = job("mujoco")
    wider = RigidBlock(width=0.6, height=1.5)
    bouncy = RigidBlock(width=0.5, height=1.5, restitution=0.9)
    longer = SinePulse(amplitude=PULSE.amplitude, omega=PULSE.omega, half_cycles=3)
    others = [
        job("mujoco:naive"),
        job("pybullet"),
        Job(labels={}, block=wider, motion=PULSE, source="mujoco"),
        Job(labels={}, block=bouncy, motion=PULSE, source="mujoco"),
        Job(labels={}, block=BLOCK, motion=longer, source="mujoco"),
        Job(labels={}, block=BLOCK, motion=PULSE, source="mujoco", duration=2.0),
        Job(labels={}, block=BLOCK, motion=PULSE, source="mujoco", times=np.arange(3.0)),
        Job(labels={}, block=BLOCK, motion=PULSE, source="mujoco", options={"step": 1e-3}),
        Job(labels={"figure": 6}, block=BLOCK, motion=PULSE, source="mujoco"),
    ]
    assert base.key == job("mujoco").key
    assert len({base.key, *(other.key for other in others)}) == len(others) + 1


def test_the_key_knows_which_preset_a_plain_name_means(monkeypatch):
    before = job("mujoco").key
    monkeypatch.setitem(SOURCES, "mujoco", resolve("mujoco:naive"))
    assert job("mujoco").key != before


def lines_of(folder):
    return (folder / "journal.jsonl").read_bytes().splitlines()


def start_slow_sweep(folder, call="slow_sweep({!r})"):
    program = f"import test_runner; test_runner.{call.format(str(folder))}"
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join([str(HERE), str(HERE.parents[1])])}
    return subprocess.Popen(
        [sys.executable, "-c", program],
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def wait_for_rows(folder, process, number):
    journal = folder / "journal.jsonl"
    deadline = time.monotonic() + 40.0
    while not journal.exists() or len(lines_of(folder)) < number:
        assert process.poll() is None, process.stderr.read()
        assert time.monotonic() < deadline
        time.sleep(0.005)


def test_a_killed_run_goes_on_where_it_stopped(tmp_path):
    with start_slow_sweep(tmp_path) as first:
        wait_for_rows(tmp_path, first, 30)
        first.kill()
    finished = lines_of(tmp_path)
    assert 30 <= len(finished) < 241
    with (tmp_path / "journal.jsonl").open("ab") as journal:
        journal.write(b'{"key": "torn in the mid')
    with start_slow_sweep(tmp_path) as second:
        output, errors = second.communicate(timeout=60.0)
    assert (second.returncode, errors) == (0, "")
    assert "not tested" in output
    lines = lines_of(tmp_path)
    assert lines[: len(finished)] == finished
    keys = [json.loads(line)["key"] for line in lines[1:]]
    assert len(keys) == len(set(keys)) == 240
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 240


def test_an_interrupted_run_says_how_to_go_on(tmp_path):
    with start_slow_sweep(tmp_path) as process:
        wait_for_rows(tmp_path, process, 30)
        process.send_signal(signal.SIGINT)
        output, errors = process.communicate(timeout=30.0)
    assert process.returncode == 130
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert "the same command goes on" in errors
    assert len(lines_of(tmp_path)) >= 30


def test_a_full_disk_and_another_run_lose_nothing_that_finished(tmp_path):
    with start_slow_sweep(tmp_path, "full_sweep({!r}, 20_000)") as first:
        output, errors = first.communicate(timeout=60.0)
    assert (first.returncode, output) == (2, "")
    assert len(errors.splitlines()) == 1
    assert "the disk is full" in errors
    assert "the same command goes on" in errors
    # the last line may be torn; the ones before are whole
    finished = lines_of(tmp_path)[:-1]
    assert 30 <= len(finished) < 241
    assert not (tmp_path / "sweep.csv").exists()
    # there is room again; a third run is refused, and the second goes on
    with start_slow_sweep(tmp_path) as second:
        wait_for_rows(tmp_path, second, len(finished) + 5)
        with start_slow_sweep(tmp_path) as third:
            _, errors = third.communicate(timeout=30.0)
        assert third.returncode == 2
        assert len(errors.splitlines()) == 1
        assert "in use by another run" in errors
        _, errors = second.communicate(timeout=60.0)
    assert (second.returncode, errors) == (0, "")
    lines = lines_of(tmp_path)
    assert lines[: len(finished)] == finished
    keys = [json.loads(line)["key"] for line in lines[1:]]
    assert len(keys) == len(set(keys)) == 240


def test_two_runs_never_share_a_folder(tmp_path):
    with (tmp_path / ".lock").open("a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        with pytest.raises(FolderError, match="in use"):
            sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    assert sorted(path.name for path in tmp_path.iterdir()) == [".lock"]


@pytest.mark.parametrize(
    ("change", "named"),
    [({"version": "0.0.9"}, "0.0.9"), ({"journal": 0}, "journal"), ({"code": "old"}, "old")],
)
def test_a_folder_of_another_version_is_left_alone(tmp_path, change, named):
    sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    path = tmp_path / "journal.jsonl"
    header, rest = path.read_bytes().split(b"\n", 1)
    path.write_bytes(json.dumps(json.loads(header) | change).encode() + b"\n" + rest)
    before = {item.name: item.read_bytes() for item in tmp_path.iterdir()}
    with pytest.raises(FolderError, match=named):
        sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    assert {item.name: item.read_bytes() for item in tmp_path.iterdir()} == before


def test_a_folder_grows_and_never_shrinks(tmp_path):
    executor = Local(1, 1.0)
    sweep.sweep([6], ["exact"], tmp_path, executor=executor)
    sweep.sweep([6, 7], ["exact", "modified"], tmp_path, executor=executor)
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 960
    for figures, sources, missing in (
        ([6, 7], ["exact"], "modified"),
        ([6], ["exact", "modified"], "figure 7"),
    ):
        with pytest.raises(FolderError, match=missing):
            sweep.sweep(figures, sources, tmp_path, executor=executor)
    with pytest.raises(FolderError, match="settings"):
        sweep.sweep(
            [6, 7], ["exact", "modified"], tmp_path, executor=executor, effort=Effort(step=1e-2)
        )
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 960


def test_a_strangers_results_are_left_alone(tmp_path):
    (tmp_path / "sweep.csv").write_text("mine\n")
    with pytest.raises(FolderError, match="unknown origin"):
        sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    assert (tmp_path / "sweep.csv").read_text() == "mine\n"


def test_another_provenance_is_left_alone(tmp_path):
    sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    path = tmp_path / "provenance.json"
    for text in (path.read_text().replace('"version": "', '"version": "9.'), "{}", "?"):
        path.write_text(text)
        with pytest.raises(FolderError, match="provenance"):
            sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
        assert path.read_text() == text


def test_a_damaged_journal_is_named(tmp_path):
    sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))
    path = tmp_path / "journal.jsonl"
    lines = path.read_bytes().splitlines(keepends=True)
    lines[5] = b"?\n"
    path.write_bytes(b"".join(lines))
    with pytest.raises(FolderError, match="line 6"):
        sweep.sweep([6], ["exact"], tmp_path, executor=Local(1, 1.0))


def test_a_long_solve_has_a_time_limit_too():
    long = SinePulse(amplitude=0.34 * 9.81, omega=100.0, half_cycles=10**9)
    jobs = [Job(labels={}, block=BLOCK, motion=long, source=name) for name in ("rk4",)]
    rows = run_jobs(jobs, executor=Local(2, 0.5), reduce=summary)
    assert ["time limit" in row["message"] for row in rows] == [True]
