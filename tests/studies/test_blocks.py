"""A list of blocks under records: the rows of `compare`, the margin, what is refused, the page."""

import csv
import html
import math
import re
import shlex
import time
import warnings

import numpy as np
import pandas as pd
import pytest
from commanding import compared, refused
from given import noise
from records import write_record

from analytic import Outcome, Record, RigidBlock, SlidingBlock, simulate
from analytic.criteria import overturning_velocity
from studies.__main__ import run
from studies.blocks.cabinets import read_cabinets
from studies.blocks.figure import pictures
from studies.blocks.report import doubts, first_words, ranked, read
from studies.blocks.strength import BEYOND, WIDTH, grid, strength
from studies.blocks.study import joined, plan

REST = (0.0, 0.0)
HEAD = "name,width,height,friction,tilt\n"
LIST = HEAD + "A,0.5,1.5,,\nB,0.45,1.9,0.2,\nC,0.6,1.7,,0.3\n"
SLIDING = HEAD + "A,0.5,1.5,,\nB,0.45,1.9,0.2,\nC,0.45,1.9,0.24,\nD,0.45,1.9,0.7,\n"
"""Of B/H 0.237: B slides flat, C rocks only with more friction than it has, D rocks."""
SHAKEN = noise(243, 600, 0.01, 2.0)


