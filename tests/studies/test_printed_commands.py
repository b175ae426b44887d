"""The commands that pages print: each is taken as printed."""

import re
import shlex
import tomllib

import pytest
from commanding import PROSE, ROOT

from studies.__main__ import COMMANDS, GROUPS, run
from studies.kit.app import make_app
from studies.page.chapters import PARTS


def commands(name):
    """Return the commands that a page prints in its blocks, in their order."""
    blocks = re.findall(
        r"```(?:sh|yaml)\n(.*?)```", (ROOT / name).read_text(encoding="utf-8"), re.S
    )
    return [
        line for block in blocks for line in re.findall("^ *(?:- run: )?(rocking .*)", block, re.M)
    ]


def taken(arguments):
    """Let the command line take arguments, all of them, without running anything."""
    app = make_app(GROUPS, arguments[0])
    _, bound, ignored = app.parse_args(arguments, exit_on_error=False)
    assert bound.arguments and not ignored


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.folder)
@pytest.mark.parametrize("full", [True, False])
def test_the_command_of_a_part_is_taken(part, full):
    taken(part.words("DIR", full))


QUICK = ("advise", "export", "blocks", "compare")


@pytest.mark.parametrize("command", commands("README.md"))
def test_a_command_of_the_readme_works_as_printed(command, tmp_path, monkeypatch, capsys):
    """What takes a second is run; of the rest every argument is taken."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    _, *arguments = shlex.split(command)
    if arguments[0] in QUICK:
        assert run(arguments) == 0
        assert capsys.readouterr().out
    else:
        taken(arguments)


@pytest.mark.parametrize("name", PROSE)
def test_a_command_within_a_page_is_taken(name):
    """Whole ones; of a command alone its name."""
    text = (ROOT / name).read_text(encoding="utf-8")
    inside = [" ".join(found.split()) for found in re.findall("`(rocking [^`]*)`", text)]
    for command in (*inside, *(commands(name) if name != "README.md" else ())):
        _, *arguments = shlex.split(command, comments=True)
        assert arguments[0] in {*COMMANDS, "COMMAND", "--help"}
        if len(arguments) > 1 and arguments[0] != "COMMAND":
            taken(arguments)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    for named in re.findall(r"pip install [^`\n]*'\.\[([\w,]+)\]'", text):
        assert set(named.split(",")) <= set(project["optional-dependencies"])
