"""README.md, its pages and the published tables: what they say, and commands that they print."""

import csv
import gzip
import re
import shlex
import shutil
import tomllib

import pandas as pd
import pytest
from commanding import PAGES, PROSE, PUBLISHED_PAGES, ROOT

from engines.factors import BEST, LEFT_OUT
from studies.__main__ import COMMANDS, GROUPS, run
from studies.kit.app import make_app
from studies.measures.published import columns
from studies.page import facts, readme
from studies.page.chapters import PARTS

PUBLISHED = ROOT / readme.PUBLISHED


@pytest.fixture(scope="module")
def pages():
    return readme.pages(ROOT)


@pytest.mark.parametrize("name", (*PAGES, "studies/published/columns.csv"))
def test_a_page_says_what_the_published_tables_say(name, pages):
    assert pages[ROOT / name] == (ROOT / name).read_text("utf-8"), "run `rocking readme`"


def test_the_pages_follow_their_tables(pages, tmp_path):
    copy = tmp_path / readme.PUBLISHED
    shutil.copytree(PUBLISHED, copy)
    for path in (copy / "sweep" / "summary.csv", copy / "presets" / "summary.csv"):
        lines = pd.read_csv(path)
        mine = (lines["source"] == "mujoco") & (lines["figure"] == "all")
        wrong = ["agree", "fall_wrong", "rest_wrong", "no_answer"]
        lines.loc[mine, [*wrong, "max_error"]] = [957, 1, 2, 0, 0.0321]
        lines.to_csv(path, index=False)
    after = readme.pages(tmp_path)
    for name, words in (
        ("README.md", "<td>3.2&#8239;%</td>"),
        ("studies/published/engines.md", "957 of 960 | 1 | 2 | 0 |"),
        ("studies/published/README.md", "at least 957 "),
    ):
        assert words in after[tmp_path / name] and words not in pages[ROOT / name]


def made_up(preset, factor="", level="", error=1e-5, **broken):
    counts = {"cases": 12, "failed": 0, "wrong": 0, **broken}
    words = {"engine": "rapier", "preset": preset, "factor": factor, "level": level}
    return {**words, **counts, "median_error": error / 2, "max_error": error}


def test_what_helps_has_a_price(tmp_path):
    lines = pd.DataFrame(
        [
            made_up("landing"),
            made_up("landing", LEFT_OUT, "reflection", 2e-2, wrong=1),
            made_up(BEST, error=3e-2),
        ]
    )
    (tmp_path / "contact").mkdir()
    lines.assign(trap="").to_csv(tmp_path / "contact" / "variants.csv", index=False, na_rep="nan")
    heads, rows = facts.helps(tmp_path)
    mine = {row[0]: row[heads.index("Rapier")] for row in rows}
    assert mine["**All of it**"] == "**0.001 %**"
    assert {"2 %, 1 of 12 wrong", "3 %"} <= set(mine.values())


def test_the_first_run_and_a_later_one_are_timed_apart():
    runs = [(False, 9, 9, 21.4), (False, 9, 2, 3.0), (True, 9, 9, 80.9)]
    names = ("first", "rows", "computed", "duration_s")
    runs = [dict(zip(names, run, strict=True)) for run in runs]
    later, first = {"runs": runs[:2]}, {"runs": runs[2:]}
    for records, seconds in (((later, first), [81, 21]), ((later,), [21]), ((first,), [81])):
        for ordered in (records, records[::-1]):
            assert [int(it) for it in re.findall(r"\d+", facts.lasts(*ordered))] == seconds


def test_every_link_of_a_page_leads_somewhere():
    assert {PUBLISHED / name for name in PUBLISHED_PAGES} == set(PUBLISHED.glob("*.md"))
    for path in (ROOT / name for name in (*PROSE, "analytic/EQUATIONS.md")):
        text = path.read_text(encoding="utf-8")
        targets = re.findall(r"\]\(([^)#]+)(?:#[^)]*)?\)", text)
        targets += re.findall(r'src="([^"]+)"', text)
        inside = [target for target in targets if not target.startswith("http")]
        assert inside
        assert [name for name in inside if not (path.parent / name).exists()] == []
        for name, place in re.findall(r"\]\(([^)#]*)#([\w-]+)\)", text):
            assert place in anchors(path.parent / name if name else path), (path, name, place)


def anchors(path):
    text = path.read_text(encoding="utf-8")
    heads = re.findall("^#+ (.*)$", text, re.MULTILINE)
    slugs = (re.sub(r"[^\w -]", "", head.lower()).replace(" ", "-") for head in heads)
    return {*re.findall(r'<a id="([^"]+)"', text), *slugs}


