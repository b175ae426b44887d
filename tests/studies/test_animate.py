"""Films: what is shown, which case, what is refused."""

import errno
import io
import math
import os

import numpy as np
import pandas as pd
import pytest
from commanding import CASE, refused
from given import BLOCK
from matplotlib.collections import PolyCollection
from PIL import Image

from analytic import RockingFrame, SinePulse, SlidingBlock, Still
from studies.__main__ import run
from studies.animate.study import most_different, shown
from studies.drawing import film as film_module
from studies.drawing.block import outlines
from studies.drawing.film import GifWriter, Stage, verdict
from studies.old.arguments import BadInputError
from studies.old.executors import Local
from studies.old.posing import Posed
from studies.old.provenance import seal


@pytest.mark.parametrize("theta", [0.3, -0.3])
def test_a_leaning_block_stands_on_one_corner(theta):
    (corners,) = outlines(BLOCK, theta)
    lowest = corners[np.argmin(corners[:, 1])]
    assert lowest == pytest.approx([math.copysign(0.25, theta), 0.0])
    assert corners[:, 1].min() >= 0.0
    # the top leans the same way
    assert math.copysign(1.0, corners[2:, 0].mean()) == math.copysign(1.0, theta)
    sides = np.linalg.norm(np.diff(corners, axis=0, append=corners[:1]), axis=1)
    assert sides == pytest.approx([0.5, 1.5, 0.5, 1.5])


def test_an_overturned_block_lies():
    pulse = SinePulse(amplitude=3.924, omega=6.2832, half_cycles=2)
    times = np.linspace(0.0, 4.0, 60)
    rows = shown(BLOCK, Posed(pulse, (0.0, 0.0)), ("exact", "housner"), times, Local(1, 10.0))
    assert abs(rows[1]["theta"][-1]) == pytest.approx(math.pi / 2)
    assert abs(rows[0]["theta"]).max() < BLOCK.alpha
    (flat,) = outlines(BLOCK, float(rows[1]["theta"][-1]))
    assert flat[:, 1].max() == pytest.approx(0.5)


def test_a_verdict_is_given_when_it_happens():
    theta = BLOCK.alpha * np.array([0.0, 0.2, 0.5, 0.3, 0.1])
    fallen = BLOCK.alpha * np.array([0.0, 1.1, 0.9, 1.2, 4.0])
    rows = [{"source": "mujoco:naive", "outcome": "rocked", "theta": 0.8 * theta},
            {"source": "housner", "outcome": "overturned", "theta": fallen},
            {"source": "exact", "outcome": "rocked", "theta": theta},
            {"source": "exact", "outcome": "at rest", "theta": 0.0 * theta}]  # fmt: skip
    told = [verdict(row, theta, BLOCK.alpha) for row in rows]
    assert told == [(2, "peak −20.0 %"), (3, "overturned"), (2, "peak 0.50 θcr"), (4, "at rest")]


def test_the_exact_outline_is_drawn_over_every_other_block():
    times = np.linspace(0.0, 1.0, 5)
    rows = [
        {"source": "exact", "outcome": "rocked", "theta": 0.1 * times},
        {"source": "housner", "outcome": "rocked", "theta": 0.3 * times},
    ]
    stage = Stage(BLOCK, Still(), times, rows)
    stage.show(4)
    assert drawn(stage.drawing.axes[1]) == [
        pytest.approx(outlines(BLOCK, 0.3)[0]),
        pytest.approx(outlines(BLOCK, 0.1)[0]),
    ]


def drawn(panel):
    """Return the corners of the bodies in a panel, apart from its ground."""
    bodies = [found for found in panel.collections if isinstance(found, PolyCollection)]
    return [path.vertices[:4] for found in bodies for path in found.get_paths()]


