"""Processes: whatever one does is a row, what ends a command ends it well; engines of others."""

import math
import os
import resource
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import hostile
import pytest
import rocking_moreau
from commanding import CASE, python
from given import BLOCK, FULL_SINE

from analytic import SinePulse
from engines.declaration import Stepping
from engines.registry import FURTHER
from engines.run.run import simulate_world
from engines.scene import Scene
from studies import score
from studies.kit.identity import code_in, maker_of
from studies.kit.jobs import Job, Question, answer
from studies.kit.run import local
from studies.kit.workers import Lost, answers
from studies.sources.registry import SOURCES, Source, announce, resolve

pytestmark = pytest.mark.processes

PULSE = SinePulse(amplitude=6.0, omega=6.0)
SAID = {name: said for name, (*_, said) in {**hostile.IN_A_STEP, **hostile.OTHERWISE}.items()}
LIMIT_S = 3.0


@pytest.fixture(scope="module")
def rows(alone_in_module, tmp_path_factory):
    note = tmp_path_factory.mktemp("hostile") / "note"
    alone_in_module.setenv(hostile.NOTE, str(note))
    for world in SAID:
        announce(f"hostile:{world}", lambda place: place.rpartition(":")[2])
    case = Question(system=BLOCK, motion=PULSE)
    jobs = [Job(labels={}, case=case, source=world) for world in SAID]
    found = dict(local(jobs, answer, 2, LIMIT_S, at_once=True))
    return {job.source: found[number] for number, job in enumerate(jobs)}, note


@pytest.mark.slow
@pytest.mark.parametrize("world", SAID)
def test_whatever_an_engine_does_is_a_row(world, rows):
    row = rows[0][world]
    assert len(row["message"].splitlines()) <= 1 and len(row["message"]) <= 1000
    if SAID[world]:
        assert row["outcome"] == "failed"
        assert row["message"].startswith(SAID[world])
    else:
        assert (row["outcome"], row["message"]) == ("at rest", "")
        assert math.isfinite(row["wall_s"])


@pytest.mark.slow
def test_what_an_engine_started_in_its_group_is_ended_with_its_process(rows):
    pids = [int(pid) for pid in rows[1].read_text().split()]
    for _ in range(50):
        left = [pid for pid in pids if runs(pid)]
        # who leaves the session of its process lives on: two of the worlds let a child do so
        if len(left) <= 2:
            break
        time.sleep(0.1)
    assert len(left) <= 2 < len(pids)
    for pid in left:
        os.kill(pid, 9)


def runs(pid):
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def doubles(value):
    return 2 * value


def dies_soon():
    threading.Timer(0.2, os._exit, [3]).start()
    return os.getpid()


def sleeps():
    time.sleep(60.0)


def test_a_process_that_ended_between_two_tasks_is_replaced():
    first = next(answers(dies_soon, [()], 1, 60.0))[1]
    assert first != os.getpid()
    found = dict(answers(doubles, [(1,), ("x" * 10,), (None,)], 1, 60.0))
    assert found[0] == 2
    assert found[2] == Lost("TypeError: unsupported operand type(s) for *: 'int' and 'NoneType'")


def test_a_task_that_takes_too_long_is_given_up():
    began = time.monotonic()
    ((_, lost),) = answers(sleeps, [()], 1, 0.2)
    assert lost == Lost("no result within the time limit of 0.2 s", late=True)
    assert time.monotonic() - began < 30.0


def test_a_short_solve_stays_in_this_process(monkeypatch):
    monkeypatch.setitem(SOURCES, "here", Source("model", lambda *_, **__: 1 / 0))
    case = Question(system=BLOCK, motion=FULL_SINE)
    ((_, row),) = local([Job(labels={}, case=case, source="here")], answer, 1, 60.0, at_once=True)
    assert row["message"].startswith("ZeroDivisionError")


def test_an_engine_that_goes_back_in_time_is_refused():
    does = {"advance": lambda *_: -1, "stepping": Stepping.OWN}
    scene = Scene(system=BLOCK, motion=PULSE)
    world = type("GoesBack", (hostile.Calm,), does)(scene, None, 1e-3)
    with pytest.raises(ValueError, match="it took -1 steps"):
        simulate_world(world, scene, 1e-3, Stepping.OWN)


COMPARE = ["compare", *CASE, "--sources", "exact", "--json"]
ENDING = [signal.SIGINT, signal.SIGTERM, signal.SIGHUP]


