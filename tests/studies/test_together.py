"""Batches: the rows of single runs, whatever happens to a batch or to one of its worlds."""

import os
import subprocess
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import rocking_batch
from commanding import HEAD, PATIENCE_S, wait_for_rows
from dask_station import process, scheduler, wait_for_workers
from declared import announced
from given import BLOCK, pulse
from rocking_batch import CRASHING, HANGING, PAUSE_S, RAISING, SLOW, SPOILT

from analytic import RigidBlock
from engines import ENGINES, registry
from engines.run.drive import run as run_alone
from studies.__main__ import run
from studies.kit.cluster import Cluster
from studies.kit.executors import Local, batches
from studies.kit.identity import Makers
from studies.kit.jobs import Job, ask, summary
from studies.kit.runner import run_jobs
from studies.sources.registry import scene_of

pytestmark = pytest.mark.processes

HERE = Path(__file__).parent
WIDE = RigidBlock(width=0.7, height=1.5)
MOTIONS = [pulse(onsets, 3.0, 2) for onsets in (0.9, 1.1, 1.3, 1.5, 1.7)]
VALIDATE = ["validate", "--cases", "13", "--step", "0.02", "--sources", "looped:fixed", "--out"]


@pytest.fixture(autouse=True)
def note(tmp_path, monkeypatch):
    """Announce the engine, and return the file in which its batches write themselves down."""
    monkeypatch.setenv(rocking_batch.NOTE, str(tmp_path / "note"))
    with announced("looped", "rocking_batch:ENGINE"):
        yield tmp_path / "note"


def job(number=0, block=BLOCK, source="looped:fixed", **more):
    options = {"step": 0.01, **more.pop("options", {})}
    motion = more.pop("motion", MOTIONS[number % len(MOTIONS)])
    return Job(
        labels={"case": number}, block=block, motion=motion, source=source, options=options, **more
    )


def sizes(note):
    """Return how many worlds each batch had."""
    return sorted(int(line.split()[1]) for line in note.read_text().splitlines())


def rows_of(jobs, workers=1, limit_s=PATIENCE_S, ask=ask):
    def reduce(job, response):
        return {**summary(job, response), "events": repr((response.impacts, response.history))}

    rows = run_jobs(jobs, executor=Local(workers, limit_s, ask), reduce=reduce)
    return [{**row, "wall_s": 0.0} for row in rows]


def asked_alone(job, source):
    return ask(job, source)


@pytest.mark.parametrize("workers", [pytest.param(1, marks=pytest.mark.slow), 2])
def test_a_batch_gives_the_rows_of_single_runs_to_the_bit(workers, note):
    jobs = [
        *(job(number) for number in range(5)),
        *(job(number, WIDE, options={"step": 0.02, "density": 7.0}) for number in range(4)),
        job(9, options={"start": (0.1, -0.2)}),
        job(10, duration=4.0, times=np.linspace(0.0, 4.0, 9)),
        job(11, options={"max_steps": 100}),
    ]
    together = rows_of(jobs, workers)
    assert sizes(note) == {1: [4, 4, 4], 2: [3, 3, 3, 3]}[workers]
    one_by_one = rows_of(jobs, ask=asked_alone)
    assert repr(together) == repr(one_by_one)  # where a nan is equal to a nan
    assert {row["outcome"] for row in together} >= {"at rest", "rocked", "overturned", "failed"}


def test_what_is_asked_otherwise_is_no_part_of_a_batch():
    jobs = [
        *(job(number) for number in range(2)),
        *(job(number, options={"friction": 0.7}) for number in range(3)),
        *(job(number, options={"settings": {"closing": False}}) for number in range(2)),
        *(job(number, source="looped:naive") for number in range(2)),
        *(job(number, source="looped") for number in range(2)),
        *(job(number, source="moreau:fixed") for number in range(2)),
        *(job(number, options={"time_limit_s": 9.0}) for number in range(2)),
        job(0, options={"friction": 0.9}),
    ]
    found = batches(dict(enumerate(jobs)), workers=1)
    assert found == [[0, 1], [2, 3, 4], [5, 6], [7, 8]]
    # steps that land are not known beforehand, another engine knows no batch, a run that looks at
    # the clock has its own, and one alone is not together


def test_a_world_that_fails_is_its_own_row(note):
    rows = rows_of([job(n, options={"density": SPOILT if n == 2 else 1e3}) for n in range(5)])
    assert sizes(note) == [5]
    assert [row["outcome"] == "failed" for row in rows] == [n == 2 for n in range(5)]
    assert rows[2]["message"] == "the engine's state is not finite"
    assert rows[2]["steps"] == 1