def test_the_first_picture_is_of_the_case_that_it_names():
    lines = readme.summary(pd.read_csv(PUBLISHED / "hero" / "hero.csv")).set_index("source")
    assert lines.loc["exact", "peak_ratio"] == pytest.approx(0.3852, abs=5e-5)
    assert lines.loc["housner", "outcome"] == "overturned"
    assert set(lines.index) == set(readme.SOURCES)


def commands(name):
    blocks = re.findall(
        r"```(?:sh|yaml)\n(.*?)```", (ROOT / name).read_text(encoding="utf-8"), re.S
    )
    return [
        line for block in blocks for line in re.findall("^ *(?:- run: )?(rocking .*)", block, re.M)
    ]


def taken(arguments):
    app = make_app(GROUPS, arguments[0])
    _, bound, ignored = app.parse_args(arguments, exit_on_error=False)
    assert bound.arguments and not ignored


@pytest.mark.parametrize("part", PARTS, ids=lambda part: part.folder)
@pytest.mark.parametrize("full", [True, False])
def test_the_command_of_a_part_is_taken(part, full):
    taken(part.words("DIR", full))


QUICK = ("advise", "export", "blocks", "compare")


@pytest.mark.parametrize("command", commands("README.md"))
def test_a_command_of_the_readme_works_as_printed(command, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    _, *arguments = shlex.split(command)
    if arguments[0] in QUICK:
        assert run(arguments) == 0
        assert capsys.readouterr().out
    else:
        taken(arguments)


@pytest.mark.parametrize("name", PROSE)
def test_a_command_within_a_page_is_taken(name):
    text = (ROOT / name).read_text(encoding="utf-8")
    inside = [" ".join(found.split()) for found in re.findall("`(rocking [^`]*)`", text)]
    for command in (*inside, *(commands(name) if name != "README.md" else ())):
        _, *arguments = shlex.split(command, comments=True)
        assert arguments[0] in {*COMMANDS, "COMMAND", "--help"}
        if len(arguments) > 1 and arguments[0] != "COMMAND":
            taken(arguments)
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    for named in re.findall(r"pip install [^`\n]*'\.\[([\w,]+)\]'", text):
        assert set(named.split(",")) <= set(project["optional-dependencies"])


DICTIONARY = pd.read_csv(PUBLISHED / "columns.csv", keep_default_na=False)
TABLES = sorted(PUBLISHED.glob("*/*.csv*"))


def as_written(path):
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt", newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    return head, rows


def is_of(kind, cell):
    if kind == "text" or cell == "nan":
        return True
    if kind == "boolean":
        return cell in ("True", "False")
    return not float(cell) % 1 if kind == "integer" else float(cell) == float(cell)


@pytest.mark.parametrize("path", TABLES, ids=lambda path: path.relative_to(PUBLISHED).as_posix())
def test_the_dictionary_holds_every_column_in_order_and_its_type(path):
    head, rows = as_written(path)
    told = DICTIONARY[DICTIONARY["table"] == path.relative_to(PUBLISHED).as_posix()]
    assert list(told["column"]) == head
    for name, kind, cells in zip(head, told["type"], zip(*rows, strict=True), strict=True):
        distinct = set(cells)
        assert {cell for cell in distinct if not is_of(kind, cell)} == set(), name
        if kind == "text" and name != "measured":  # its digits count, and there may be none
            known = {"", "nan"}
            numbers = {cell for cell in distinct - known if re.fullmatch(r"-?\d*\.\d+", cell)}
            assert not numbers or distinct - known - numbers, name


def test_the_dictionary_holds_nothing_else():
    assert set(DICTIONARY["table"]) == {path.relative_to(PUBLISHED).as_posix() for path in TABLES}
    assert set(DICTIONARY["type"]) == {"text", "boolean", "integer", "number"}
    measured = DICTIONARY["type"] == "number"
    assert ((DICTIONARY["unit"] != "") == measured).all()
    assert (DICTIONARY["meaning"] != "").all()


def test_what_a_column_means_in_one_table_is_a_column_of_it_and_means_another_thing():
    stems = {path.relative_to(PUBLISHED).as_posix().partition(".")[0]: path for path in TABLES}
    lines = pd.read_csv(ROOT / "studies" / "measures" / "columns.csv", keep_default_na=False)
    assert not lines.duplicated(["table", "column"]).any()
    for (table, name), told in columns().items():
        assert not table or name in as_written(stems[table])[0], table
        assert not table or told != columns().get(("", name))
