"""The smallest scripts of what goes wrong: each still does in the pinned version, by itself."""

import re
import subprocess
import sys
from pathlib import Path

import pytest
from uses import HERE

import engines
from engines.troubles import OTHERS, TROUBLES

FOLDER = Path(engines.__file__).parent / "troubles"
BENEATH = {"warp": {"mujoco", "warp"}, "mjx": {"jax"}}
"""What an engine is a part of, or made with."""
ASKED = [trouble for trouble in TROUBLES if trouble.engine in HERE or trouble.engine in OTHERS]


def test_every_script_is_told_of():
    found = {path.name for path in FOLDER.glob("*_*.py") if path.name != "__init__.py"}
    assert {trouble.script for trouble in TROUBLES} == found
    assert all(trouble.title and trouble.mechanism and trouble.kind for trouble in TROUBLES)


@pytest.mark.parametrize("trouble", TROUBLES, ids=lambda trouble: trouble.script)
def test_a_script_needs_its_engine_alone(trouble):
    text = (FOLDER / trouble.script).read_text()
    assert len(text.splitlines()) <= 40
    names = set(re.findall(r"^ *(?:import|from) (\w+)", text, re.MULTILINE))
    library = trouble.library.partition(".")[0]
    others = {library, f"{library}_data", "numpy"} | BENEATH.get(trouble.engine, set())
    assert names
    assert names - set(sys.stdlib_module_names) <= others


@pytest.mark.parametrize("trouble", ASKED, ids=lambda trouble: trouble.script)
def test_the_trouble_is_still_there(trouble, tmp_path):
    """In a process and a folder of its own, where this project is not to be found."""
    if trouble.engine in OTHERS:
        pytest.importorskip(trouble.library)
    asked = [sys.executable, "-I", str(FOLDER / trouble.script)]
    done = subprocess.run(asked, cwd=tmp_path, capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "expected" in done.stdout and "found" in done.stdout
