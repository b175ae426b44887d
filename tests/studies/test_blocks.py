"""A list of blocks under records: its rows, the margin, what is refused, the page."""

import math
import re

import numpy as np
import pandas as pd
import pytest
from closed_forms import overturning_velocity
from commanding import refused
from given import BLOCK, noise
from records import write_record

from analytic import Outcome, Record, RigidBlock, SlidingBlock, simulate
from studies import blocks
from studies.__main__ import run
from studies.blocks.cabinets import read_cabinets
from studies.blocks.fragility import fragility, lognormal
from studies.blocks.margins import WIDTH, strength
from studies.kit.tables import read_table

HEAD = "name,width,height,friction\n"
LIST = HEAD + "A,0.5,1.5,\nB,0.45,1.9,0.2\nC,0.45,1.9,0.24\nnan,0.6,1.7,0.9\n"
"""Of B/H 0.237: B slides flat, C rocks only with more friction than it has."""
SHAKEN = noise(243, 600, 0.01, 2.0)
ASKED = ["blocks", "list.csv", "--record", "X.AT2", "--out", "out"]


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_record(tmp_path / "X.AT2", SHAKEN.scaled(-1.5))
    (tmp_path / "list.csv").write_text(LIST)
    return tmp_path


def read(place):
    return blocks.STUDY.read(place / "out")["blocks"]


def test_each_block_has_its_answers_and_its_margin(place, capsys):
    asked = [*ASKED, "--sources", "exact", "housner", "pymunk:default", "--jobs", "1"]
    assert run(asked) == 0
    rows = read(place)
    assert rows["name"].tolist() == [name for name in ("A", "B", "C", "nan") for _ in range(3)]
    strong = rows.set_index(["name", "source"])
    outcomes = {name: strong.loc[name, "outcome"].tolist() for name in ("B", "C")}
    assert outcomes == {
        "B": ["slid", "slides first", "slid"],
        "C": ["slides first", "slides first", "overturned"],
    }
    why = {name: set(group) for name, group in rows.groupby("name")["no_margin"]}
    assert why == {"A": {""}, "B": {"slides"}, "C": {"slides first"}, "nan": {""}}
    assert (rows["margin"].isna() == (rows["no_margin"] != "")).all()
    box = SlidingBlock(width=0.45, height=1.9, friction=0.2)
    places = np.abs(np.cumsum(simulate(box, Record.read(place / "X.AT2")).slips))
    slid = strong.loc[("B", "exact"), ["slip_m", "residual_m"]].tolist()
    assert slid == pytest.approx([places.max(), places[-1]]) and len(places) > 1
    exact = simulate(BLOCK, Record.read(place / "X.AT2"))
    assert strong.loc[("A", "exact"), "peak_ratio"] == exact.peak_ratio
    assert (strong.loc["A", "friction_needed"] == exact.friction_needed).all()
    page = (place / "out" / "blocks.html").read_text()
    assert page.count("slides first") > 2 and "data:image/png" in page
    before = (place / "out" / "blocks.csv").read_bytes()
    run(asked)  # computes nothing
    assert (place / "out" / "blocks.csv").read_bytes() == before


def test_a_used_folder_refuses_another_list_and_takes_a_longer_one(place, capsys):
    assert run(ASKED) == 0
    before = (place / "out" / "blocks.csv").read_bytes()
    for text, named in (
        (LIST.replace("A,0.5", "A,0.6"), "name A, "),
        (LIST.replace("1.9,0.2", "1.9,"), "name B, "),
        (LIST.replace("C,0.45,1.9,0.24\n", ""), "name C"),
    ):
        (place / "list.csv").write_text(text)
        capsys.readouterr()
        refused(capsys, ASKED, "--out is 'out'", named)
    (place / "list.csv").write_text(LIST + "D,0.7,1.5,\n")
    write_record(place / "X.AT2", SHAKEN)
    refused(capsys, ASKED, "name A, ")
    refused(capsys, [*ASKED, "--scale", "1e307"], "--record X.AT2 times --scale 1e+307: ")
    assert (place / "out" / "blocks.csv").read_bytes() == before
    write_record(place / "X.AT2", SHAKEN.scaled(-1.5))
    assert run(ASKED) == 0
    assert read(place)["name"].tolist() == ["A", "B", "C", "nan", "D"]


