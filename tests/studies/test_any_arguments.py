"""Whatever stands on the command line: usable, some rows failed, or one line that says why not."""

import contextlib
import io
import os
import warnings
from pathlib import Path

import pytest
from commanding import BLOCK, CASE
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from records import AT2

from studies.__main__ import COMMANDS, GROUPS, run
from studies.kit import run as runs
from studies.kit.app import make_app, settle_environment
from studies.kit.store import FolderError
from studies.kit.workers import Lost
from studies.page import page

pytestmark = pytest.mark.processes

RECORD = ("--record", "RECORD", "--units", "g", *BLOCK)
RELEASE = ("--tilt", "0.5", *BLOCK)
BEGINNINGS = {
    "compare": [(*begin, "--sources", "exact") for begin in (CASE, RECORD, RELEASE)],
    "blocks": [("CABINETS", "--record", "RECORD", "--units", "g", "--out", "FOLDER")],
    "score": [("pybullet", "--out", "FOLDER", "--quick")],
    "animate": [(*CASE, "--out", "film.gif")],
    "export": [(*CASE, "--engine", "pybullet", "--out", "NEW")],
    "experiments": [("--rocks", "FOLDER", "--out", "FOLDER")],
    "doctor": [()],
    "help": [()],
    "readme": [()],
}
"""What stands before an option so that it matters, of commands that fill no folder, or need one."""
FEW = {"sweep": ("--figure", "6"), "validate": ("--cases", "1")}
"""What makes little work of those that do: thousands of jobs are made before a folder is opened."""
ODD_WORDS = """
0 1 2 -1 -5 1.5 1,5 1_000 ١٢ +3 0x10 1e5 1e-7 5e-324 1e-308 1e308 -1e308 1e400 1000000000 1000000001
9223372036854775808 18446744073709551616 inf -inf nan NaN -0.0 - -- --- --= = --help -h --version
--out --quick=1 --no-quick . .. / ~ * /nowhere/x /dev/null /dev/full /dev/zero /dev/stdin
/proc/self/mem PIPE FOLDER RECORD /dev/full/x.png FOLDER/x.png x/y.pdf exact exact: : mujoco:
mujoco:best core core:default engines:x EXACT tcp://127.0.0.1:1 tcp:// tls://127.0.0.1:1 http://x
127.0.0.1 tcp://[::1]:9 g gal half-sine figure 6 6.0 true None [] {} png
"""
ODD = [
    *ODD_WORDS.split(),
    *("", " ", " 7 ", "\0", "a\0b", "\n", "\t", "\r\n", "\x1b[31m", "\udc80", "rm -rf"),
    *("1" * 400, f"0.{'0' * 400}1", "é" * 5000, "x" * 5000),
]
"""Text that has been trouble somewhere."""


def options_of(name):
    arguments = make_app(GROUPS, name)[name].assemble_argument_collection()
    names = [argument.name for argument in arguments if argument.name.startswith("--")]
    assert names
    return names


OPTIONS = {name: options_of(name) for name in COMMANDS}
FULL = "nothing is run here"


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """A folder with an ordinary record, a named pipe, and nothing that can be computed for long."""
    folder = tmp_path_factory.mktemp("any")
    (folder / "RECORD").write_text(AT2["series"])
    (folder / "CABINETS").write_text("name,width,height\nA,0.5,1.5\n")
    (folder / "FOLDER").mkdir()
    os.mkfifo(folder / "PIPE")
    kept = Path.cwd()
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        patch.setattr("studies.kit.study.Store", refuse)
        patch.setattr("studies.blocks.Store", refuse, raising=False)
        patch.setattr("studies.score.Store", refuse, raising=False)
        patch.setattr(runs, "answers", give_up)
        patch.setattr(page, "_prepare", refuse)
        patch.setattr("studies.drawing.film.write_film", lambda *_: None)
        patch.setattr("studies.kit.run.CONNECT_S", 0.5)
        yield folder
    assert Path.cwd() == kept


def refuse(folder, *_):
    """All arguments were taken: what follows is the study's."""
    raise FolderError(folder, FULL)


def give_up(call, tasks, workers, limit_s):
    """What takes long, or may crash, reaches its time limit."""
    for number in range(len(tasks)):
        yield number, Lost("no result", late=True)


def check(arguments):
    written, told = io.StringIO(), io.StringIO()
    with (
        warnings.catch_warnings(),
        contextlib.redirect_stdout(written),
        contextlib.redirect_stderr(told),
    ):
        warnings.simplefilter("error")
        code = run(list(arguments))
    err = told.getvalue()
    assert code in (0, 1, 2), err
    assert "Traceback" not in err
    if code == 2:
        assert written.getvalue() == ""
        assert err.count("\n") == 1
        assert len(err) < 1200
        assert err[:-1].isprintable()
    return err


def beginnings(name):
    quick = ("--quick",) if "--quick" in OPTIONS[name] else ()
    return BEGINNINGS.get(name, [("--out", "FOLDER", *quick, *FEW.get(name, ()))])


def with_words(name, beginning, words):
    """Return a command line of a beginning, but for the options that the words name, and these."""
    named = {word.partition("=")[0] for word in words}
    line, kept = [name], True
    for word in beginning:
        kept = word not in named if word.startswith("--") else kept
        line += [word] * kept
    return [*line, *words]


@pytest.mark.parametrize("name", OPTIONS)
def test_a_command_line_in_order_gets_as_far_as_its_folder(name, site):
    if name not in BEGINNINGS:
        (beginning,) = beginnings(name)
        assert FULL in check([name, *beginning])


TEXT = st.sampled_from(ODD) | st.text(max_size=20) | st.floats().map(repr) | st.integers().map(str)


@st.composite
def command_lines(draw):
    name = draw(st.sampled_from(sorted(OPTIONS)))
    begin, words = draw(st.sampled_from(beginnings(name))), []
    for _ in range(draw(st.integers(1, 2))):
        option = draw(st.sampled_from(OPTIONS[name]))
        texts = draw(st.lists(TEXT, min_size=0, max_size=2))
        words += [f"{option}={texts[0]}"] if draw(st.booleans()) and texts else [option, *texts]
    return with_words(name, begin, words)


@settings(
    max_examples=200,
    deadline=None,
    derandomize=True,
    suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow],
)
@given(arguments=command_lines())
def test_any_text_for_any_option(arguments, site):
    check(arguments)


@pytest.mark.parametrize("columns", ["100", "1", "wide"])
def test_every_command_has_its_help_in_a_terminal_of_any_width(columns, monkeypatch, capsys):
    monkeypatch.setenv("COLUMNS", columns)
    settle_environment()
    for name in COMMANDS if columns == "100" else [*COMMANDS][:3]:
        assert run([name, "--help"]) == 0
        output = capsys.readouterr()
        lines = output.out.splitlines()
        assert (output.err, lines[0].startswith(f"Usage: rocking {name}")) == ("", True)
        assert max(map(len, lines)) <= int(os.environ["COLUMNS"])
        if columns == "100":
            assert [each for each in OPTIONS[name] if each not in output.out] == []