@pytest.fixture
def place(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    write_record(tmp_path / "X.AT2", SHAKEN)
    write_record(tmp_path / "Y.AT2", SHAKEN.scaled(-1.5))
    (tmp_path / "list.csv").write_text(LIST)
    return tmp_path


def test_rows_are_those_of_compare_to_the_last_digit(place, capsys):
    (place / "list.csv").write_text(LIST.replace("0.2,", "0.9,"))
    sources = ["exact", "housner", "pymunk:naive"]
    asked = ["--record", "Y.AT2", "--scale", "0.8", "2", "--baseline", "linear"]
    code = run(["blocks", "list.csv", *asked, "--out", "out", "--sources", *sources])
    failed = 0
    with (place / "out" / "blocks.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == 3 * 2 * len(sources)
    for case in range(0, len(rows), len(sources)):
        first = rows[case]
        options = ["--width", first["width_m"], "--height", first["height_m"]]
        options += ["--record", first["record"], "--scale", first["scale"], "--baseline", "linear"]
        for name in ("friction", "tilt"):
            options += [] if first[name] == "nan" else [f"--{name}", first[name]]
        ended, expected = compared(capsys, *options, "--sources", *sources)
        failed |= ended
        for row in rows[case : case + len(sources)]:
            same = expected[row["source"]]
            assert (row["outcome"], row["message"]) == (same["outcome"], same["message"])
            for name in ("impacts", "steps"):
                assert int(row[name]) == same[name]
            for name in ("peak_ratio", "kappa", "sensitivity", "min_normal", "friction_needed"):
                value = float(row[name])
                assert (value if math.isfinite(value) else None) == same[name], name
    assert code == failed
    assert {row["outcome"] for row in rows} >= {"rocked", "overturned"}
    assert {row["no_margin"] for row in rows} == {""}


def test_what_slides_has_slips_and_no_margin(place, capsys):
    """Below B/H the sliding block answers; from there on nothing does where rocking needs more."""
    (place / "list.csv").write_text(SLIDING)
    sources = ["exact", "housner", "pymunk:naive"]
    asked = ["--record", "Y.AT2", "--scale", "0.3", "1", "--sources", *sources]
    assert run(["blocks", "list.csv", *asked, "--out", "out"]) == 0
    text = " ".join(capsys.readouterr().out.split())
    rows = read(place / "out")
    found = rows.set_index(["name", "scale", "source"])
    strong = found.xs(1.0, level="scale")
    outcomes = {
        "B": ["slid", "slides first", "slid"],
        "C": ["slides first", "slides first", "rocked"],
        "D": ["rocked", "rocked", "overturned"],
    }
    assert {name: strong.loc[name, "outcome"].tolist() for name in outcomes} == outcomes
    assert strong.loc["C", "peak_ratio"].isna().tolist() == [True, True, False]
    block = SlidingBlock(width=0.45, height=1.9, friction=0.2)
    slips = simulate(block, Record.read(place / "Y.AT2")).slips
    exact = strong.loc["B", "exact"]
    assert exact["slips"] == len(slips)
    assert exact["slid_m"] == pytest.approx(np.abs(np.cumsum(slips)).max(), rel=1e-12)
    assert (found.xs(0.3, level="scale")["outcome"] != "slides first").all()
    why = {name: set(group) for name, group in rows.groupby("name")["no_margin"]}
    assert why == {"A": {""}, "B": {"slides"}, "C": {"slides first"}, "D": {""}}
    assert (rows["margin"].isna() == (rows["no_margin"] != "")).all()
    assert (rows["friction_needed"] <= rows["margin_friction"]).any()
    lines = ranked(rows)
    assert set(lines["name"][:2]) == {"A", "D"}
    assert "2 of 4 slide" in first_words(lines) and text.count("slide first") == 1
    drawn = [words.get_text().strip() for words in pictures(place / "out")["blocks"].axes[0].texts]
    assert drawn == ["slides", "slides first"]
    page = (place / "out" / "blocks.html").read_text()
    assert "<strong>slides</strong>" in page and "<strong>slides first</strong>" in page
    assert "needs 0." not in page


def test_a_list_of_which_all_slide_has_no_margin_at_all(place, capsys):
    (place / "list.csv").write_text("name,width,height,friction\nB,0.45,1.9,0.2\n")
    assert run(["blocks", "list.csv", "--record", "Y.AT2", "--out", "out"]) == 0
    assert "all" not in capsys.readouterr().out.split(";")[0]
    rows = read(place / "out")
    assert rows["outcome"].tolist() == ["slid"] and rows["margin"].isna().all()


def test_a_search_that_takes_too_long_is_a_failed_row(place, capsys):
    asked = ["--record", "X.AT2", "--out", "out", "--time-limit", "1e-4"]
    assert run(["blocks", "list.csv", *asked]) == 1
    assert capsys.readouterr().err.count("time limit") == 2
    rows = read(place / "out").set_index("name")
    assert rows["no_margin"].tolist() == ["failed", "slides", "failed"]
    assert rows["margin"].isna().all() and (rows["outcome"] != "failed").all()


def test_a_search_tells_how_many_factors_it_has_tried():
    block, told = RigidBlock(width=0.5, height=1.5), []
    margin = strength(block, SHAKEN, REST, tell=told.append).margin
    onset = 9.81 / 3.0 / SHAKEN.peak
    least = math.log(BEYOND * margin / onset) / math.log1p(0.01)
    assert len(told) > 2 and least <= sum(told) <= least + 4 * 4 * 64


def test_jobs_share_the_scaled_records(place):
    blocks = read_cabinets(place / "list.csv")
    asked = ({"X": SHAKEN}, [0.5, 1.0, 2.0], ["exact", "housner"], {"baseline": ""}, 60.0)
    jobs = plan(blocks, *asked).jobs
    assert len(jobs) == 3 * 3 * 2 + 2
    assert len({id(job.motion) for job in jobs}) == 4


def test_many_rows_are_read_in_no_time(tmp_path):
    """As many as are read in about a second; a search of all rows for each takes a minute."""
    path = tmp_path / "many.csv"
    path.write_text("name,width,height\n" + "".join(f"N{n},0.5,1.5\n" for n in range(50_000)))
    began = time.process_time()
    assert len(read_cabinets(path)) == 50_000
    assert time.process_time() - began < 10.0


@pytest.mark.parametrize("scale", ["1e308", "1e307"])
def test_a_scale_that_overflows_is_one_line(scale, place, capsys):
    refused(capsys, [*ASKED, "--scale", scale], "--scale is 1e+30", "X.AT2")


ASKED = ["blocks", "list.csv", "--record", "X.AT2", "--out", "out"]


@pytest.mark.parametrize(
    ("file", "change", "named"),
    [
        ("list.csv", LIST.replace("A,0.5", "A,0.6"), "name A: width_m 0.5 there, 0.6 here"),
        ("list.csv", LIST.replace("1.9,0.2", "1.9,"), "name B: friction 0.2 there, None here"),
        ("list.csv", LIST.replace("0.3", "0.2"), "name C: tilt 0.3 there, 0.2 here"),
        ("X.AT2", SHAKEN.scaled(-1.5), "record X.AT2: record_digest"),
    ],
)
def test_a_used_folder_refuses_another_thing_of_the_same_name(file, change, named, place, capsys):
    assert run(ASKED) == 0
    before = {path: path.read_bytes() for path in (place / "out").glob("*.csv")}
    if isinstance(change, str):
        (place / file).write_text(change)
    else:
        write_record(place / file, change)
    capsys.readouterr()
    refused(capsys, ASKED, "--out is 'out'", named)
    assert {path: path.read_bytes() for path in (place / "out").glob("*.csv")} == before
    # what is new beside it is welcome
    (place / "list.csv").write_text(LIST + "D,0.7,1.5,,\n")
    write_record(place / "X.AT2", SHAKEN)
    assert run(ASKED) == 0
    assert read(place / "out")["name"].tolist() == ["A", "B", "C", "D"]


@pytest.mark.parametrize(("width", "height"), [(0.5, 1.5), (0.4, 2.0), (1.0, 2.5)])
def test_the_margin_is_the_first_factor_of_the_grid_that_overturns(width, height):
    """Solved one by one by `simulate`, another way to the same march."""
    block = RigidBlock(width=width, height=height)

    def falls(factor):
        return simulate(block, SHAKEN.scaled(factor)).outcome is Outcome.OVERTURNED

    found = strength(block, SHAKEN, REST)
    onset = 9.81 * width / height / SHAKEN.peak
    assert found.lifts == pytest.approx(onset, rel=1e-14)
    assert simulate(block, SHAKEN.scaled(0.999 * onset)).outcome is Outcome.AT_REST
    assert falls(found.margin) and not falls(found.margin * (1.0 - 1.01 * WIDTH))
    factors = onset * 1.01 ** np.arange(1, 1 + math.log(BEYOND * found.margin / onset) / 0.0099)
    answers = [(factor, falls(factor)) for factor in factors]
    assert not any(fell for factor, fell in answers if factor < found.margin)
    again = [f for f, fell in answers if not fell and found.margin < f <= BEYOND * found.margin]
    inside = [any(low * 0.9999 <= f <= high * 1.0001 for low, high in found.islands) for f in again]
    assert all(inside)
    for low, high in found.islands:
        assert not falls(low) and not falls(high)


def test_the_margin_of_a_jolt_is_that_of_a_sudden_velocity():
    """In a jolt of a over the onset a part onset/a of the velocity goes into lifting the block."""
    block = RigidBlock(width=0.5, height=2.0)
    onset, velocity = 9.81 * block.width / block.height, overturning_velocity(block)
    strong = 40.0
    jolt = Record(dt=velocity / (strong * onset), samples=[strong * onset] * 2)
    margin = strength(block, jolt, REST).margin
    assert 1.0 < margin < 1.0 + 2.0 / strong


def test_a_block_that_leans_has_a_margin_from_zero():
    block = RigidBlock(width=0.5, height=1.5)
    leaning = strength(block, SHAKEN, (0.9 * block.alpha, 0.0))
    assert leaning.lifts == 0.0
    assert 0.0 < leaning.margin < strength(block, SHAKEN, REST).margin
    fallen = strength(block, SHAKEN, (1.2 * block.alpha, 0.0))
    assert fallen.margin == 0.0
    steps = np.diff(grid(2.0, at_rest=False))
    assert steps.min() > 0.0 and steps.max() < 2.0 * 0.011 * 100.0


def test_what_no_factor_overturns_has_no_margin_and_what_does_not_move_is_refused():
    block = RigidBlock(width=50.0, height=60.0)
    buzz = Record(dt=1e-3, samples=[1.0, -1.0] * 20)
    assert strength(block, buzz, REST).margin == math.inf
    with pytest.raises(ValueError, match="zero throughout"):
        strength(block, Record(dt=0.1, samples=[0.0, 0.0]), REST)


def test_a_scale_that_overturns_in_a_sliver_counts_for_the_margin():
    case = {"name": "A", "record": "X", "outcome": "rocked"}
    facts = dict.fromkeys(("kappa", "sensitivity", "min_normal", "friction_needed"), 1.0)
    exact = {**case, "table": "answers", "source": "exact", **facts}
    found = {"lifts": 0.5, "margin": 1.2, "margin_friction": 0.4, "islands": ""}
    rows = [
        {**exact, "scale": 0.9, "outcome": "overturned"},
        {**exact, "scale": 1.0},
        {**case, "table": "answers", "source": "rk4", "scale": 0.9},
        {**case, "table": "margins", "source": "exact", "scale": 0.0, **found},
    ]
    rows = [{"friction": math.nan, **row} for row in rows]
    assert joined(rows)["margin"].tolist() == [0.9, 0.9, 0.9]


BAD = [
    (HEAD + "A,-1,1.5,,\n", "line 2: width is '-1'; it must be from 0.001 to 200 m"),
    (HEAD + "A,500,1500,,\n", "line 2: width is '500'; .* (0.5 for 500 mm?)"),
    (HEAD + "A,0.5,nan,,\n", "line 2: height is 'nan'"),
    (HEAD + 'A,"0,5",1.5,,\n', "line 2: width is '0,5'"),
    (HEAD + "A,0.5,1_5,,\n", "line 2: height is '1_5'"),
    (HEAD + "A,0.5,1.5,-0.1,\n", "line 2: friction is '-0.1'; it must be a finite number of at"),
    (HEAD + "A,0.5,1.5,0,\n", "line 2: friction is '0'; it must be a finite number of at least"),
    (HEAD + f"{'x' * 5000},0.5,1.5,,\n", "line 2: name is 'x.*x'; it must be at most 300 letters"),
    (HEAD + 'A,1,2,,\n"B\nC",0.5,1.5,,\n', r"line 4: name is 'B\nC'; it must be at most"),
    (HEAD + '"B\tC",0.5,1.5,,\n', r"line 2: name is 'B\tC'; it must be at most"),
    (HEAD + "B\u202eC,0.5,1.5,,\n", r"line 2: name is 'B\u202eC'; it must be at most"),
    (HEAD + "B\u2066C,0.5,1.5,,\n", r"line 2: name is 'B\u2066C'; it must be at most"),
    (HEAD + "A,0.5,1.5,,5\n", "line 2: tilt is '5'; it must be a finite number between -4.88203"),
    (HEAD + ",0.5,1.5,,\n", "line 2: name is ''; it must be a word"),
    (HEAD + "A,0.5,1.5,,\n\nA,0.4,1.5,,\n", "line 4: name is 'A'; it must be each block's own"),
    (HEAD + "A,0.5\n", "line 2: the number of values is '2'; it must be 5, one a column"),
    (HEAD, "it has no rows"),
    ("", "it has no column name and width and height"),
    ("name,width\nA,1\n", "it has no column height"),
    ("name,width,height,frictoin\nA,1,1,1\n", "it has a column 'frictoin'; its columns must be"),
    ("name,width,height,width\nA,1,1,1\n", "it has the column width twice"),
    ('name,width,height\n"A,1,1\n', "unexpected end of data"),
]  # fmt: skip


@pytest.mark.parametrize(("text", "problem"), BAD)
def test_a_bad_list_is_one_line(text, problem, place, capsys):
    (place / "list.csv").write_text(text)
    line = refused(capsys, ASKED, "the list is 'list.csv'; ")
    assert re.search(re.escape(problem).replace(r"\.\*", ".*"), line)
    assert not (place / "out").exists()


def test_all_bad_rows_are_named_at_once(place, capsys):
    bad = {2: "0", 3: "x", 5: "-3", 7: "1e9"}
    rows = [f"N{at},{bad.get(at, '0.5')},1.5" for at in range(2, 9)]
    (place / "list.csv").write_text("\n".join(["name,width,height", *rows]))
    line = refused(capsys, ASKED)
    assert re.findall(r"line (\d): width is '([^']+)'", line) == [
        (str(at), value) for at, value in bad.items()
    ]


FORMULAS = ["=cmd|' /C calc'!A0", "+1+1", "@SUM(A1)", "-2+3", "'=x"]
"""What a spreadsheet would take for one, or for what was one."""
NAMES = ["nan", "007", "$x_1$", "<b>&", "Schrank Ä 3", "a" * 300, "サーバー", "🗄️ B", *FORMULAS]


def test_names_are_what_they_are(place, capsys):
    lines = [f"{name};0.5;{1.2 + 0.1 * n}" for n, name in enumerate(NAMES)]
    (place / "list.csv").write_text("\n".join(["name;width;height", *lines]))
    with warnings.catch_warnings():
        warnings.simplefilter("error")  # of letters that no font has, too
        assert run(["blocks", "list.csv", "--record", "X.AT2", "--out", "out"]) == 0
    output = capsys.readouterr()
    assert output.err == "" and output.out.count("apostrophe") == 1
    with (place / "out" / "blocks.csv").open(newline="") as file:
        written = [row["name"] for row in csv.DictReader(file)]
    assert written == [f"'{name}" if name in FORMULAS else name for name in NAMES]
    assert read(place / "out")["name"].tolist() == NAMES
    page = (place / "out" / "blocks.html").read_text()
    assert "<b>" not in page and html.escape("<b>&") in page
    before = (place / "out" / "blocks.png").read_bytes()
    (place / "out" / "blocks.png").unlink()
    assert run(["blocks", "list.csv", "--record", "X.AT2", "--out", "out"]) == 0
    assert (place / "out" / "blocks.png").read_bytes() == before


def test_the_page_has_the_command_of_each_line_which_works_anywhere(place, capsys, monkeypatch):
    asked = ["--record", "Y.AT2", "--scale", "0.5", "1.5", "--sources", "exact", "pymunk:naive"]
    run(["blocks", "list.csv", *asked, "--out", "out"])
    page = (place / "out" / "blocks.html").read_text()
    (place / "elsewhere").mkdir()
    monkeypatch.chdir(place / "elsewhere")
    commands = [html.unescape(words) for words in re.findall('data-copy="([^"]*)"', page)]
    rows = read(place / "out").set_index(["width_m", "source", "scale"])["peak_ratio"]
    assert len(commands) == 3
    for command in commands:
        words = shlex.split(command)[2:]
        _, found = compared(capsys, *words)
        assert found.keys() == {"exact", "pymunk:naive"}
        width = float(words[words.index("--width") + 1])
        for source, row in found.items():
            kept = rows[width, source, 0.5]
            assert row["peak_ratio"] == (kept if math.isfinite(kept) else None)


def test_the_least_margin_comes_first_in_words_page_and_table(place, capsys):
    assert run(["blocks", "list.csv", "--record", "X.AT2", "Y.AT2", "--out", "out"]) == 0
    rows = read(place / "out").sort_values("margin")
    first, fallen = rows.iloc[0], rows.loc[rows["margin"] <= 1.0, "name"].nunique()
    words = f"the first is {first['name']}, at {first['margin']:.4g} times {first['record']}"
    fallen = fallen or "None"
    lines = capsys.readouterr().out.splitlines()
    said = " ".join(lines)
    assert words in said and f"{fallen} of 3 blocks overturn" in said
    heads = next(at for at, line in enumerate(lines) if line.startswith("name "))
    assert lines[heads + 1].split()[0] == first["name"]
    page = (place / "out" / "blocks.html").read_text()
    assert words in page and "href=" not in page


def test_a_friction_that_was_not_given_is_none_that_suffices():
    case = {"name": "A", "record": "r", "scale": 1.0, "margin": 2.0, "min_normal": 0.5}
    case["outcome"] = "rocked"
    rows = pd.DataFrame([{**case, "friction": math.nan, "friction_needed": 0.4}])
    (said,) = doubts(rows)
    assert said.startswith("1 of 1 have no friction given") and said.endswith("up to 0.4")
    assert doubts(rows.assign(friction=0.5))[0].startswith("none slides")
    first = rows.assign(friction=0.3, outcome="slides first")
    assert doubts(first)[0].startswith("1 of 1 slide first,")
