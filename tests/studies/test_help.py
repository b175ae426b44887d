"""Every command's help: its words, its options, and no line that a terminal would break."""

import dataclasses
import inspect
import typing
from importlib import import_module

import pytest

from studies.__main__ import COMMANDS, run

COLUMNS = 100


def options_of(command):
    """Return the options of a command's function, those inside dataclasses among them."""
    for name, kind in typing.get_type_hints(command).items():
        if name == "return" or inspect.signature(command).parameters[name].kind.name != (
            "KEYWORD_ONLY"
        ):
            continue
        if dataclasses.is_dataclass(kind):
            yield from (field.name for field in dataclasses.fields(kind))
        else:
            yield name


@pytest.mark.parametrize("study", COMMANDS, ids=lambda study: study.name)
def test_every_command_has_its_help(study, capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(COLUMNS))
    assert run([study.name, "--help"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert study.help.splitlines()[0] in " ".join(lines)
    assert max(map(len, lines)) <= COLUMNS
    told = {words[1 + (words[1] == "*")]: words for words in map(str.split, lines) if option(words)}
    for name in options_of(import_module(study.module).command):
        # the option and its kind, then at least a word of what it is
        assert len(told[f"--{name.replace('_', '-')}"]) > 4, name


def option(words):
    """Tell whether a line of help begins with an option."""
    return len(words) > 2 and words[0] == "│" and words[1 + (words[1] == "*")].startswith("--")
