"""The smallest scripts of what goes wrong: each still does in the pinned version, by itself."""

import re
import sys
from pathlib import Path

import pytest
from commanding import python
from uses import HERE

import engines
from engines.troubles import TROUBLES

FOLDER = Path(engines.__file__).parent / "troubles"
ASKED = [trouble for trouble in TROUBLES if trouble.engine in HERE]


@pytest.mark.parametrize("trouble", TROUBLES, ids=lambda trouble: trouble.script)
def test_a_script_needs_its_engine_alone(trouble):
    assert trouble.title and trouble.mechanism and trouble.kind
    text = (FOLDER / trouble.script).read_text()
    assert len(text.splitlines()) <= 40
    names = set(re.findall(r"^ *(?:import|from) (\w+)", text, re.MULTILINE))
    library = engines.ENGINES[trouble.engine].library
    assert library.partition(".")[0] in names
    assert names - set(sys.stdlib_module_names) <= {library.partition(".")[0], "numpy"}


@pytest.mark.parametrize("trouble", ASKED, ids=lambda trouble: trouble.script)
def test_the_trouble_is_still_there(trouble, tmp_path):
    """In a process and a folder of its own, where this project is not to be found."""
    done = python("-I", FOLDER / trouble.script, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "expected" in done.stdout and "found" in done.stdout
