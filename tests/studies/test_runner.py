"""The runner and its results folder: failures, resuming, locks, foreign folders."""

import os
import resource
import signal
import subprocess
import sys
import time
from functools import partial
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from commanding import HEAD, PATIENCE_S, wait_for_rows
from given import BLOCK, FULL_SINE

from analytic import RigidBlock, SinePulse, simulate
from studies.__main__ import run
from studies.old import signals
from studies.old.executors import Local
from studies.old.identity import Makers
from studies.old.jobs import Job, ask, summary
from studies.old.journal import FolderError, open_journal, seal, unseal
from studies.old.options import Running
from studies.old.plan import fill
from studies.old.provenance import subject
from studies.old.runner import run_jobs
from studies.sources.registry import SOURCES, Effort, Source, resolve
from studies.sweep import STUDY
from studies.sweep import study as sweep

pytestmark = pytest.mark.processes

HERE = Path(__file__).parent
slow = partial(pytest.param, marks=pytest.mark.slow)
"""What is one more of a kind whose first is asked quickly."""
SMALL = sweep.plan([6], ["exact"])
ALONE = Running(jobs=1, time_limit=1.0)
ANSWERED = []
FREE = 30
"""Cases that the source `waits` answers before it waits."""


def waits(block, motion, *, duration, times):
    """Answer FREE cases, then wait until the file that GATE names is there."""
    ANSWERED.append(motion)
    while len(ANSWERED) > FREE and not Path(os.environ["GATE"]).exists():
        time.sleep(0.01)
    return simulate(block, motion, duration=duration, times=times)


def whole_sweep(folder):
    """What a run in another process runs: figure 6 through the source that waits."""
    SOURCES["waits"] = Source("engine", waits)
    arguments = ["sweep", "--figure", "6", "--sources", "waits", "--out", folder, "--jobs", "1"]
    for number in signals.ENDING:
        # whoever runs the tests may ignore it
        signal.signal(number, signal.SIG_DFL)
    signals.install()
    raise SystemExit(run([*arguments, "--time-limit", "3600"]))


def plain_sweep(folder):
    """The same without its pictures."""
    sweep.drawn = lambda *_: {}
    whole_sweep(folder)


def sweep_on_a_full_disk(folder):
    """The same where no file may grow beyond 20 kB."""
    resource.setrlimit(resource.RLIMIT_FSIZE, (20_000, 20_000))
    whole_sweep(folder)


def job(source, **labels):
    return Job(labels=labels, block=BLOCK, motion=FULL_SINE, source=source)


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
        with open_journal(tmp_path, subject("test"), ()) as journal:
            (row,) = run_jobs(
                [job("sometimes")],
                executor=Local(1, 1.0),
                reduce=summary,
                journal=journal,
                makers=Makers(ask, summary),
            )
        outcomes.append(row["outcome"])
    assert outcomes == ["failed", "rocked", "rocked"]
    assert len(asked) == 4


def test_a_job_is_known_by_everything_that_changes_it():
    base = job("mujoco")
    wider = RigidBlock(width=0.6, height=1.5)
    bouncy = RigidBlock(width=0.5, height=1.5, restitution=0.9)
    longer = SinePulse(amplitude=FULL_SINE.amplitude, omega=FULL_SINE.omega, half_cycles=3)
    others = [
        job("mujoco:naive"),
        job("pybullet"),
        Job(labels={}, block=wider, motion=FULL_SINE, source="mujoco"),
        Job(labels={}, block=bouncy, motion=FULL_SINE, source="mujoco"),
        Job(labels={}, block=BLOCK, motion=longer, source="mujoco"),
        Job(labels={}, block=BLOCK, motion=FULL_SINE, source="mujoco", duration=2.0),
        Job(labels={}, block=BLOCK, motion=FULL_SINE, source="mujoco", times=np.arange(3.0)),
        Job(labels={}, block=BLOCK, motion=FULL_SINE, source="mujoco", options={"step": 1e-3}),
        Job(labels={"figure": 6}, block=BLOCK, motion=FULL_SINE, source="mujoco"),
    ]
    assert base.key == job("mujoco").key
    assert len({base.key, *(other.key for other in others)}) == len(others) + 1


def test_the_key_knows_which_preset_a_plain_name_means(monkeypatch):
    before = job("mujoco").key
    monkeypatch.setitem(SOURCES, "mujoco", resolve("mujoco:naive"))
    assert job("mujoco").key != before


def lines_of(folder):
    return (folder / "journal.jsonl").read_bytes().splitlines()


def start(folder, function=whole_sweep):
    """Start a sweep in a process of its own; its gate is a file beside the folder."""
    program = f"import test_runner; test_runner.{function.__name__}({str(folder)!r})"
    known = os.pathsep.join(map(str, (HERE, HERE.parent, HERE.parents[1])))
    return subprocess.Popen(
        [sys.executable, "-c", program],
        env={**os.environ, "PYTHONPATH": known, "GATE": str(gate_of(folder))},
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )


def gate_of(folder):
    return folder.with_name(f"{folder.name}.gate")


def keys_of(lines):
    return [unseal(line)["key"] for line in lines[HEAD:]]


def finish(folder, function=whole_sweep):
    """Run the sweep to its end; return what it says."""
    gate_of(folder).touch()
    with start(folder, function) as process:
        output, errors = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, errors) == (0, "")
    return output


