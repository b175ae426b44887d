"""Films: what is shown, which case, what is refused."""

import errno
import math
import os

import numpy as np
import pandas as pd
import pytest
from commanding import CASE, refused
from given import BLOCK, PULSE
from matplotlib.collections import PolyCollection
from PIL import Image

from analytic import RockingFrame, SlidingBlock, Still
from studies.__main__ import run
from studies.animate import most_different, moved
from studies.cases.refusal import BadInputError
from studies.drawing import film as film_module
from studies.drawing.block import outlines
from studies.drawing.film import Stage, verdict
from studies.kit.jobs import Question
from studies.kit.options import Yours
from studies.kit.store import write_record


def filmed(tmp_path, *options):
    """Run a short film, and return its exit code and its path."""
    film = tmp_path / "film.gif"
    return run(["animate", *CASE, *options, "--slower", "0.1", "--out", str(film)]), film


def drawn(panel):
    """Return the corners of the bodies in a panel, apart from its ground."""
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
    rows = [{"source": "mujoco:naive", "outcome": "rocked", "theta": 0.8 * theta},
            {"source": "housner", "outcome": "overturned", "theta": fallen},
            {"source": "exact", "outcome": "rocked", "theta": theta},
            {"source": "exact", "outcome": "at rest", "theta": 0.0 * theta}]  # fmt: skip
    found = [verdict(row, theta, BLOCK) for row in rows]
    assert found == [(2, "peak −20.0 %"), (3, "overturned"), (2, "peak 0.50 θcr"), (4, "at rest")]
    box, place = SlidingBlock(width=1.0, height=0.5, friction=0.2), np.array([0.0, -0.2, 0.1])
    rows = [{"source": name, "outcome": "slid", "theta": place * part}
            for name, part in (("exact", 1.0), ("mujoco", 0.8))]  # fmt: skip
    assert [verdict(row, place, box) for row in rows] == [
        (2, "lies at +100.0 mm"),
        (2, "−20 mm off"),
    ]


@pytest.mark.parametrize("theta", [0.2, -0.2])
def test_bodies_are_where_they_are_and_the_exact_outline_is_over_every_other(theta):
    frame = RockingFrame(width=0.5, height=1.5, columns=3, load=2.0)
    rows = [{"source": name, "outcome": "rocked", "theta": np.array([0.0, part * theta])}
            for name, part in (("exact", 1.0), ("mujoco:naive", 0.5))]  # fmt: skip
    stage = Stage(frame, Still(), np.arange(2.0), rows)
    stage.picture(1)
    first, second, _ = stage.figure.axes
    *columns, beam = drawn(first)
    shown = [outlines(frame, 0.5 * theta), outlines(frame, theta)]
    assert np.array(drawn(second)) == pytest.approx(np.concatenate(shown))
    for column, home in zip(columns, (-3.0, 0.0, 3.0), strict=True):
        pivot = column[column[:, 1].argmin()]
        assert pivot == pytest.approx([home + math.copysign(0.25, theta), 0.0], abs=1e-12)
        assert beam[:, 1].min() == pytest.approx(column[:, 1].max())
    low, high = first.get_xlim()
    assert low < min(beam[:, 0]) < max(beam[:, 0]) < high


def test_what_stands_still_is_drawn_once_and_nothing_stays_of_a_picture_before():
    times = np.linspace(0.0, 1.0, 11)
    rows = [{"source": "exact", "outcome": "rocked", "theta": 0.3 * times}]
    stage, fresh = (Stage(BLOCK, PULSE, times, rows) for _ in range(2))
    pictures = [stage.picture(frame) for frame in (0, 10, 5)]
    assert (pictures[-1] == fresh.picture(5)).all()
    assert len({picture.tobytes() for picture in pictures}) == 3


def test_a_film_moves_in_other_scenes_too_and_names_whom_it_cannot_show(tmp_path, capsys):
    frame = ("--scene", "frame", "--load", "2", "--sources", "exact", "rapier:landing")
    code, film = filmed(tmp_path, *frame)
    assert code == 1
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


def sweep(folder, peaks):
    common = {"figure": 8, "pulse": "full-sine", "excess_g": 0.1, "aspect": 3, "width_m": 0.5}
    rows = [
        {**common, "omega_over_p": omega, "source": source, "peak_ratio": peak}
        for omega, pair in peaks.items()
        for source, peak in zip(("exact", "housner"), pair, strict=True)
    ]
    pd.DataFrame(rows).to_csv(folder / "sweep.csv", index=False)
    write_record(folder, {})


def test_the_case_is_the_one_where_the_sources_differ_most(tmp_path):
    sweep(tmp_path, {1.0: (0.5, 0.6), 1.1: (0.1, 0.2), 1.2: (math.inf, math.inf)})
    assert most_different(tmp_path, ["exact", "housner"]).omega_over_p == 1.1
    sweep(tmp_path, {1.0: (0.5, math.inf), 1.1: (0.1, 0.9), 1.2: (0.3, math.inf)})
    assert most_different(tmp_path, ["exact", "housner"]).omega_over_p == 1.2
    with pytest.raises(BadInputError, match="lacks mujoco"):
        most_different(tmp_path, ["mujoco"])


@pytest.mark.parametrize("content", ["", "figure,source,peak_ratio\n8,exact,0.5\n"])
def test_what_no_sweep_wrote_is_refused(content, tmp_path, capsys):
    (tmp_path / "sweep.csv").write_text(content)
    film = tmp_path / "film.gif"
    refused(capsys, ["animate", "--results", tmp_path, "--out", film], "--results", "sweep.csv")
    assert not film.exists()


def test_a_film_that_cannot_be_finished_leaves_what_was_there(tmp_path, monkeypatch, capsys):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    film = tmp_path / "film.gif"
    film.write_bytes(b"before")
    monkeypatch.setattr(Image.Image, "save", full)
    arguments = [*CASE, "--sources", "exact", "--slower", "0.1", "--out", str(film)]
    refused(capsys, ["animate", *arguments], "No space left", str(film))
    assert film.read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
