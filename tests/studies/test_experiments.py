"""Rocks on a shake table, tossed cubes: small folders in the form of the public ones, made here."""

from itertools import product
from zipfile import ZipFile

import numpy as np
import pandas as pd
import pytest
from commanding import refused
from scipy.spatial.transform import Rotation

from studies.__main__ import run
from studies.cases.rocks import DT, FELL, MESHES, TABLE, TUNED, read_mesh, read_motion, read_tests
from studies.experiments import STUDY
from studies.experiments.cubes import AUTHORS, HALF, HZ, SETTINGS, WORLDS, off, read_tosses, turned
from studies.experiments.rocks import FACTORS, FITTED, GRID
from studies.kit.tables import packed

SPACE = 'xmlns="http://schemas.openxmlformats.org/spreadsheetml/2006/main"'
FACES = ["124", "143", "578", "586", "156", "162", "348", "387", "137", "175", "268", "284"]
HEADS = ["Test Number", *(text for rock in MESHES for text in (FELL.format(rock), TUNED[rock]))]


def workbook(path, heads, lines):
    rows = "<row/>"
    for n, line in enumerate([range(len(heads)), *lines], 1):
        cells = (f'<c r="{chr(65 + k)}{n}"><v>{value}</v></c>' for k, value in enumerate(line))
        rows += f"<row>{''.join(cells)}</row>"
    words = "".join(f"<si><t>{head} </t></si>" for head in heads)
    with ZipFile(path, "w") as book:
        book.writestr("xl/sharedStrings.xml", f"<sst {SPACE}>{words}</sst>")
        book.writestr("xl/worksheets/sheet1.xml", f"<worksheet {SPACE}>{rows}</worksheet>")


@pytest.fixture
def rocks(tmp_path):
    """Pulses of 0.3 g, of growing length; the last two fell; the first two have no record.

    The rocks are boxes 0.2 m wide and 0.8 m high, with a foot of 0.1 m on the right.
    """
    folder, tests = tmp_path / "rocks", range(11, 17)
    (folder / TABLE).mkdir(parents=True)
    workbook(folder / TABLE / "PGVA-zchen.xlsx", ["Serial Number", "Test Number", "PGA", "PGVA"],
             [(n, test, 0.3, 0.01 * test) for n, test in enumerate(tests)])  # fmt: skip
    workbook(folder / TABLE / "Results_Granite.xlsx", HEADS,
             [(test, *[int(test > 14)] * 4) for test in tests])  # fmt: skip
    points = [*product((5.0, 5.2), (7.0, 7.9), (9.0, 9.8)), (5.3, 7.0, 9.0), (5.3, 7.9, 9.0)]
    lines = ["v {} {} {}".format(*point) for point in points]
    for path in MESHES.values():
        (folder / path).parent.mkdir(parents=True)
        (folder / path).write_text("\n".join([*lines, *("f " + "//1 ".join(f) for f in FACES)]))
    for test in tests[2:]:
        times = DT * np.arange(400)
        pulse = 0.3 * np.sin(np.pi * times / (0.05 * (test - 10))) * (times < 0.05 * (test - 10))
        table = pd.DataFrame({n: 0.03 + pulse if n % 2 else times for n in range(8)})
        text = table.to_csv(sep="\t", index=False, float_format="%.6g").replace("\n", "\t\n")
        (folder / TABLE / f"Test{test:03d}.txt").write_text(text)
    return folder


def test_a_folder_is_read(rocks):
    tests, motion = read_tests(rocks), read_motion(rocks / TABLE / "Test014.txt")
    assert tests["pgv_m_s"].iloc[3] == pytest.approx(9.81 * 0.3 * 0.14)
    assert tests["authors_1"].tolist() == tests["fell_2"].tolist() == [0, 0, 0, 0, 1, 1]
    assert motion.samples.mean() == pytest.approx(0.0, abs=1e-12) and motion.dt == DT
    assert np.ptp(motion.samples) == pytest.approx(0.3 * 9.81, rel=1e-3)
    blocks = read_mesh(rocks / MESHES[1])
    found = [(each.width, each.offset, each.height, each.inertia) for each in blocks]
    alike = (0.8, (0.2**2 + 0.8**2) / 12.0)
    wanted = [(0.3, 0.05, *alike), (0.3, -0.05, *alike), (0.2, 0.0, *alike)]
    np.testing.assert_allclose(found, wanted, rtol=1e-12)