def refusal_of(process):
    """Return the one line with which a sweep ends that cannot go on."""
    output, errors = process.communicate(timeout=PATIENCE_S)
    assert (process.returncode, output) == (2, "")
    (line,) = errors.splitlines()
    return line


def test_a_killed_run_goes_on_where_it_stopped(tmp_path):
    folder = tmp_path / "out"
    with start(folder) as first:
        wait_for_rows(folder, first, FREE)
        first.kill()
    finished = lines_of(folder)
    assert len(finished) == HEAD + FREE
    with (folder / "journal.jsonl").open("ab") as journal:
        journal.write(b'{"crc": "00000000", "key": "torn in the mid')
    assert "not tested" in finish(folder)
    lines = lines_of(folder)
    assert lines[: len(finished)] == finished
    assert len(keys_of(lines)) == len(set(keys_of(lines))) == 240
    assert len(pd.read_csv(folder / "sweep.csv")) == 240


@pytest.mark.parametrize("number", [signal.SIGINT, *map(slow, (signal.SIGTERM, signal.SIGHUP))])
def test_an_interrupted_run_says_how_to_go_on(number, tmp_path):
    folder = tmp_path / "out"
    with start(folder) as process:
        wait_for_rows(folder, process, FREE)
        process.send_signal(number)
        output, errors = process.communicate(timeout=PATIENCE_S)
    assert process.returncode == 128 + number
    assert output == ""
    assert len(errors.splitlines()) == 1
    assert "of 240 rows are kept" in errors
    assert "the same command goes on" in errors
    assert len(lines_of(folder)) == HEAD + FREE


@pytest.mark.slow
def test_a_full_disk_loses_nothing_that_finished(tmp_path):
    folder = tmp_path / "out"
    gate_of(folder).touch()
    with start(folder, sweep_on_a_full_disk) as first:
        line = refusal_of(first)
    assert "the disk is full" in line
    assert "the same command goes on" in line
    # the last line may be torn; the ones before are whole
    finished = lines_of(folder)[:-1]
    assert 30 <= len(finished) < HEAD + 240
    assert not (folder / "sweep.csv").exists()
    # there is room again
    finish(folder, plain_sweep)
    lines = lines_of(folder)
    assert lines[: len(finished)] == finished
    assert len(keys_of(lines)) == len(set(keys_of(lines))) == 240


def test_a_second_run_is_refused_while_the_first_one_goes_on(tmp_path):
    folder = tmp_path / "out"
    with start(folder, plain_sweep) as first:
        wait_for_rows(folder, first, FREE)
        with start(folder) as second:
            assert "in use by another run" in refusal_of(second)
        gate_of(folder).touch()
        _, errors = first.communicate(timeout=PATIENCE_S)
    assert (first.returncode, errors) == (0, "")
    assert len(pd.read_csv(folder / "sweep.csv")) == 240


@pytest.mark.parametrize("what", ["the folder", slow("its files")])
def test_a_folder_that_is_removed_meanwhile_is_no_success(what, tmp_path):
    folder = tmp_path / "out"
    with start(folder) as process:
        wait_for_rows(folder, process, FREE)
        for path in folder.iterdir():
            path.unlink()
        if what == "the folder":
            folder.rmdir()
        gate_of(folder).touch()
        line = refusal_of(process)
    assert "removed during the run" in line
    assert "kept" not in line


@pytest.mark.parametrize(
    ("change", "named"),
    [
        ({"study": "contact"}, 'study: "contact" there, "sweep" here'),
        ({"journal": 0}, "journal: 0 there"),
        ({"settings": {"step": 0.1}}, "settings step: 0.1 there, null here"),
    ],
)
def test_a_folder_of_something_else_is_left_alone(tmp_path, change, named):
    fill(STUDY, SMALL, tmp_path, ALONE)
    path = tmp_path / "journal.jsonl"
    header, rest = path.read_bytes().split(b"\n", 1)
    path.write_bytes(seal(unseal(header) | change) + rest)
    before = {item.name: item.read_bytes() for item in tmp_path.iterdir()}
    with pytest.raises(FolderError, match=named):
        fill(STUDY, SMALL, tmp_path, ALONE)
    assert {item.name: item.read_bytes() for item in tmp_path.iterdir()} == before


def test_a_folder_grows_and_never_shrinks(tmp_path):
    fill(STUDY, sweep.plan([6], ["exact"]), tmp_path, ALONE)
    fill(STUDY, sweep.plan([6, 7], ["exact", "modified"]), tmp_path, ALONE)
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 960
    for figures, sources, missing in (
        ([6, 7], ["exact"], "modified"),
        ([6], ["exact", "modified"], "figure 7"),
    ):
        with pytest.raises(FolderError, match=missing):
            fill(STUDY, sweep.plan(figures, sources), tmp_path, ALONE)
    with pytest.raises(FolderError, match="settings"):
        fill(STUDY, sweep.plan([6, 7], ["exact", "modified"], Effort(step=1e-2)), tmp_path, ALONE)
    assert len(pd.read_csv(tmp_path / "sweep.csv")) == 960


def test_another_provenance_is_left_alone(tmp_path):
    fill(STUDY, SMALL, tmp_path, ALONE)
    path = tmp_path / "provenance.json"
    for text in (path.read_text().replace('"study": "', '"study": "a '), "{}", "?"):
        path.write_text(text)
        with pytest.raises(FolderError, match="provenance"):
            fill(STUDY, SMALL, tmp_path, ALONE)
        assert path.read_text() == text
