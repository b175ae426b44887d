"""Tossed cubes: a small folder in the form of the public one, made here."""

from zipfile import ZipFile

import numpy as np
import pandas as pd
import pytest
from commanding import refused
from scipy.spatial.transform import Rotation

from studies.experiments import STUDY
from studies.experiments.cubes import AUTHORS, HALF, HZ, SETTINGS, WORLDS, off, read_tosses, turned
from studies.kit.tables import packed

TIMES = np.arange(60) / HZ
OMEGA, SPEED, HEIGHT = np.array([3.0, -2.0, 4.0]), np.array([0.5, -0.3, 0.0]), 0.4


@pytest.fixture
def tosses(tmp_path):
    """A cube that flies until it meets the board at rest, with velocities that are wrong."""
    frames = np.zeros((60, 19))
    frames[:, :3] = SPEED * TIMES[:, None] + [0.1, 0.2, HEIGHT]
    frames[:, 2] -= 0.5 * 9.81 * TIMES**2
    frames[:, :3] /= HALF
    frames[:, 3:7] = np.roll(Rotation.from_rotvec(OMEGA * TIMES[:, None]).as_quat(), 1, axis=1)
    frames[:, 7:13] = 9.0
    for number in (2, 10):
        with ZipFile(tmp_path / f"{number}.pt", "w") as archive:
            archive.writestr("archive/data.pkl", "")
            archive.writestr("archive/data/123", frames.tobytes())
    return tmp_path


def test_a_toss_begins_before_the_board_with_the_velocities_of_its_flight(tosses):
    read = read_tosses(tosses)
    start, first = read[1][0], 60 - len(read[1])
    assert len(read) == 2 and start[2] > HALF * np.sqrt(3.0) > read[1][3][2]
    assert start[7:9] == pytest.approx(SPEED[:2])
    assert start[9] == pytest.approx(-9.81 * TIMES[first - 1])  # as the peers take it
    assert start[10:13] == pytest.approx(OMEGA)


@pytest.mark.parametrize("engine", WORLDS)
def test_a_cube_flies_lands_and_lies(tosses, engine):
    pytest.importorskip(engine)
    toss = np.repeat(read_tosses(tosses)[0][:1], 300, axis=0)
    found = WORLDS[engine](dict(zip(SETTINGS, AUTHORS[engine], strict=True)))(toss)
    times = np.arange(3) / HZ
    path = toss[0, :3] + toss[0, 7:10] * times[:, None]
    path[:, 2] -= 0.5 * 9.81 * times**2
    np.testing.assert_allclose(found[:3, :3], path, atol=2e-4)
    start, turn = turned(np.array([toss[0, :7], found[2]]))
    assert (start.inv() * turn).as_rotvec() == pytest.approx(OMEGA * times[2], abs=1e-3)
    assert found[-1, 2] == pytest.approx(HALF, abs=1e-3)
    assert off(found, found)[:3] == pytest.approx([0.0, 0.0, 0.0], abs=1e-12)


def test_fitted_settings_are_told_of_tosses_that_no_fit_has_seen():
    """Of six tosses the fit sees three, in which the second settings lose least."""
    losses = {"default": 6 * [3.0], "fitted 0": [1.0, 0.0] * 3, "fitted 1": [0.5, 2.0] * 3}
    rows = [
        {"engine": "mujoco", "settings": name, **dict.fromkeys(SETTINGS, 1.0),
         "outcome": "measured",
         "found": packed(np.array([[it, 0.001, np.pi, it > 1.0] for it in each]))}
        for name, each in losses.items()
    ]  # fmt: skip
    lines = STUDY.tabulate(pd.DataFrame(rows))["settings"].set_index("settings")
    assert lines.index.tolist() == ["default", "fitted"]
    found = lines.loc["fitted", ["tosses", "loss", "place_mm", "angle_deg", "face", "loss_of_all"]]
    assert found.tolist() == [3, 2.0, 1.0, 180.0, 1.0, 1.25]
    assert "100 %" in STUDY.finding({"settings": lines.reset_index()})


def test_another_folder_is_refused(tosses, tmp_path, capsys):
    asked = ["experiments", "--out", tmp_path / "out"]
    refused(capsys, [*asked, "--cubes", tmp_path / "none"], "--cubes", "none")
    refused(capsys, [*asked, "--cubes", tosses, "--sources", "dart"], "dart", "mujoco")
    (tosses / "3.pt").write_text("no zip")
    refused(capsys, [*asked, "--cubes", tosses], "3.pt", "--cubes")


def test_an_engine_without_a_result_is_said():
    rows = pd.DataFrame([{"engine": "mujoco", "settings": "default", "outcome": "failed"}])
    assert STUDY.finding(STUDY.tabulate(rows)) == "No engine gave a result."


@pytest.mark.parametrize(
    ("axis", "turn", "right"),
    [("z", np.pi, 1.0), ("x", np.pi, 0.0), ("x", np.pi / 2, 0.0), ("x", 0.3, 1.0)],
)
def test_a_face_is_right_if_the_same_one_is_up(axis, turn, right):
    upright, turned = np.zeros((2, 1, 7))
    upright[:, 3] = 1.0
    turned[0, 3:] = np.roll(Rotation.from_euler(axis, turn).as_quat(), 1)
    assert off(turned, upright)[2:] == pytest.approx([turn, right])
