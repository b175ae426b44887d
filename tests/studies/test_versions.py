"""Releases of an engine: which there are, what each answers, and what changed between them."""

import json
import math
import subprocess
import sys
import zipfile
from importlib import metadata
from pathlib import Path

import pandas as pd
import pytest

from engines import ENGINES, registry
from studies.__main__ import run
from studies.kit.arguments import BadInputError
from studies.kit.provenance import record_of
from studies.measures.differences import with_reference
from studies.measures.published import PUBLISHED
from studies.versions import releases
from studies.versions.releases import Asked, Release, check_releases, chosen, listed
from studies.versions.study import EVERY, FIGURE, RANDOM, STUDY, finding, posed
from studies.versions.tables import CHANGED, NOTES, changes_table, notes_between, releases_table

ENGINE = """
from dataclasses import replace
from pretender_moreau import ENGINE as MOREAU

(naive, *_) = MOREAU.presets
settings = replace(naive.settings, friction={friction})
ENGINE = replace(
    MOREAU, name="pretender", library="pretender", packages=("pretender",),
    presets=(replace(naive, settings=settings, step_s=0.02),),
)
"""
"""A package of an engine, two releases of which differ in a friction."""

PLUGIN = Path(__file__).parents[1] / "plugin" / "rocking_moreau.py"
RELEASES = {"1.0": 2.0, "1.1": 2.0, "2.0": 0.2}
"""Release -> friction, by which a block slides in the last one."""


def wheel(folder, version, friction):
    """Write a release of the package as a wheel, which installs without a network."""
    about = f"pretender-{version}.dist-info"
    files = {
        "pretender.py": ENGINE.format(friction=friction),
        "pretender_moreau.py": PLUGIN.read_text(),
        f"{about}/METADATA": f"Metadata-Version: 2.1\nName: pretender\nVersion: {version}\n",
        f"{about}/WHEEL": "Wheel-Version: 1.0\nRoot-Is-Purelib: true\nTag: py3-none-any\n",
        f"{about}/entry_points.txt": "[rocking.engines]\npretender = pretender:ENGINE\n",
    }
    path = folder / f"pretender-{version}-py3-none-any.whl"
    with zipfile.ZipFile(path, "w") as packed:
        for name, text in files.items():
            packed.writestr(name, text)
        packed.writestr(f"{about}/RECORD", "".join(f"{name},,\n" for name in files))
    return path


@pytest.fixture
def pretender(tmp_path, monkeypatch):
    """An engine whose first release is installed, and whose others lie in a folder."""
    wheels = tmp_path / "wheels"
    wheels.mkdir()
    for version, friction in RELEASES.items():
        wheel(wheels, version, friction)
    with zipfile.ZipFile(wheels / "pretender-1.0-py3-none-any.whl") as packed:
        packed.extractall(tmp_path / "here")
    monkeypatch.syspath_prepend(tmp_path / "here")
    monkeypatch.setenv("PIP_NO_INDEX", "1")
    monkeypatch.setenv("PIP_FIND_LINKS", str(wheels))
    monkeypatch.setenv("PIP_CONFIG_FILE", "/dev/null")
    registry._places.cache_clear()
    yield wheels
    for name in ("pretender", "pretender_moreau"):
        sys.modules.pop(name, None)
    registry._places.cache_clear()


@pytest.mark.slow
def test_each_release_is_asked_in_an_environment_of_its_own(pretender, tmp_path, capsys):
    """And what one says that errs is seen, and what is there is not made again."""
    out = tmp_path / "out"
    words = ["versions", "--engines", "pretender", "--quick", "--jobs", "1", "--out", str(out)]
    before = {name: metadata.version(name) for name in ("numpy", "pretender")}
    # listed, and not for this Python
    (pretender / "pretender-1.5.tar.gz").touch()
    assert run([*words, "--releases", "all"]) == 0
    told = capsys.readouterr().out
    lines = pd.read_csv(out / "releases.csv", dtype={"release": str}).set_index(["release", "set"])
    assert list(lines.index.unique("release")) == list(RELEASES)
    assert (lines["failed"] < lines["cases"])[["1.0", "1.1"]].all()
    assert (lines.loc["1.1", "moved"] == 0.0).all()
    (change,) = STUDY.read(out, "changes").to_dict("records")
    assert (change["before"], change["release"], change["presets"]) == ("1.1", "2.0", "naive")
    assert told.startswith(
        "From one release to the next answers move by more than 1e-06 in pretend"
    )
    # nothing was done to what is installed here
    assert {name: metadata.version(name) for name in before} == before
    made = {path: path.stat().st_mtime_ns for path in out.glob("environments/*")}
    assert [path.name for path in sorted(made)] == ["pretender-1.1", "pretender-2.0"]
    # without their wheels, what was made goes on
    for path in pretender.iterdir():
        path.unlink()
    named = ["--releases", "pretender==1.1", "pretender==3.0"]
    assert run([*words, *named]) == 0
    again = STUDY.read(out, "releases")
    assert list(again["release"].unique()) == ["1.0", "1.1", "3.0"]
    assert "cannot be installed" in again.iloc[-1]["message"]
    assert {path: path.stat().st_mtime_ns for path in made} == made
    runs = json.loads((out / "provenance.json").read_text())["runs"]
    assert [each["release"] for each in runs] == [["all"], named[1:]]