def test_records_and_their_vertical_ones(place, capsys):
    """Factors are on both; nobody is asked what lifts off or slides; DWN counts downwards."""
    for seed, name in enumerate(("X.AT2", "Y.AT2", "V.AT2", "W.AT2")):
        text = write_record(place / name, noise(seed, 500, 0.01, 5.0)).read_text()
        (place / name).write_text(text.replace("ABC, N", "ABC, DWN"))
    (place / "list.csv").write_text(HEAD + "A,.5,1.5,\nB,.4,1.9,.2\nC,1,1.2,\nD,1.5,1.4,\n")
    asked = [*ASKED[:4], "Y.AT2", "--vertical", "V.AT2", "W.AT2", "--scale", "1", "1.5", "3"]
    assert run([*asked, "--sources", "mujoco:tuned", "--out", "out"]) == 0
    rows = read(place)
    for row in rows[rows["horizontal_peak_ratio"] > 0.0].itertuples():
        block = RigidBlock(width=row.width_m, height=row.height_m)
        level, upward = (Record.read(place / name) for name in (row.record, row.vertical))
        factors = [edge + side * WIDTH for edge in (row.lifts, row.margin) for side in (-1.0, 1.0)]
        moves = [(level.scaled(it), upward.scaled(-it)) for it in (row.scale, *factors) if it > 0.0]
        peaks = [simulate(block, move, vertical=up).peak_ratio for move, up in moves]
        alone = simulate(block, moves[0][0]).peak_ratio
        assert (row.peak_ratio, row.horizontal_peak_ratio) == (peaks[0], alone)
        assert peaks[1] == 0.0 < peaks[2] < 1.0
        assert row.no_margin or peaks[3] < peaks[4] == math.inf
    by = rows.query("source == 'exact' and record == 'Y.AT2'").groupby("name")["outcome"].agg(list)
    assert [by["B"], by["D"]] == [["slides"] * 3, ["at rest", "rocked", "lifts off"]]
    assert len(rows) == 24 + 15  # three rows of C and D lift off
    both = rows.query("0 < peak_ratio < inf and 0 < horizontal_peak_ratio < inf")
    moved = (both["peak_ratio"] / both["horizontal_peak_ratio"] - 1.0).abs().median()
    table = blocks.STUDY.read(place / "out")["vertical"]
    assert table.iloc[-1, 1:].tolist() == [9, 0, 1, 1 / 9, moved, 0.0, 0.2]


BAD = [
    (HEAD + "A,-1,1.5,\n", "line 2: width is '-1'; it must be from 0.001 to 200 m"),
    (HEAD + "A,500,1500,\n", "line 2: width is '500'; .*; --unit mm takes millimetres"),
    (HEAD + "A,500,900,\n" * 3, "line 2 and 2 more: width is '500'; "),
    (HEAD + "A,0.5,nan,\n", "line 2: height is 'nan'"),
    ("name;width mm;height;note;note\n", "each once"),
    ("name;width mm;height\nA;1.500,0;1\nB;1,500;1\n", "2 and 1 more: .* mark between thousands"),
    ("name;width;height;mu\n", "its column 'mu' must have a name, friction if it is that"),
    ("name;width;height;margin\n", "its column 'margin' must be renamed"),
    (HEAD + "A,0,5,1,5,\n", "line 2: it has more .* decimal commas need semicolons"),
    (HEAD + "A,0.5,1.5,0\n", "line 2: friction is '0'; it must be from 0.001"),
    (HEAD + "B\u202eC,0.5,1.5,\n", r"line 2: name is 'B\u202eC'; it must be 1 to 300 letters"),
    (HEAD + "A,0.5,1.5,\n\nA,0.4,1.5,\n", "line 4: name is 'A'; it must be each block's own"),
    (HEAD + "A,0.5\n", "line 2: it has more cells or fewer than the names"),
    (HEAD + "A,0,1,\nB,1,1,\nC,1,x,\n", "line 2: width is '0'; .*; line 4: height is 'x'"),
    (HEAD, "it has no rows"),
    ("", "it has the columns ''; they must be name, width and height"),
    ("name,width,height,frictoin\nA,1,1,1\n", "its column 'frictoin' must have a name, friction"),
    ('name,width,height\n"A,1,1\n', "unexpected end of data"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "problem"), BAD)
