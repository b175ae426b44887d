"""An engine from outside that does what no engine should: a row "failed", and nothing else."""

import math
import os
import sys
import time
from dataclasses import asdict, fields, replace
from functools import partial
from pathlib import Path

import hostile
import pandas as pd
import pytest
import rocking_moreau
from commanding import CASE, PATIENCE_S, python, refused

from analytic import RigidBlock, SinePulse
from engines import ENGINES, registry
from engines.registry import FURTHER
from engines.run.drive import run as drive
from engines.run.drive import simulate_world
from engines.run.monitor import compile_monitor
from engines.scene import Scene
from studies.__main__ import run
from studies.old import foreign
from studies.old.arguments import BadInputError
from studies.old.executors import Local
from studies.old.fingerprint import names_of, reached
from studies.old.identity import Makers
from studies.old.jobs import Job, ask, summary
from studies.old.runner import run_jobs
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
    monkeypatch.setattr(foreign, "LOADING_S", 2.0 if module == "loops" else PATIENCE_S)
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


def test_an_engine_is_declared_where_its_code_is_not_loaded(announced):
    text = Path(rocking_moreau.__file__).read_text()
    words = "lambda scene, it, dt_s: (scene.system, type(it).__module__, it.closing)"
    own = f'name="mine", spring=lambda time, step: {{"friction": time}}, script={words}'
    Path("mine.py").write_text(text.replace('name="moreau"', own))
    with foreign.kept_out():
        name = score.known("mine:ENGINE")
        told, asked = ENGINES[name], partial(Job, labels={}, block=BLOCK, motion=PULSE)
        code = reached(names_of(told.build)).digests()
        made = Makers(ask, summary).of(asked(source="mine:fixed"))
        with pytest.raises(BadInputError, match="friction is -1"):
            asked(source="mine:fixed", options={"settings": {"friction": -1.0}})
        assert told.spring(2.0, 1.0) == {"friction": 2.0}
        scene = Scene(system=BLOCK, motion=PULSE)
        assert told.script(scene, told.best.settings, 1e-3) == (BLOCK, "mine", True)
    assert name == "mine"
    assert "mine" not in sys.modules
    assert "mine.py" in code.keys() & made.keys()
    declared = registry.loaded("mine")
    assert declared.build is sys.modules["mine"].MoreauWorld
    assert reached(names_of(declared.build)).digests() == code
    assert (told.name, told.factors, told.frames) == (declared.name, declared.factors, ("base",))
    for here, there in zip(declared.presets, told.presets, strict=True):
        assert asdict(here.settings) == asdict(there.settings)
        same = {item.name for item in fields(here)} - {"settings"}
        assert all(repr(getattr(here, item)) == repr(getattr(there, item)) for item in same)
    there = replace(told, build=declared.build)
    assert simulate_scene(there) == simulate_scene(declared)


def simulate_scene(engine):
    return summary(None, drive(engine, Scene(system=BLOCK, motion=PULSE))) | {"wall_s": 0.0}


JUDGED = """
from studies.score import study as score
everything = score.score_jobs
def some(*asked):
    return list({(job.labels["table"], job.source): job for job in everything(*asked)}.values())
score.score_jobs = some
from studies.__main__ import main
main()
"""
"""A score with a job of each table and preset, by the command line."""
ON_IMPORT = {
    "ends_soon": "later(1.0, os._exit, 0)",
    "ends_at_exit": "atexit.register(os._exit, 0)",
    "ends_the_second_time": "again() and os._exit(0)",
    "crashes_the_second_time": "again() and ctypes.string_at(0)",
    "sets_a_timer": "signal.setitimer(signal.ITIMER_REAL, 1.0)",
    "leaves_a_thread": "threading.Thread(target=threading.Event().wait).start()",
    "writes_nowhere": "os.write = lambda number, data: len(data)",
    "prints_and_closes": "print('a word'); os.system('echo a word'); os.close(1)",
    "ignores": "[signal.signal(number, signal.SIG_IGN) for number in (1, 2, 15)]",
    "stops_the_clock": "os.chdir('/'); time.monotonic = time.perf_counter = lambda: 'noon'",
}
"""Module -> what it does to the process that imports it."""
IMPORTED = """
import atexit, ctypes, os, signal, threading, time
from pathlib import Path
def later(seconds, call, *given):
    act = lambda: time.sleep(seconds) or call(*given)
    threading.Thread(target=act, daemon=True).start()
def again(place=Path(__file__).with_suffix(".again")):
    return place.exists() or place.touch()
{}
class World:
    def __init__(self, *_):
        raise ValueError("no world")
"""


@pytest.mark.slow
@pytest.mark.parametrize("module", ON_IMPORT)
def test_what_an_engine_does_when_it_is_imported_decides_no_exit_code(module, tmp_path):
    (tmp_path / f"{module}.py").write_text(IMPORTED.format(ON_IMPORT[module]))
    asked = ("score", f"{module}:World", "--quick", "--out", "out", "--require", "failed=0")
    done = python("-c", JUDGED, *asked, cwd=tmp_path)
    if module.endswith("the_second_time"):
        assert (done.returncode, done.stdout) == (2, "")
        (line,) = done.stderr.splitlines()
        assert f"engine '{module}' cannot be loaded: the process " in line
        return
    assert done.returncode == 1
    assert "falls short: landing:failed must be at most 0, and is 1" in done.stdout
    assert "a word" not in done.stdout
    lines = (tmp_path / "out" / "journal.jsonl").read_text().splitlines()
    assert sum(f'"{module}:' in line for line in lines) >= 9


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