@pytest.mark.parametrize("number", ENDING)
def test_a_signal_while_modules_are_loaded_is_no_traceback(number, tmp_path):
    module = tmp_path / "modules" / "numpy.py"
    module.parent.mkdir()
    module.write_text(
        f"import os\nos.kill(os.getpid(), {int(number)})\nraise SystemExit('the signal was lost')"
    )
    asked = ["sweep", "--figure", "6", "--sources", "exact", "--out", tmp_path / "out"]
    done = python("-m", "studies", *asked, path=[module.parent])
    kind = "interrupted" if number == signal.SIGINT else number.name
    assert done.stderr == f"rocking: {kind}\n"
    assert (done.returncode, done.stdout) == (128 + number, "")


@pytest.mark.slow
def test_closed_streams_change_no_exit_code_and_no_result(tmp_path):
    def close():
        for number in range(3):
            os.close(number)

    # what is opened later gets none of their numbers, and a process that is started has them, too
    closed = {"before": close, "env": {FURTHER: ""}}  # nor the engines that other tests announce
    prepared = "import os; from studies.kit.say import prepare_streams; prepare_streams(); "
    tried = "raise SystemExit((os.open('.', 0) != 3) + os.system('true <&0 >&1 2>&2'))"
    assert python("-c", prepared + tried, **closed).returncode == 0
    done = python("-m", "studies", "compare", "--width", "0", **closed)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", "")
    asked = ["validate", "--sources", "exact", "mujoco:tuned", "--cases", "5"]
    done = python("-m", "studies", *asked, "--out", tmp_path / "out", **closed)
    assert done.returncode == 0
    assert len((tmp_path / "out" / "errors.csv").read_text().splitlines()) == 11


def test_output_that_cannot_be_written_is_one_line():
    with Path("/dev/full").open("w") as full:
        done = python("-m", "studies", *COMPARE, stdout=full)
    assert done.returncode == 2
    assert done.stderr.splitlines() == ["rocking: [Errno 28] No space left on device"]


def test_too_few_open_files_are_one_line(tmp_path):
    asked = ["sweep", "--figure", "6", "--sources", "exact", "mujoco", "--jobs", "2"]
    done = python(
        *("-m", "studies", *asked, "--out", tmp_path / "out"),
        before=lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (13, 13)),
    )
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert "Too many open files" in line


@pytest.mark.parametrize("asked", [["--help"], ["--version"], [*COMPARE[:-1]]])
def test_output_that_nobody_reads_to_its_end_is_no_failure_of_rows(asked):
    command, pipe = [sys.executable, "-m", "studies", *asked], subprocess.PIPE
    with subprocess.Popen(command, stdout=pipe, stderr=pipe) as process:
        process.stdout.close()
        assert process.stderr.read() == b""
    assert process.returncode == 141  # as of any program that a pipe ends


def test_settings_of_other_programs_change_nothing(tmp_path):
    plot = tmp_path / "plot.png"
    others = {"MPLBACKEND": "nonsense", "NUMBA_NUM_THREADS": "0"}
    done = python("-m", "studies", *COMPARE, "--plot", plot, env=others)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1
    assert plot.read_bytes().startswith(b"\x89PNG")


@pytest.fixture
def announced(alone, monkeypatch, tmp_path):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(sys, "path", list(sys.path))


@pytest.mark.parametrize(
    ("source", "known", "words"),
    [
        ("import sys; sys.exit()", "", "cannot be loaded from mine:World: SystemExit"),
        ("def World(scene): pass", "", "it takes (scene), and what builds a world takes"),
        ("import os; World = os.system", "", "neither a declaration nor what builds a world"),
        ("import sys; sys.exit()", "mine=mine:World", "engine 'mine'"),
        ("World = 7", "mine=mine:World", "engine 'mine'"),
        ("", "mine:World", "ROCKING_ENGINES holds 'mine:World'; it must be like"),
    ],
)
def test_what_cannot_be_loaded_is_refused_in_a_line(source, known, words, tmp_path):
    """Where it is asked for at a place, and where it was announced and others are asked."""
    (tmp_path / "mine.py").write_text(source)
    asked = [*("score", "mine:World"), "--out", tmp_path / "out"]
    if known:
        asked = ["compare", *CASE, "--sources", "exact"]
    done = python("-m", "studies", *asked, path=[tmp_path], env={FURTHER: known})
    assert (done.returncode, done.stdout) == (2, "")
    (line,) = done.stderr.splitlines()
    assert words in line and ("ENGINE: engine 'mine:World'" in line) == (not known)
    assert not (tmp_path / "out").exists()


def test_the_rows_of_an_engine_at_a_place_depend_on_its_code(announced):
    Path("mine.py").write_text(Path(rocking_moreau.__file__).read_text().replace("moreau", "mine"))
    assert score.known("mine:ENGINE") == "mine"
    made = maker_of(resolve("mine"), answer)
    assert made["code of mine"] == code_in(Path("mine.py").absolute())
    assert "code of mine" not in maker_of(resolve("exact"), answer)