@pytest.mark.parametrize("trap", [RAISING, CRASHING])
def test_a_batch_that_fails_is_asked_one_by_one(trap, note):
    jobs = [job(n, options={"density": trap if n == 2 else 1e3}) for n in range(5)]
    rows = rows_of(jobs)
    assert sizes(note) == [1, 1, 1, 1, 1, 5]
    assert "failed" not in {row["outcome"] for row in rows}  # by itself it does no harm


@pytest.mark.slow
def test_a_time_limit_holds_for_each_of_a_batch(note):
    """What takes two limits for five has time for five; what takes for ever is one row."""
    slow = [job(n, options={"density": SLOW}) for n in range(5)]
    rows = rows_of(slow, limit_s=2.5 * PAUSE_S)
    assert sizes(note) == [5]
    assert "failed" not in {row["outcome"] for row in rows}
    hang = [job(n, options={"density": HANGING if n else 1e3}) for n in range(2)]
    first, second = rows_of(hang, limit_s=2.5)
    assert first["outcome"] == "at rest"
    assert second["message"] == "no result within the time limit of 2.5 s"


def killed_run(folder, gate):
    """Run a study whose second batch waits, and kill it when the rows of the first are kept."""
    program = "import sys; from studies.__main__ import run; sys.exit(run(sys.argv[1:]))"
    known = os.pathsep.join(map(str, (HERE.parent / "plugin", HERE.parents[1])))
    command = [sys.executable, "-c", program, *VALIDATE, str(folder)]
    environment = {**os.environ, "PYTHONPATH": known, rocking_batch.GATE: str(gate)}
    with subprocess.Popen([*command, "--jobs", "1"], env=environment) as process:
        wait_for_rows(folder, process, 5)
        process.kill()
    return (folder / "journal.jsonl").read_bytes().splitlines()


@pytest.mark.slow
def test_a_run_that_is_killed_in_a_batch_loses_that_batch_alone(tmp_path, note):
    folder, whole = tmp_path / "out", tmp_path / "whole"
    kept = killed_run(folder, tmp_path / "gate")
    assert len(kept) == HEAD + 5
    note.unlink()
    for place in (folder, whole):
        assert run([*VALIDATE, str(place), "--jobs", "2"]) == 0
    assert sizes(note) == [3, 3, 3, 4, 4, 4]
    assert (folder / "journal.jsonl").read_bytes().splitlines()[: len(kept)] == kept
    resumed, at_once = (
        pd.read_csv(place / "validate.csv", dtype=str).drop(columns="wall_s")
        for place in (folder, whole)
    )
    pd.testing.assert_frame_equal(resumed, at_once)


def test_a_row_depends_on_what_makes_batches(monkeypatch):
    makers = Makers(ask, summary)
    found = makers.of(job())
    assert {"tests/plugin/rocking_batch.py", "engines/run/batch.py"} <= found.keys()
    assert "engines/run/batch.py" not in makers.of(job(source="mujoco:fixed"))
    object.__setattr__(ENGINES["looped"], "most_worlds", 7)
    try:
        assert Makers(ask, summary).of(job()) == found  # a row is the same in any company
    finally:
        object.__setattr__(ENGINES["looped"], "most_worlds", 5)


def test_one_world_by_itself_is_a_world():
    asked = job(2)
    scene = scene_of(BLOCK, asked.motion, "fixed", step=0.01)
    one, other = run_alone("looped", scene), run_alone("moreau", scene)
    assert one.outcome.value == "rocked"
    assert (one.peak_ratio, one.impacts, one.steps) == (
        other.peak_ratio,
        other.impacts,
        other.steps,
    )


@pytest.mark.slow
def test_a_cluster_is_given_batches_too(tmp_path, note):
    engine = {registry.FURTHER: os.environ[registry.FURTHER], rocking_batch.NOTE: str(note)}
    options = ("--nthreads", 1, "--no-dashboard", "--no-nanny")
    jobs = [job(n, options={"density": RAISING if n == 2 else 1e3}) for n in range(7)]
    with scheduler(tmp_path) as (address, _), process("worker", address, *options, **engine):
        wait_for_workers(address, 1)
        found = dict(Cluster(address, PATIENCE_S)(jobs))
    assert sizes(note) == [1, 1, 1, 1, 3, 4]
    expected = [ask(each, each.asked) for each in jobs]
    assert [found[n].peak_ratio for n in range(7)] == [each.peak_ratio for each in expected]
