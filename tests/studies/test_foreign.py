"""Engines of other packages: what cannot be loaded is a line; rows depend on their code."""

import sys
from pathlib import Path

import pytest
import rocking_moreau
from commanding import CASE, python

from engines.registry import FURTHER
from studies import score
from studies.kit.identity import code_in, maker_of
from studies.kit.jobs import answer
from studies.sources.registry import resolve

pytestmark = pytest.mark.processes


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