def test_a_bad_list_is_one_line(text, problem, place, capsys):
    (place / "list.csv").write_text(text)
    line = refused(capsys, ASKED, "the list is 'list.csv'; ")
    assert re.search(re.escape(problem).replace(r"\.\*", ".*"), line)
    assert not (place / "out").exists()


@pytest.mark.parametrize(("width", "height"), [(0.5, 1.5), (0.4, 2.0)])
def test_the_margin_is_the_first_factor_of_the_grid_that_overturns(width, height):
    """Solved one by one by `simulate`, another way to the same march."""
    block = RigidBlock(width=width, height=height)

    def falls(factor):
        return simulate(block, SHAKEN.scaled(factor)).outcome is Outcome.OVERTURNED

    found = strength(block, SHAKEN)
    onset = 9.81 * width / height / SHAKEN.peak
    assert found.lifts == pytest.approx(onset, rel=1e-14)
    assert falls(found.margin) and not falls(found.margin * (1.0 - 1.01 * WIDTH))
    factors = onset * 1.01 ** np.arange(1, math.log(found.margin / onset) / math.log(1.01))
    assert not any(map(falls, factors))
    assert found.margin_friction == simulate(block, SHAKEN.scaled(found.margin)).friction_needed


def test_margins_that_are_known():
    """In a jolt of a over the onset a part onset/a of the velocity goes into lifting the block."""
    block, strong = RigidBlock(width=0.5, height=2.0), 40.0
    onset, velocity = 9.81 * block.width / block.height, overturning_velocity(block)
    jolt = Record(dt=velocity / (strong * onset), samples=[strong * onset] * 2)
    assert 1.0 < strength(block, jolt).margin < 1.0 + 2.0 / strong
    buzz = Record(dt=1e-3, samples=[1.0, -1.0] * 20)
    assert strength(RigidBlock(width=50.0, height=60.0), buzz).margin == math.inf


def test_a_scale_that_overturns_in_a_sliver_counts_and_a_failed_search_has_no_margin():
    case = {"name": "A", "record": "X", "outcome": "rocked", "source": "exact", "peak_ratio": 0.5}
    case |= {"friction_needed": 0.3}
    found = {"lifts": 0.5, "margin": 1.2, "margin_friction": 0.4}
    rows = [{**case, "scale": 0.9, "outcome": "overturned"}, {**case, "scale": 1.0},
            {**case, "scale": 0.0, "outcome": "found", **found}]  # fmt: skip
    table = blocks.tabulate(pd.DataFrame(rows))["blocks"]
    assert table["margin"].tolist() == [0.9, 0.9]
    both = {"blocks": table, "fragility": fragility(blocks.ranked(table))}
    assert "1 of 1 blocks overturn" in blocks.finding(both)
    assert "nan" not in blocks.finding(both) and [*blocks.figures(both)] == ["blocks"]
    rows[-1] |= {"outcome": "failed", **dict.fromkeys(found, math.nan)}
    table = blocks.tabulate(pd.DataFrame(rows))["blocks"]
    assert table["no_margin"].tolist() == ["failed"] * 2 and table["margin"].isna().all()
    weak = [{**row, "friction": 0.2, "outcome": "rocked"} for row in rows]
    weak[0]["friction_needed"], weak[2] = 0.1, weak[2] | found | {"margin_friction": 0.1}
    table = blocks.tabulate(pd.DataFrame(weak))["blocks"]
    assert table["no_margin"].tolist() == ["slides first"] * 2
    assert table["outcome"].tolist() == ["rocked", "slides first"]