@pytest.mark.slow
def test_without_a_network_there_is_one_line(pretender, tmp_path, capsys):
    for path in pretender.iterdir():
        path.unlink()
    words = ["versions", "--engines", "pretender", "--quick", "--jobs", "1"]
    assert run([*words, "--releases", "minor", "--out", str(tmp_path / "out")]) == 1
    told = capsys.readouterr()
    assert told.err.count("\n") == 1
    assert "the releases of pretender cannot be asked for: ERROR: No matching" in told.err
    assert list(STUDY.read(tmp_path / "out", "releases")["release"].unique()) == ["1.0"]


def test_the_releases_here_are_asked_in_this_process(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("studies.versions.study.EVERY", 60)
    words = ["versions", "--engines", "box2d", "--quick"]
    assert run([*words, "--jobs", "1", "--out", str(tmp_path)]) == 0
    assert capsys.readouterr().out.startswith("Of each engine one release was asked.\n")
    answers = pd.read_csv(tmp_path / "answers.csv")
    assert len(answers) == len(ENGINES["box2d"].presets) * 5
    assert (tmp_path / "versions.png").stat().st_size > 4_000
    assert run([*words, "--jobs", "1", "--out", str(tmp_path)]) == 0


def test_the_cases_are_those_of_the_figure_and_the_first_random_ones():
    asked = posed(quick=False)
    assert [labels["set"] for labels, *_ in asked] == ["figure 8"] * 240 + ["random"] * 50
    kept = pd.read_csv(PUBLISHED / "validate" / "errors.csv")
    (mine,) = [labels for labels, *_ in asked if labels["set"] == "random" and labels["case"] == 7]
    theirs = kept[kept["case"] == 7].iloc[0]
    assert all(mine[name] == theirs[name] for name in ("aspect", "width_m", "amplitude_g"))


def said(stdout="", stderr=""):
    return lambda *_: subprocess.CompletedProcess([], 0, stdout, stderr)


def test_releases_are_what_pip_names_trials_apart(monkeypatch):
    text = "mujoco (4.0.1)\nAvailable versions: 4.0.1, 4.0.0, 3.10.0, 3.9.1, 3.9.0, 3.9.0rc1\n"
    monkeypatch.setattr(releases, "pip", said(text))
    found = listed("mujoco")
    assert [one.version for one in found] == ["3.9.0", "3.9.1", "3.10.0", "4.0.0", "4.0.1"]
    here = metadata.version("mujoco")
    minors, problem = chosen("mujoco", ("minor",))
    assert not problem
    assert minors == sorted(
        {Release("mujoco", version) for version in ("3.9.1", "3.10.0", "4.0.1", here)},
        key=lambda release: release.order,
    )
    named, _ = chosen("mujoco", ("mujoco==3.2.7", "pymunk==6.0.0"))
    assert [one.version for one in named] == ["3.2.7", here]


def test_pip_that_names_nothing_is_one_line(monkeypatch):
    monkeypatch.setattr(releases, "pip", said(stderr="ERROR: no network\nWARNING: a\n"))
    with pytest.raises(releases.MissingError, match=r"^the releases of Box2D .*: ERROR: no netw"):
        listed("box2d")


@pytest.mark.parametrize("word", ["newest", "mujoco", "mujoco==", "mujoco==x", "pymunk==7.0.0"])
def test_what_names_no_release_is_refused(word):
    with pytest.raises(BadInputError, match=r"--releases is .*; it must be installed, minor, all"):
        check_releases([word], ["mujoco"])


def answers(peaks, outcomes="rocked", message=""):
    """Return answers to two cases of which the first is the paper's figure 5-b."""
    rows = [
        {
            **{"engine": "mujoco", "source": "mujoco:naive", "set": "random", "case": case},
            **{"aspect": 3.0, "width_m": 0.5, "half_cycles": 2, "amplitude_g": 0.4},
            **{"omega_over_p": 2.9, "peak_ratio": peak, "message": message, "release": ""},
        }
        for case, peak in enumerate(peaks)
    ]
    return pd.DataFrame(rows).assign(outcome=outcomes)


def tables_of(found):
    """Return both tables of releases with some answers, of one without the reason why."""
    asked = [
        Asked(Release("mujoco", name), None, problem=each)
        if isinstance(each, str)
        else Asked(Release("mujoco", name), each)
        for name, each in found.items()
    ]
    lines = releases_table(asked)
    return lines, changes_table(lines)


def test_a_change_is_what_moves_by_more_than_a_millionth_or_turns():
    found = {
        "3.0.0": answers([0.3, 0.4]),
        "3.1.0": answers([0.3 * (1 + 0.5 * CHANGED), 0.4]),
        "3.2.0": "cannot be installed: no wheel",
        "3.3.0": answers([0.3, 0.4 * (1 + 3 * CHANGED)]),
        "3.4.0": answers([0.3, 0.4], ["rocked", "failed"]),
    }
    lines, changes = tables_of(found)
    assert lines["moved"].to_list() == pytest.approx(
        [math.nan, 0.5e-6, math.nan, 3e-6, 0.0], rel=1e-6, abs=1e-9, nan_ok=True
    )
    assert changes[["before", "release", "moved_cases", "turned"]].to_numpy().tolist() == [
        ["3.1.0", "3.3.0", 1, 0],
        ["3.3.0", "3.4.0", 0, 1],
    ]


def test_what_moved_and_what_did_not_is_said():
    found = {"3.0.0": answers([0.3, 0.4]), "3.1.0": answers([0.3, 0.4])}
    assert finding(*tables_of(found)) == (
        "From one release to the next no answer moves by more than 1e-06 in mujoco "
        "(3.0.0 to 3.1.0)."
    )
    lines, changes = tables_of({**found, "3.2.0": answers([0.3, 0.5])})
    assert finding(lines, changes) == (
        "From one release to the next answers move by more than 1e-06 in mujoco (3.0.0 to 3.2.0, "
        "at 1 of 2 steps)."
    )
    (change,) = changes.to_dict("records")
    assert (change["before"], change["release"], change["presets"]) == ("3.1.0", "3.2.0", "naive")
    assert (change["moved_cases"], change["cases"]) == (1, 2)
    assert change["moved"] == pytest.approx(0.25)


def test_a_release_that_answers_nothing_is_passed_over():
    """Its row says why, and its neighbours are held against each other."""
    lost = answers([math.nan, math.nan], "failed", "AttributeError: x")
    found = {"3.0.0": answers([0.3, 0.4]), "3.1.0": lost, "3.2.0": answers([0.3, 0.5])}
    lines, changes = tables_of(found)
    assert lines["message"].to_list() == ["", "AttributeError: x", ""]
    assert changes[["before", "release"]].to_numpy().tolist() == [["3.0.0", "3.2.0"]]
    assert lines["turned"].iloc[-1] == 0 and lines["moved"].iloc[-1] == pytest.approx(0.25)


def test_notes_are_of_the_releases_after_one_up_to_another():
    for engine in {note.release.engine for note in NOTES}:
        notes = [note for note in NOTES if note.release.engine == engine]
        orders = [note.release.order for note in notes]
        assert orders == sorted(orders)
        assert all(note.text and note.link.startswith("https://") for note in notes)
        assert notes_between(notes[0].release, notes[-1].release) == notes[1:]


def known_elsewhere(name, source):
    """Return the rows of a preset on the same cases in the tables of another study."""
    if name == "random":
        rows = pd.read_csv(PUBLISHED / "validate" / "errors.csv")
        return rows[(rows["source"] == source) & (rows["case"] < RANDOM)]
    rows = pd.read_csv(PUBLISHED / "presets" / "sweep.csv")
    return with_reference(rows[(rows["source"] == source) & (rows["figure"] == FIGURE)])


@pytest.mark.parametrize("name", [f"figure {FIGURE}", "random"])
def test_the_published_lines_of_the_pinned_releases_are_those_of_other_studies(name):
    lines, found = STUDY.read(PUBLISHED / "versions", "releases"), 0
    made = record_of(PUBLISHED / "versions")
    every = EVERY if made["settings"]["quick"] else 1
    for line in lines[lines["set"] == name].to_dict("records"):
        if releases.installed(line["engine"]).version != line["release"]:
            continue
        engine, _, preset = line["source"].partition(":")
        source = engine if preset == "landing" else line["source"]
        mine = known_elsewhere(name, source).iloc[::every]
        if preset == "fixed" or mine.empty:  # that is asked at another step
            continue
        found += 1
        assert (line["cases"], line["right"]) == (len(mine), mine["agrees"].sum())
        errors = mine["error"].abs()
        kept = [line["median_error"], line["max_error"]]
        assert kept == pytest.approx([errors.median(), errors.max()], rel=1e-4)
    assert found > 1


def test_the_published_changes_follow_from_the_published_releases():
    folder = PUBLISHED / "versions"
    changes = changes_table(STUDY.read(folder, "releases"))
    kept = STUDY.read(folder, "changes")
    pd.testing.assert_frame_equal(changes, kept, check_dtype=False, rtol=1e-12)
