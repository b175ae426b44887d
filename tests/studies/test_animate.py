"""Films: what is shown, and what a film that fails leaves."""

import errno
import math
import os

import numpy as np
import pytest
from commanding import CASE, refused
from given import BLOCK, PULSE
from matplotlib.collections import PolyCollection
from PIL import Image

from analytic import RockingFrame, SlidingBlock, Still
from studies.__main__ import run
from studies.animate import moved
from studies.drawing import film as film_module
from studies.drawing.film import Stage, outlines, verdict
from studies.kit.arguments import Yours
from studies.kit.jobs import Question


@pytest.fixture(autouse=True)
def few_frames(monkeypatch):
    monkeypatch.setattr("studies.animate.FRAMES_A_SECOND", 2)


def drawn(panel):
    bodies = [found for found in panel.collections if isinstance(found, PolyCollection)]
    return [path.vertices[:4] for found in bodies for path in found.get_paths()]


@pytest.mark.parametrize("theta", [0.3, -0.3])
def test_a_leaning_block_stands_on_one_corner(theta):
    (corners,) = outlines(BLOCK, theta)
    lowest = corners[np.argmin(corners[:, 1])]
    assert lowest == pytest.approx([math.copysign(0.25, theta), 0.0])
    assert math.copysign(1.0, corners[2:, 0].mean()) == math.copysign(1.0, theta)
    sides = np.linalg.norm(np.diff(corners, axis=0, append=corners[:1]), axis=1)
    assert sides == pytest.approx([0.5, 1.5, 0.5, 1.5])


def test_an_overturned_block_lies():
    times = np.linspace(0.0, 4.0, 60)
    case = Question(system=BLOCK, motion=PULSE, duration=4.0, times=times)
    exact, housner = moved(case, ("exact", "housner"), Yours())
    assert abs(exact["theta"]).max() < BLOCK.alpha
    assert abs(housner["theta"][-1]) == pytest.approx(math.pi / 2)
    (flat,) = outlines(BLOCK, float(housner["theta"][-1]))
    assert flat[:, 1].max() == pytest.approx(0.5)


def test_a_verdict_is_given_when_it_happens():
    theta = BLOCK.alpha * np.array([0.0, 0.2, 0.5, 0.3, 0.1])
    fallen = BLOCK.alpha * np.array([0.0, 1.1, 0.9, 1.2, 4.0])
    rows = [("overturned", fallen), ("rocked", theta), ("at rest", 0.0 * theta)]
    found = [verdict({"outcome": outcome, "theta": it}, BLOCK) for outcome, it in rows]
    assert found == [(3, "overturned"), (2, "peak 0.50 θcr"), (4, "at rest")]
    box = SlidingBlock(width=1.0, height=0.5, friction=0.2)
    slid = {"outcome": "slid", "theta": np.array([0.0, -0.2, 0.1])}
    assert verdict(slid, box) == (2, "lies at +100.0 mm")


@pytest.mark.parametrize("theta", [0.2, -0.2])
def test_bodies_are_where_they_are_and_the_exact_outline_is_over_every_other(theta):
    frame = RockingFrame(width=0.5, height=1.5, columns=3, load=2.0)
    rows = [{"source": name, "outcome": "rocked", "theta": np.array([0.0, part * theta])}
            for name, part in (("exact", 1.0), ("mujoco:default", 0.5))]  # fmt: skip
    stage = Stage(frame, Still(), np.arange(2.0), rows)
    stage.show(1)
    first, second = stage.figure.axes
    *columns, beam = drawn(first)
    shown = [outlines(frame, 0.5 * theta), outlines(frame, theta)]
    assert np.array(drawn(second)) == pytest.approx(np.concatenate(shown))
    for column, home in zip(columns, (-3.0, 0.0, 3.0), strict=True):
        pivot = column[column[:, 1].argmin()]
        assert pivot == pytest.approx([home + math.copysign(0.25, theta), 0.0], abs=1e-12)
        assert beam[:, 1].min() == pytest.approx(column[:, 1].max())
    low, high = first.get_xlim()
    assert low < min(beam[:, 0]) < max(beam[:, 0]) < high


def test_a_film_moves_in_other_scenes_too_and_names_whom_it_cannot_show(tmp_path, capsys):
    frame = ("--scene", "frame", "--load", "2", "--sources", "exact", "rapier:landing")
    film = tmp_path / "film.gif"
    assert run(["animate", *CASE, *frame, "--out", str(film)]) == 1
    assert "failed: rapier:landing: not available: " in capsys.readouterr().err
    with Image.open(film) as images:
        assert images.n_frames > 5
        first = np.asarray(images.convert("RGB"), dtype=float)
        images.seek(images.n_frames // 3)
        assert np.abs(first - np.asarray(images.convert("RGB"), dtype=float)).max() > 100.0


def test_a_film_begins_where_the_block_is_released(tmp_path, monkeypatch):
    kept = []
    monkeypatch.setattr(film_module, "write_film", lambda *given: kept.append(given))
    release = [*CASE[:4], "--tilt", "-0.7", "--rate", "0.1", "--sources", "exact", "pybullet"]
    assert run(["animate", *release, "--out", str(tmp_path / "film.gif")]) == 0
    ((_, block, motion, times, rows, _),) = kept
    assert motion == Still()
    for row in rows:
        assert row["theta"][0] == pytest.approx(-0.7 * block.alpha, rel=1e-9)
        rate = (row["theta"][1] - row["theta"][0]) / times[1]
        assert 0.0 < rate < 2.0 * block.alpha * block.p


def test_a_film_that_cannot_be_finished_leaves_what_was_there(tmp_path, monkeypatch, capsys):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    film = tmp_path / "film.gif"
    film.write_bytes(b"before")
    monkeypatch.setattr(Image.Image, "save", full)
    arguments = [*CASE, "--sources", "exact", "--out", str(film)]
    refused(capsys, ["animate", *arguments], "No space left", str(film))
    assert film.read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