@pytest.mark.slow
def test_the_command_tells_every_test_that_has_a_record(rocks, tmp_path):
    asked = f"experiments --rocks {rocks} --out {tmp_path / 'out'} --tests 3 --sources exact pymunk"
    assert run(f"{asked}:default".split()) == 0
    tables = STUDY.read(tmp_path / "out")
    assert tables["rock-1"]["test"].tolist() == [13, 14, 15, 16]
    shares = tables["shares"].set_index(["rock", "source"])
    assert shares.loc[(1, "authors"), ["tests", "share", "alarms"]].tolist() == [4, 1.0, 0]
    assert len(tables["outcomes"]) == 12 and (tables["engines"]["tests"] == 3).all()


def test_shares_are_those_of_what_the_rows_say():
    """Of 20 tests 10 fell; a block of the grid is wrong in 2, the authors in 5, an engine in 1."""
    test, fell, place = np.arange(20), np.arange(20) % 2, GRID.index(FITTED[1])
    ends = np.where(fell != (test < 2), "f", "-")
    letters = [f"{'-' * place}{end}".ljust(len(GRID), "?") for end in ends]
    base = {"test": test, "pga_g": 0.1 + 0.01 * fell, "pgv_m_s": 0.1 + 0.01 * fell}
    base |= {f"fell_{rock}": fell for rock in MESHES} | {"source": "exact", "peak_ratio": 0.0}
    base |= {f"authors_{rock}": np.where(test < 5, 1 - fell, fell) for rock in MESHES}
    found = base | {"outcome": "found", "margin": np.where(fell, FACTORS[0], np.inf)}
    rows = [pd.DataFrame(found | {"rock": 0, "block": "grid", "grid": letters})]
    for rock in MESHES:
        rows.append(pd.DataFrame(found | {"rock": rock, "block": "margin"}))
        rows.append(pd.DataFrame(base | {"rock": rock, "block": "x", "outcome": "failed"}))
    outcome = np.where(test == 5, "failed", np.where(fell, "overturned", "rocked"))
    new = {"rock": 1, "block": "best fit", "source": "new", "outcome": outcome}
    tables = STUDY.tabulate(pd.concat([*rows, pd.DataFrame(base | new)[:10]]))
    line = tables["engines"].set_index("source").loc["new"]
    wanted = {"tests": 10, "share": 0.9, "gain_exact": 0.1, "gain_rule": -0.1, "p_exact": 1.0,
              "differ": 3, "no_result": 1}  # fmt: skip
    assert line[[*wanted]].tolist() == pytest.approx([*wanted.values()])
    shares = tables["shares"].set_index(["rock", "source"])
    assert shares.loc[1, "share"].tolist() == [0.9, 1.0, 0.75, 0.0, 0.9, 1.0]
    line = shares.loc[(1, "exact")]
    assert line[["p_authors", "p_rule"]].tolist() == pytest.approx([0.25, 0.5])  # 0 to 3, 2 to 0
    assert line[["share_low", "share_high"]].tolist() == pytest.approx([0.699, 0.972], abs=1e-3)
    assert line[["missed", "alarms"]].tolist() == [1, 1]
    assert tables["areas"]["area"].tolist() == 6 * [1.0]


@pytest.mark.parametrize(
    ("name", "text", "part"),
    [
        ("Results_Granite.xlsx", "no zip", "workbook"),
        ("Test014.txt", "a\n" + "0\t" * 8 + "\n0.00125\t1\t", "whole"),
        ("Test014.txt", "a\n" + "0\t" * 8 + "\n" + "0.5\t" * 8, "steps"),
        ("../../" + MESHES[2], "v 1 2 3", "mesh"),
    ],
)
def test_another_folder_is_refused(rocks, capsys, tmp_path, name, text, part):
    (rocks / TABLE / name).write_text(text)
    asked = ["experiments", "--out", tmp_path / "out"]
    refused(capsys, [*asked, "--rocks", rocks], "--rocks", part)
    refused(capsys, [*asked, "--rocks", tmp_path], "--rocks", "Results_Granite.xlsx")
    refused(capsys, asked, "--rocks", "--cubes")
    refused(capsys, [*asked, "--cubes", rocks, "--tests", 3], "--tests", "--rocks")


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


def test_another_folder_of_tosses_is_refused(tosses, tmp_path, capsys):
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