@pytest.mark.parametrize("theta", [0.2, -0.2])
def test_a_beam_lies_flat_on_the_corners_of_its_columns(theta):
    frame = RockingFrame(width=0.5, height=1.5, columns=3, load=2.0)
    stage = Stage(frame, Still(), np.arange(2.0), [
        {"source": "mujoco:naive", "outcome": "rocked", "theta": np.array([0.0, theta])}
    ])  # fmt: skip
    stage.show(1)
    *columns, beam = drawn(stage.drawing.axes[0])
    assert len(columns) == 3
    underside = beam[beam[:, 1] < beam[:, 1].mean()]
    for column, home in zip(columns, (-3.0, 0.0, 3.0), strict=True):
        pivot, top = column[column[:, 1].argmin()], column[column[:, 1].argmax()]
        assert pivot == pytest.approx([home + math.copysign(0.25, theta), 0.0], abs=1e-12)
        # the corner that carries the beam is where it was on the beam
        moved = top[0] - (home - math.copysign(0.25, theta))
        assert beam[:, 0].mean() == pytest.approx(moved)
        assert underside[:, 1] == pytest.approx([column[:, 1].max()] * 2)
    low, high = stage.drawing.axes[0].get_xlim()
    assert low < min(beam[:, 0]) < max(beam[:, 0]) < high


def test_a_slide_is_drawn_where_it_is_and_told_where_it_lies():
    box = SlidingBlock(width=1.0, height=0.5, friction=0.2)
    exact, late = np.array([0.0, -0.2, 0.1]), np.array([0.0, -0.1, 0.08])
    stage = Stage(box, Still(), np.arange(3.0), [
        {"source": "exact", "outcome": "slid", "theta": exact},
        {"source": "mujoco:naive", "outcome": "slid", "theta": late},
    ])  # fmt: skip
    stage.show(1)
    bodies, ghost = drawn(stage.drawing.axes[1])
    assert [bodies[:, 0].mean(), ghost[:, 0].mean()] == pytest.approx([-0.1, -0.2])
    stage.show(2)
    said = [axes.texts[0].get_text() for axes in stage.drawing.axes[:2]]
    assert said == ["lies at +100.0 mm", "−20 mm off"]


@pytest.mark.parametrize(
    "options",
    [["--scene", "frame", "--load", "2"], ["--scene", "slide", "--friction", "0.2"]],
)
def test_another_scene_is_shown_and_an_engine_that_cannot_hold_it_is_named(
    options, tmp_path, capsys
):
    frame = "frame" in options
    asked = "rapier:landing" if frame else "mujoco:fixed"
    film = ["--out", str(tmp_path / "film.gif"), "--sources", "exact", asked, "--slower", "0.2"]
    assert run(["animate", *CASE, *options, *film]) == int(frame)
    told = capsys.readouterr().err
    assert ("failed: rapier:landing: not available: " in told) == frame
    with Image.open(tmp_path / "film.gif") as film:
        assert film.n_frames > 10


def sweep(folder, peaks):
    common = {"figure": 8, "pulse": "full-sine", "excess_g": 0.1, "aspect": 3, "width_m": 0.5}
    rows = [
        {**common, "omega_over_p": omega, "source": source, "peak_ratio": peak}
        for omega, pair in peaks.items()
        for source, peak in zip(("exact", "housner"), pair, strict=True)
    ]
    pd.DataFrame(rows).to_csv(folder / "sweep.csv", index=False)
    (folder / "provenance.json").write_text("{}")
    seal(folder)


def test_the_case_is_the_one_where_the_sources_differ_most(tmp_path):
    sweep(tmp_path, {1.0: (0.5, 0.6), 1.1: (0.1, 0.2), 1.2: (math.inf, math.inf)})
    assert most_different(tmp_path, ["exact", "housner"]).omega_over_p == 1.1
    sweep(tmp_path, {1.0: (0.5, math.inf), 1.1: (0.1, 0.9), 1.2: (0.3, math.inf)})
    assert most_different(tmp_path, ["exact", "housner"]).omega_over_p == 1.2
    with pytest.raises(BadInputError, match="lacks mujoco"):
        most_different(tmp_path, ["mujoco"])


