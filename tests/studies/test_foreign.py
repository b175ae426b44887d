"""Code of other packages: loaded in processes of its own, whatever it does when it is imported."""

import sys
from dataclasses import asdict, fields
from functools import partial
from pathlib import Path

import pytest
import rocking_moreau
from commanding import CASE, python, refused
from given import BLOCK, FULL_SINE

from engines import ENGINES, registry
from engines.registry import FURTHER
from engines.scene import Scene
from studies import score
from studies.cases.refusal import BadInputError
from studies.kit import foreign
from studies.kit.identity import maker_of
from studies.kit.jobs import Job, Question, answer
from studies.sources.registry import resolve

pytestmark = pytest.mark.processes
LOADED = {
    "exits": ("import sys; sys.exit()", "cannot be loaded from exits:World: SystemExit"),
    "exits_at_once": ("import os; os._exit(0)", "ended by itself with exit code 0"),
    "interrupts": ("raise KeyboardInterrupt", "KeyboardInterrupt"),
    "crashes": ("import ctypes; ctypes.string_at(0)", "ended by signal SIGSEGV"),
    "loops": ("while True: pass", "no result within the time limit of 2 s"),
    "takes_little": ("def World(scene): pass", "it takes (scene), and what builds a world takes"),
    "not_there": ("import os; World = os.system", "neither a declaration nor what builds a world"),
}
"""Module -> its source, and how it is refused."""
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
JUDGED = """
from studies import score
everything = score.jobs
def some(*asked):
    return list({(job.labels["part"], job.source): job for job in everything(*asked)}.values())
score.jobs = some
from studies.__main__ import main
main()
"""
"""A score with a job of each part and preset, by the command line."""


@pytest.fixture
def announced(alone, monkeypatch, tmp_path):
    """Work in a new folder; let what is announced be forgotten."""
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))


@pytest.mark.parametrize("module", LOADED)
def test_what_harms_while_it_is_loaded_is_refused_in_a_line(module, announced, monkeypatch, capfd):
    source, words = LOADED[module]
    Path(f"{module}.py").write_text(source)
    monkeypatch.setattr(foreign, "LOADING_S", 2.0 if module == "loops" else 300.0)
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
    case = Question(system=BLOCK, motion=FULL_SINE)
    with foreign.kept_out():
        name = score.known("mine:ENGINE")
        told, asked = ENGINES[name], partial(Job, labels={}, case=case)
        made = maker_of(resolve("mine"), answer)
        with pytest.raises(BadInputError, match="friction is -1"):
            asked(source="mine:fixed", options={"settings": {"friction": -1.0}})
        assert told.spring(2.0, 1.0) == {"friction": 2.0}
        scene = Scene(system=BLOCK, motion=FULL_SINE)
        assert told.script(scene, told.best.settings, 1e-3) == (BLOCK, "mine", True)
    assert (name, "mine" in sys.modules) == ("mine", False)
    assert [path.name for path in told.build.files] == ["mine.py"]
    declared = registry.loaded("mine")
    here = maker_of(resolve("exact"), answer)
    assert made["code of mine"] and "code of mine" not in here
    assert (told.name, told.factors, told.frames) == (declared.name, declared.factors, ("base",))
    for mine, there in zip(declared.presets, told.presets, strict=True):
        assert asdict(mine.settings) == asdict(there.settings)
        same = {item.name for item in fields(mine)} - {"settings"}
        assert all(repr(getattr(mine, item)) == repr(getattr(there, item)) for item in same)


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
    assert done.returncode == 1, done.stderr
    assert "falls short: landing:failed must be at most 0, and is 1" in done.stdout
    assert "a word" not in done.stdout