SPREADSHEETS = [
    "name;width;height\nA;0,5;1,5\n",
    '\ufeffName,WIDTH,Height\r\nA,"0,5",1.5\r\n',
    "sep=;\nname;width_mm;height (cm);friction;;\nA;500;150;;;\n;;;;;\n",
    "Rooms 3 and 4\n# as measured\n\nname\twidth\theight\troom;no\nA\t0.5\t1.5\t007\n",
]


@pytest.mark.parametrize("text", SPREADSHEETS)
def test_a_list_is_read_as_spreadsheets_write_it(text, tmp_path):
    (tmp_path / "list.csv").write_bytes(text.encode())
    (found,) = read_cabinets(tmp_path / "list.csv")
    assert (found.name, found.width_m, found.height_m, found.friction) == ("A", 0.5, 1.5, None)
    assert [*found.further.values()] == ["007"] * ("room" in text)


def test_several_records_of_all_kinds_make_a_fragility(place, capsys):
    other, third = noise(7, 600, 0.01, 3.0), noise(8, 600, 0.01, 4.0)
    rows = [f"{0.01 * at:.2f},{a!r}\n" for at, a in enumerate(other.samples.tolist())]
    (place / "o.csv").write_text("time_s,acceleration_m_s2\n" + "".join(rows))
    (place / "t.txt").write_text("\n".join(map(repr, (third.samples / 9.81).tolist())))
    (place / "list.csv").write_text("name;width;height;Room\nA;500;1500;007\nB;400;2000;x\n")
    asked = [*ASKED[:4], "o.csv", "t.txt", "--pga", "0.5", "--unit", "mm", "--units", "g"]
    assert run([*asked, "--record-dt", "0.01", "--out", "out"]) == 0
    found, fits = read(place), blocks.STUDY.read(place / "out")["fragility"]
    assert set(found["Room"]) == {"007", "x"} and found["pga_g"].tolist() == [0.5] * 6
    margins = [strength(BLOCK, each.scaled_to(4.905)).margin for each in (SHAKEN, other, third)]
    assert found.loc[found["name"] == "A", "margin"].tolist() == pytest.approx(margins, rel=1e-5)
    fit = (fits := fits.set_index(["name", "measure"])).loc[("A", "factor")]
    assert fit["records"] == 3 and fit["median"] == pytest.approx(np.median(margins), rel=1e-5)
    assert fit["theta"] == pytest.approx(np.exp(np.mean(np.log(margins))), rel=1e-5)
    assert fit["theta_low"] <= fit["theta"] <= fit["theta_high"]
    assert fits.loc[("A", "pga_g"), "theta"] == pytest.approx(0.5 * fit["theta"])
    assert fits.loc[("any of the list", "factor"), "least"] == found["margin"].min()
    assert (place / "out" / "blocks.html").read_text().count("<svg") == 3


def test_a_lognormal_of_what_is_known_to_be_larger():
    """Of 4000 normal numbers cut above the 60th of a hundred; uncut, mean and spread."""
    drawn = np.random.default_rng(3).normal(0.7, 0.4, 4000)
    cut = np.quantile(drawn, 0.6)
    assert lognormal(drawn, drawn > 9.0) == pytest.approx((drawn.mean(), drawn.std()))
    assert lognormal(np.minimum(drawn, cut), drawn > cut) == pytest.approx((0.7, 0.4), abs=0.02)


NAMES = ["nan", "007", "$x_1$", "<b>&", "Schrank Ä 3", "a" * 300, "サーバー", "🗄️ B", "=1+1"]


@pytest.mark.filterwarnings("error")
def test_names_are_what_they_are(place, capsys):
    lines = [f"{name};0.5;{1.2 + 0.1 * n}" for n, name in enumerate(NAMES)]
    (place / "list.csv").write_text("\n".join(["name;width;height", *lines]))
    assert run(ASKED) == 0 and capsys.readouterr().err == ""
    assert read(place)["name"].tolist() == NAMES
    assert read_table(place / "out" / "blocks.csv")["friction"].isna().all()
    assert "<b>" not in (place / "out" / "blocks.html").read_text()