def test_a_film_moves(tmp_path):
    film = tmp_path / "film.gif"
    arguments = [*CASE, "--sources", "exact", "modified", "--slower", "0.2", "--out", str(film)]
    assert run(["animate", *arguments]) == 0
    with Image.open(film) as images:
        assert images.n_frames > 10
        first = np.asarray(images.convert("RGB"), dtype=float)
        images.seek(images.n_frames // 3)
        later = np.asarray(images.convert("RGB"), dtype=float)
    assert np.abs(first - later).max() > 100.0


def test_a_film_begins_where_the_block_is_released(tmp_path, monkeypatch):
    kept = []
    monkeypatch.setattr(film_module, "write_film", lambda *given: kept.append(given))
    release = ["--width", "0.5", "--height", "1.5", "--tilt", "-0.7", "--rate", "0.1"]
    arguments = [*release, "--sources", "exact", "pybullet", "--out", str(tmp_path / "film.gif")]
    assert run(["animate", *arguments]) == 0
    ((_, block, motion, times, rows, _),) = kept
    assert motion == Still()
    for row in rows:
        assert row["theta"][0] == pytest.approx(-0.7 * block.alpha, rel=1e-9)
        rate = (row["theta"][1] - row["theta"][0]) / times[1]
        assert 0.0 < rate < 2.0 * block.alpha * block.p


def pixels(stage):
    frame = io.BytesIO()
    stage.drawing.savefig(frame)
    return np.frombuffer(frame.getvalue(), np.uint8).astype(int)


def test_what_stood_still_is_drawn_once_and_nothing_stays_of_a_frame_before():
    pulse = SinePulse(amplitude=3.924, omega=6.2832, half_cycles=2)
    times = np.linspace(0.0, 1.0, 11)
    rows = [{"source": "exact", "outcome": "rocked", "theta": 0.3 * times}]
    stage, fresh = (Stage(BLOCK, pulse, times, rows) for _ in range(2))
    frames = []
    stage.drawing.still(stage.moving)
    for frame in (0, 10, 5):
        stage.show(frame)
        frames.append(pixels(stage))
    fresh.show(5)
    fresh.drawing.still(fresh.moving)
    assert (frames[-1] == pixels(fresh)).all()
    assert len(np.unique([np.count_nonzero(frames[0] != frame) for frame in frames])) == 3
    # drawn whole, only what lies on the clock's line may differ: the frame around it
    fresh.show(5)
    for artist in fresh.moving:
        artist.set_animated(False)
    fresh.drawing.canvas.draw()
    whole = np.asarray(fresh.drawing.canvas.buffer_rgba()).astype(int).ravel()
    assert np.count_nonzero(whole != frames[-1]) < 100


@pytest.mark.parametrize("content", ["", "figure,source,peak_ratio\n8,exact,0.5\n"])
def test_what_no_sweep_wrote_is_one_line(content, tmp_path, capsys):
    (tmp_path / "sweep.csv").write_text(content)
    film = tmp_path / "film.gif"
    refused(capsys, ["animate", "--results", tmp_path, "--out", film], "--results", "sweep.csv")
    assert not film.exists()


def test_a_film_that_cannot_be_finished_leaves_nothing(tmp_path, monkeypatch, capsys):
    def full(*_, **__):
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    film = tmp_path / "film.gif"
    film.write_bytes(b"before")
    monkeypatch.setattr(GifWriter, "finish", full)
    monkeypatch.setattr(GifWriter, "grab_frame", lambda self, **_: None)
    arguments = [*CASE, "--sources", "exact", "--slower", "0.1", "--out", str(film)]
    refused(capsys, ["animate", *arguments], "No space left", str(film))
    assert film.read_bytes() == b"before"
    assert [path.name for path in tmp_path.iterdir()] == ["film.gif"]
