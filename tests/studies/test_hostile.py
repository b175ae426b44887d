"""An engine from outside that does what no engine should: a row "failed", and nothing else."""

import math
import os
import signal
import sys
import time
from functools import partial
from pathlib import Path

import hostile
import pandas as pd
import pytest
from commanding import CASE, PATIENCE_S, python, refused

from analytic import RigidBlock, SinePulse
from engines.registry import FURTHER
from engines.run.drive import simulate_world
from engines.run.monitor import compile_monitor
from engines.scene import Scene
from studies.__main__ import run
from studies.kit.executors import Local
from studies.kit.jobs import Job, summary
from studies.kit.runner import run_jobs
from studies.score import loading
from studies.score import study as score
from studies.sources.registry import SOURCES, Source

pytestmark = pytest.mark.processes

BLOCK, PULSE = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=6.0, omega=6.0)
SAID = {name: said for name, (*_, said) in {**hostile.IN_A_STEP, **hostile.OTHERWISE}.items()}
REASONS = {name: said for name, said in SAID.items() if said}
ANSWERING = [name for name, said in SAID.items() if not said]


def asked(block, motion, *, duration, times, world):
    scene = Scene(system=block, motion=motion)
    there = hostile.world_of(world)(scene, None, 1e-3)
    try:
        return simulate_world(there, scene, 1e-3, there.stepping)
    finally:
        there.close()


def ended(process):
    """Return whether a process has ended, now or soon."""
    for _ in range(50):
        try:
            os.kill(process, 0)
        except ProcessLookupError:
            return True
        time.sleep(0.1)
    return False


@pytest.fixture(scope="module")
def rows(tmp_path_factory):
    """Return the row of each world, all of them asked in the same two processes."""
    note = tmp_path_factory.mktemp("hostile") / "note"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(hostile.NOTE, str(note))
        compile_monitor()
        found = []
        # on a busy machine it takes a second to start processes, and to note them
        for limit_s, endless in ((3.0, True), (PATIENCE_S, False)):
            jobs = []
            for world in SAID:
                if ("time limit" in SAID[world]) == endless:
                    patch.setitem(SOURCES, world, Source("engine", partial(asked, world=world)))
                    jobs.append(Job(labels={}, block=BLOCK, motion=PULSE, source=world))
            found += run_jobs(jobs, executor=Local(2, limit_s), reduce=summary)
    return {row["source"]: row for row in found}, [int(pid) for pid in note.read_text().split()]


@pytest.mark.parametrize("world", REASONS)
def test_whatever_an_engine_does_is_a_failed_row_with_its_reason(world, rows):
    row = rows[0][world]
    assert row["outcome"] == "failed"
    assert row["message"].startswith(REASONS[world])
    assert len(row["message"].splitlines()) == 1
    assert len(row["message"]) <= 1000


@pytest.mark.parametrize("world", ANSWERING)
def test_what_does_no_harm_to_its_answer_is_a_row_like_any_other(world, rows):
    row = rows[0][world]
    assert (row["outcome"], row["message"]) == ("at rest", "")
    assert math.isfinite(row["wall_s"]) and 0.0 < row["wall_s"] < 100.0


def test_what_an_engine_started_is_ended_with_its_process(rows):
    assert len(rows[1]) == 5
    assert [process for process in rows[1] if not ended(process)] == []


HARMFUL = """
import os, signal, sys, time
from hostile import Calm as World
print("a word")
os.system("echo a word")
os.chdir("/")
signal.signal(signal.SIGINT, signal.SIG_IGN)
time.monotonic = time.perf_counter = lambda: "noon"
sys.stdout.close()
os.close(1)
"""
LOADED = {
    "exits": ("import sys; sys.exit()", "cannot be loaded from exits:World: SystemExit"),
    "exits_at_once": ("import os; os._exit(0)", "ended by itself with exit code 0"),
    "interrupts": ("raise KeyboardInterrupt", "KeyboardInterrupt"),
    "crashes": ("import ctypes; ctypes.string_at(0)", "ended by signal SIGSEGV"),
    "loops": ("while True: pass", "not within 2 s"),
    "takes_little": ("def World(scene): pass", "it takes (scene), and what builds a world takes"),
    "not_there": ("import os; World = os.system", "neither a declaration nor what builds a world"),
}
"""Module -> its source, and how it is refused."""


@pytest.fixture
def announced(alone, monkeypatch, tmp_path):
    """Work in a new folder; let what is announced be forgotten."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))


@pytest.mark.parametrize("module", LOADED)
def test_what_harms_while_it_is_loaded_is_refused_in_a_line(module, announced, monkeypatch, capfd):
    source, words = LOADED[module]
    Path(f"{module}.py").write_text(source)
    monkeypatch.setattr(loading, "LOADING_S", 2.0 if module == "loops" else PATIENCE_S)
    line = refused(capfd, ["score", f"{module}:World", "--out", "out"], words)
    assert line.startswith(f"rocking: ENGINE: engine '{module}:World' ")
    assert not Path("out").exists()


@pytest.mark.parametrize("source", ["import sys; sys.exit()", "World = 7"])
def test_an_engine_that_was_announced_and_cannot_be_loaded_is_a_line(source, tmp_path):
    (tmp_path / "mine.py").write_text(source)
    done = python(
        *("-m", "studies", "compare", *CASE, "--sources", "exact"),
        path=[tmp_path],
        env={FURTHER: "mine=mine:World"},
    )
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert line.startswith("rocking: engine 'mine'")


def test_what_an_engine_changes_while_it_is_loaded_is_taken_back(announced, tmp_path, capfd):
    Path("harmful.py").write_text(HARMFUL)
    before = time.perf_counter, sys.stdout, signal.getsignal(signal.SIGINT)
    assert score.known("harmful:World") == "harmful"
    assert (time.perf_counter, sys.stdout, signal.getsignal(signal.SIGINT)) == before
    assert Path.cwd() == tmp_path
    os.write(1, b"written\n")
    assert capfd.readouterr() == ("written\n", "")


@pytest.mark.parametrize("module", ["quits", pytest.param("my_engine", marks=pytest.mark.slow)])
def test_no_engine_and_no_time_limit_ends_in_a_traceback(module, announced, monkeypatch, capfd):
    """Neither an engine that does nothing but exit, nor a limit within which none can answer."""
    pytest.importorskip("pymunk")
    Path("quits.py").write_text("import sys\nclass World:\n    def __init__(self, *_): sys.exit()")
    everything = score.score_jobs

    def some(*asked):
        jobs = {(job.labels["table"], job.source): job for job in everything(*asked)}
        return list(jobs.values())

    monkeypatch.setattr(score, "score_jobs", some)
    limit_s = "1e-9" if module == "my_engine" else "60"
    code = run(["score", f"{module}:World", "--quick", "--out", "out", "--time-limit", limit_s])
    printed = capfd.readouterr()
    assert code == 1
    assert all(line.startswith("failed: ") for line in printed.err.splitlines())
    # a flight of 33 steps may be over before its limit is looked at
    brief = {Path("out", "score-moments.csv")} if module == "my_engine" else set()
    rows = pd.concat([pd.read_csv(path) for path in set(Path("out").glob("score-*.csv")) - brief])
    assert set(rows["outcome"]) == {"failed"}
    reason = "SystemExit" if module == "quits" else "no result within the time limit of 1e-09 s"
    assert set(rows["message"]) == {reason}
    for picture in ("score", "extremes"):
        assert Path("out", f"{picture}.png").exists()
