"""One engine on one page: registered, at a place, or nothing but what builds its world."""

import subprocess
import sys
from collections import Counter

import pandas as pd
import pytest

from analytic import RigidBlock, SinePulse
from engines import ENGINES, registry
from engines.declaration import Stepping
from engines.registry import FURTHER, announce
from studies import respond
from studies.__main__ import run
from studies.kit.jobs import Job
from studies.kit.options import Running
from studies.kit.plan import Plan, fill
from studies.kit.provenance import record_of
from studies.score import STUDY
from studies.score import study as score
from studies.sources import registry as sources
from studies.sources.registry import SOURCES, resolve

MINE = "my_engine:World"
"""In tests/plugin: a class that builds its world, and no declaration."""


@pytest.fixture
def alone(monkeypatch):
    """Let what is announced be forgotten after the test."""
    monkeypatch.setenv(FURTHER, "")
    kept = dict(SOURCES)
    yield
    monkeypatch.undo()
    registry._places.cache_clear()
    registry._declared.cache_clear()
    SOURCES.clear()
    SOURCES.update(kept)


def test_what_builds_a_world_is_an_engine(alone):
    pytest.importorskip("pymunk")
    assert announce(MINE) == "my_engine"
    engine = ENGINES["my_engine"]
    assert [use.stepping for use in engine.presets] == [Stepping.FIXED, Stepping.LANDING]
    assert engine.best.settings.friction == 1.0


def test_an_engine_that_is_announced_is_known_to_processes_that_are_started(alone):
    pytest.importorskip("pymunk")
    announce(MINE)
    code = "from engines import ENGINES; print(ENGINES['my_engine'].presets[-1].name)"
    path = f"import sys; sys.path[:0] = {sys.path!r}; "
    done = subprocess.run([sys.executable, "-c", path + code], capture_output=True, text=True)
    assert (done.stdout, done.stderr) == ("landing\n", "")


def test_an_engine_that_is_announced_makes_no_row_stale(alone, tmp_path, capsys):
    pytest.importorskip("pymunk")
    block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=3.9, omega=6.3)

    def computed(*names):
        jobs = [Job(labels={}, block=block, motion=pulse, source=name) for name in names]
        fill(STUDY, Plan(jobs=jobs, growing={"source": names}), tmp_path, Running(jobs=1))
        return record_of(tmp_path)["runs"][-1]["computed"]

    assert computed("exact", "mujoco") == 2
    sources.announce(MINE)
    assert computed("exact", "mujoco", "my_engine") == 1
    assert capsys.readouterr().err == ""


@pytest.mark.parametrize(
    ("place", "message"),
    [
        ("nothing", "ENGINE is 'nothing'; it must be one of pybullet, mujoco"),
        ("no_such_module:ENGINE", "No module named 'no_such_module'"),
        ("my_engine:Wheel", "has no attribute 'Wheel'"),
        (":World", "it must be like my_package.mine:ENGINE"),
        ("my engine:World", "it must be like my_package.mine:ENGINE"),
        ("rocking_moreau:ENGINE", "is called 'moreau', as another is"),
        ("rocking_moreau:SLACK", "is neither a declaration nor what builds a world"),
    ],
)
def test_what_is_no_engine_is_refused_in_a_line(place, message, alone, tmp_path, capsys):
    assert run(["score", place, "--out", str(tmp_path)]) == 2
    error = capsys.readouterr().err
    assert message in error
    assert error.count("\n") == 1


def test_quick_asks_a_part_of_every_preset():
    quick, full = (score.score_jobs("moreau", some) for some in (True, False))
    counts = Counter(job.labels["table"] for job in full)
    assert counts[score.SWEEP] == 3 * 960
    assert {job.labels["table"] for job in quick} == set(counts)
    assert {job.source.partition(":")[2] for job in quick} == {"naive", "fixed", "landing"}
    assert len(quick) < len(full) / 10


def some_of(jobs):
    """Return two jobs of each table and preset: the first, on which all is well, and another."""
    seen = Counter()
    for job in jobs:
        seen[key := (job.labels["table"], job.source)] += 1
        if seen[key] in (1, 4):
            yield job


def in_this_process(running, ask):
    """Return an executor that starts no process."""

    def executor(asked):
        for number, job in enumerate(asked):
            yield number, ask(job, resolve(job.source))

    return executor


def test_the_page(alone, monkeypatch, tmp_path, capsys):
    """Of an engine that does not declare itself: its numbers are those that `respond` gives."""
    pytest.importorskip("pymunk")
    everything = score.score_jobs
    monkeypatch.setattr(score, "score_jobs", lambda *asked: list(some_of(everything(*asked))))
    monkeypatch.setattr(score, "answer", lambda case, job, source, limit: score.plain(job, source))
    monkeypatch.setattr(Running, "executor", in_this_process)
    assert run(["score", MINE, "--quick", "--out", str(tmp_path)]) in (0, 1)
    page = capsys.readouterr().out
    assert page.strip() == (tmp_path / "score.txt").read_text().strip()
    for words in ("my_engine:landing", "ms a case", "extreme cases", "helped by steps that land"):
        assert words in page
    rows = pd.read_csv(tmp_path / "score-sweep.csv")
    assert sorted(rows["source"].unique()) == ["my_engine:fixed", "my_engine:landing"]
    assert {path.name for path in tmp_path.glob("*.png")} == {"score.png", "extremes.png"}
    job = everything("my_engine", True)[0]
    again = respond(job.source, job.block, job.motion)
    assert rows["peak_ratio"].iloc[0] == again.peak_ratio > 0.0
