"""Rows of another results folder: of an engine that is installed elsewhere."""

import json

import pandas as pd
import pytest
from commanding import refused
from given import BLOCK

from analytic import SinePulse
from analytic.response import Outcome, Response
from engines.declaration import Engine
from studies.__main__ import run
from studies.old import identity, provenance
from studies.old.jobs import Job
from studies.old.journal import FolderError
from studies.old.options import Running
from studies.old.plan import Plan, fill
from studies.old.study import Study

STUDY = Study(name="made-up", module="studies.sweep.study", help="", tables=("made-up.csv",))
SOURCES = ("exact", "pymunk", "box2d")


def job(source, omega):
    motion = SinePulse(amplitude=3.0, omega=omega)
    return Job(labels={"omega": omega}, block=BLOCK, motion=motion, source=source)


def plan(sources, answer=0.5, **settings):
    def ask(asked, source):
        return Response(outcome=Outcome.ROCKED, peak_ratio=answer) if answer else lost()

    jobs = [job(source, omega) for source in sources for omega in (4.0, 5.0)]
    return Plan(jobs=jobs, ask=ask, settings=settings, growing={"source": sources})


def lost():
    return Response.failure("lost")


@pytest.fixture
def versions(monkeypatch):
    """Return the installed versions of the engines' packages."""
    known = dict.fromkeys(provenance.engine_packages(), "1.0")
    whole = provenance.version_of
    for module in (provenance, identity):
        monkeypatch.setattr(module, "version_of", lambda name: known.get(name) or whole(name))
    return known


@pytest.fixture
def missing(monkeypatch, versions):
    """Return what takes the engines away."""

    def take_away(package):
        versions[package] = provenance.NOT_INSTALLED
        monkeypatch.setattr(Engine, "installed", property(lambda e: package not in e.packages))

    return take_away


def also(*folders):
    return Running(jobs=1, also=folders)


def kept(folder):
    return pd.read_csv(folder / "made-up.csv")


def test_an_engine_that_is_installed_elsewhere_has_its_rows_here(versions, missing, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    fill(STUDY, plan(["exact", "pymunk"], 0.25), there, also())
    missing("pymunk")
    rows = fill(STUDY, plan(["exact", "pymunk"]), here, also(there))
    table = kept(here)
    assert list(table["source"]) == ["exact", "exact", "pymunk", "pymunk"]
    assert (table["peak_ratio"] == 0.25).all()
    record = json.loads((here / "provenance.json").read_text())
    assert record["engines"]["pymunk"] == "not installed"
    (taken,) = record["runs"][-1]["also"]
    assert taken["engines"] == {"pymunk": "1.0"}
    assert taken["rows"] == 4
    assert taken["machine"] == record["machine"]
    assert provenance.engines_of(record)["pymunk"] == "1.0"
    assert fill(STUDY, plan(["exact", "pymunk"], 0.75), here) == rows


def test_what_is_finished_here_stays(versions, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    fill(STUDY, plan(["pymunk"], 0.25), here, also())
    fill(STUDY, plan(SOURCES, 0.75), there, also())
    fill(STUDY, plan(SOURCES), here, also(there))
    assert list(kept(here)["peak_ratio"]) == [0.75, 0.75, 0.25, 0.25, 0.75, 0.75]


@pytest.mark.parametrize("installed", [True, False])
def test_a_failure_is_taken_where_it_cannot_be_tried_again(installed, versions, missing, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    fill(STUDY, plan(["pymunk"], None), there, also())
    if not installed:
        missing("pymunk")
    fill(STUDY, plan(["pymunk"]), here, also(there))
    assert list(kept(here)["outcome"]) == 2 * ["rocked" if installed else "failed"]


def test_rows_of_another_release_of_an_engine_that_is_installed_are_made_here(
    versions, tmp_path, capsys
):
    here, there = tmp_path / "here", tmp_path / "there"
    versions["Box2D"] = "0.9"
    fill(STUDY, plan(SOURCES, 0.25), there, also())
    versions["Box2D"] = "1.0"
    problem = "box2d: 2 rows made by Box2D 0.9, not 1.0"
    with pytest.raises(FolderError, match=rf"--also is .*; all its rows are stale \({problem}\)"):
        fill(STUDY, plan(["box2d"]), tmp_path / "only", also(there))
    fill(STUDY, plan(SOURCES), here, also(there))
    assert capsys.readouterr().err == f"not taken from {str(there)!r}: {problem}\n"
    assert list(kept(here)["peak_ratio"]) == [0.25, 0.25, 0.25, 0.25, 0.5, 0.5]
    (taken,) = json.loads((here / "provenance.json").read_text())["runs"][-1]["also"]
    assert (taken["rows"], taken["engines"]) == (4, {"pymunk": "1.0"})


def test_a_row_that_is_stale_here_is_taken_where_it_is_not(versions, tmp_path):
    here, there = tmp_path / "here", tmp_path / "there"
    versions["Box2D"] = "0.9"
    fill(STUDY, plan(["box2d"], 0.25), here, also())
    versions["Box2D"] = "1.0"
    fill(STUDY, plan(["box2d"], 0.75), there, also())
    fill(STUDY, plan(["box2d"]), here, also(there))
    assert list(kept(here)["peak_ratio"]) == [0.75, 0.75]


def test_results_of_something_else_are_refused(versions, tmp_path):
    there = tmp_path / "there"
    fill(STUDY, plan(["exact"], step=1), there, also())
    for problem, asked, folder in (
        ("same study and settings .settings step: 1 there, 2 here", {"step": 2}, there),
        ("its journal.jsonl and provenance.json", {}, tmp_path / "nowhere"),
    ):
        with pytest.raises(FolderError, match=f"--also is .*{problem}"):
            fill(STUDY, plan(["exact"], **asked), tmp_path / "here", also(folder))
        assert not (tmp_path / "here").exists()
    with pytest.raises(FolderError, match="it holds no row of what is asked for"):
        fill(STUDY, plan(["pymunk"], step=1), tmp_path / "here", also(there))


def test_a_damaged_folder_is_refused(versions, tmp_path):
    there = tmp_path / "there"
    fill(STUDY, plan(["exact"]), there, also())
    journal = there / "journal.jsonl"
    journal.write_bytes(journal.read_bytes().replace(b"rocked", b"rockec"))
    with pytest.raises(FolderError, match=r"--also is .*damaged in line 3"):
        fill(STUDY, plan(["exact"]), tmp_path / "here", also(there))


def test_the_command_line_takes_folders(tmp_path, capsys):
    arguments = ["sweep", "--figure", "6", "--sources", "exact", "housner", "--out"]
    assert run([*arguments, str(tmp_path / "a")]) == 0
    assert run([*arguments, str(tmp_path / "b"), "--also", str(tmp_path / "a")]) == 0
    one, other = ((tmp_path / name / "sweep.csv").read_bytes() for name in "ab")
    assert one == other  # run times too
    capsys.readouterr()
    refused(capsys, [*arguments, tmp_path / "c", "--also", tmp_path / "no"], "--also")
