"""Tables that are no longer what a study wrote: every command that reads them says so."""

import gzip
import json
import os
import shutil
import tomllib
from pathlib import Path

import pytest
from commanding import CASE, refused

from studies.__main__ import run
from studies.advise.evidence import RANDOM, TABLES
from studies.old.journal import seal as sealed_line
from studies.old.journal import unseal
from studies.old.provenance import check, digest, seal
from studies.measures import halving
from studies.measures.published import PUBLISHED
from studies.page import readme
from studies.score import report as score
from studies.symptoms.lines import TABLES as SYMPTOMS


def sweep(folder, figure="6"):
    few = ["--figure", figure, "--sources", "exact", "housner"]
    assert run(["sweep", *few, "--out", str(folder)]) == 0
    return folder


@pytest.fixture(scope="module")
def swept(tmp_path_factory):
    return sweep(tmp_path_factory.mktemp("swept") / "six")


@pytest.fixture(scope="module")
def another(tmp_path_factory):
    return sweep(tmp_path_factory.mktemp("another") / "seven", "7")


@pytest.fixture
def folder(swept, tmp_path, capsys):
    capsys.readouterr()
    return Path(shutil.copytree(swept, tmp_path / "results"))


@pytest.fixture
def published(tmp_path):
    """The published tables, sealed as their studies do it now."""
    root = tmp_path / "root"
    copy = Path(shutil.copytree(PUBLISHED, root / readme.PUBLISHED))
    for record in copy.glob("*/provenance.json"):
        seal(record.parent)
    return copy


def edit(path):
    """Change the last digit of a table."""
    text = path.read_text()
    place = max(place for place in range(len(text)) if text[place].isdigit())
    path.write_text(text[:place] + str(9 - int(text[place])) + text[place + 1 :])


def rewritten(change, name="sweep.csv"):
    """Return what changes the content of a file in a folder."""
    return lambda folder: (folder / name).write_bytes(change((folder / name).read_bytes()))


def replaced(make, name):
    """Return what puts something else in the place of a file in a folder."""
    return lambda folder: ((folder / name).unlink(), make(folder / name))


def packed_and_cut(folder):
    content = (folder / "sweep.csv").read_bytes()
    (folder / "sweep.csv.gz").write_bytes(gzip.compress(content)[:-100])


PROVENANCE = {
    "an empty provenance": b"",
    "a provenance without digests": b'{"study": "sweep"}',
    "a list of digests": b'{"study": "sweep", "tables": [1]}',
    "a number for digests": b'{"study": "sweep", "tables": 3}',
    "a provenance too deep": b"[" * 200_000,
}
HARM = {
    "one digit": lambda folder: edit(folder / "sweep.csv"),
    "cut at a line": rewritten(lambda text: b"".join(text.splitlines(keepends=True)[:-50])),
    "cut anywhere": rewritten(lambda text: text[:-777]),
    "saved by a spreadsheet": rewritten(lambda text: text.replace(b"\n", b"\r\n")),
    "no provenance": lambda folder: (folder / "provenance.json").unlink(),
    "a pipe for provenance": replaced(os.mkfifo, "provenance.json"),
    "a folder": replaced(Path.mkdir, "sweep.csv"),
    "packed and cut": packed_and_cut,
    **{
        name: rewritten(lambda _, text=text: text, "provenance.json")
        for name, text in PROVENANCE.items()
    },
}


def animate(folder):
    """Return the command that shows a folder's sweep."""
    few = ["--sources", "exact", "housner"]
    return ["animate", "--results", str(folder), *few, "--out", str(folder / "film.gif")]


@pytest.mark.parametrize("harm", HARM.values(), ids=HARM)
def test_a_table_that_is_not_as_it_was_written_is_not_shown(harm, folder, capsys):
    harm(folder)
    refused(capsys, animate(folder), "--results", "sweep.csv")
    assert not (folder / "film.gif").exists()


def test_a_table_beside_another_run_s_provenance_is_refused(folder, another, capsys):
    shutil.copy(another / "provenance.json", folder)
    refused(capsys, animate(folder), "sweep.csv")
    shutil.copy(another / "sweep.csv", folder)
    check(folder, ("sweep.csv",), "--results")


def test_every_table_of_a_folder_has_its_digest_and_may_be_packed(folder):
    tables = json.loads((folder / "provenance.json").read_text())["tables"]
    assert set(tables) == {path.name for path in folder.glob("*.csv")}
    assert {"sweep.csv", "summary.csv"} <= set(tables)
    assert all(len(bytes.fromhex(digest)) == 32 for digest in tables.values())
    path = folder / "summary.csv"
    (folder / "summary.csv.gz").write_bytes(gzip.compress(path.read_bytes()))
    path.unlink()
    check(folder, ("summary.csv",), "--results")


def test_the_command_run_again_makes_the_tables_anew(folder, swept, capsys):
    edit(folder / "sweep.csv")
    refused(capsys, animate(folder), "sweep.csv")
    sweep(folder)
    assert (folder / "sweep.csv").read_bytes() == (swept / "sweep.csv").read_bytes()
    check(folder, ("sweep.csv",), "--results")


def test_no_run_is_begun_where_its_table_could_not_be_written(tmp_path, capsys):
    (tmp_path / "out" / "sweep.csv").mkdir(parents=True)
    refused(capsys, ["sweep", "--figure", "6", "--out", tmp_path / "out"], "--out", "sweep.csv")
    assert [path.name for path in (tmp_path / "out").iterdir()] == ["sweep.csv"]


OTHER = {"exact": "housner", "housner": "exact"}
ROW = {
    "no column but the outcome": lambda row: {"outcome": "rocked"},
    "another source": lambda row: {**row, "source": OTHER[row["source"]]},
    "another case": lambda row: {**row, "omega_over_p": 99.0},
    "a word for a number": lambda row: {**row, "peak_ratio": "high"},
    "a list for a source": lambda row: {**row, "source": ["exact"]},
}


@pytest.mark.parametrize("forge", ROW.values(), ids=ROW)
@pytest.mark.parametrize("count", [1, None], ids=["one line", "all lines"])
def test_a_forged_row_is_one_line(forge, count, folder, capsys):
    path = folder / "journal.jsonl"
    kept = path.read_bytes().splitlines()
    rows = [number for number, line in enumerate(kept) if b'"row"' in line]
    for number in rows[:count]:
        entry = unseal(kept[number])
        kept[number] = sealed_line({**entry, "row": forge(entry["row"])})[:-1]
    path.write_bytes(b"\n".join(kept) + b"\n")
    few = ["--figure", "6", "--sources", "exact", "housner"]
    refused(capsys, ["sweep", *few, "--out", folder], "--out", "journal.jsonl")


@pytest.mark.parametrize(
    ("command", "tables"), [("advise", TABLES), ("symptoms", SYMPTOMS)], ids=["advise", "symptoms"]
)
def test_no_advice_from_edited_tables(command, tables, published, capsys):
    asked = [command, "--published", published, "--engines", "mujoco"]
    assert run([str(word) for word in asked]) == 0
    capsys.readouterr()
    for name in tables:
        text = (published / name).read_text()
        edit(published / name)
        refused(capsys, asked, "--published", name)
        (published / name).write_text(text[: len(text) // 2])
        refused(capsys, asked, "--published", name)
        (published / name).write_text(text)


def test_no_bound_from_an_edited_factor(published, monkeypatch, capsys):
    monkeypatch.setattr(halving, "FACTORS", published / "estimate" / "factors.csv")
    edit(published / "estimate" / "factors.csv")
    few = ["--sources", "mujoco", "--jobs", "1", "--step", "0.02"]
    refused(capsys, ["compare", *CASE, *few, "--estimate"], "factors.csv")


def test_no_score_beside_an_edited_table(published, monkeypatch, tmp_path, capsys):
    monkeypatch.setattr(score, "PUBLISHED", published)
    edit(published / "precision" / "work-precision.csv")
    out = tmp_path / "out"
    refused(capsys, ["score", "mujoco", "--quick", "--out", out], "work-precision.csv")
    assert not out.exists()


def test_no_page_from_an_edited_table(published, capsys):
    root = published.parents[1]
    for name in ("sweep/summary.csv", "overturning/engines.csv.gz", "precision/scenes.csv"):
        content = (published / name).read_bytes()
        (published / name).write_bytes(content[:-9])
        refused(capsys, ["readme", "--root", root], "published", name.partition("/")[2])
        (published / name).write_bytes(content)
    assert not (root / "README.md").exists()


def test_whatever_is_checked_comes_with_an_installation():
    project = tomllib.loads((PUBLISHED.parents[1] / "pyproject.toml").read_text(encoding="utf-8"))
    packed = set(project["tool"]["setuptools"]["package-data"]["studies"])
    data = {"GUIDE.md", "measures/columns.csv", "published/columns.csv"}
    read = {*TABLES, RANDOM, *SYMPTOMS, score.LADDER, str(halving.FACTORS.relative_to(PUBLISHED))}
    beside = {f"{name.partition('/')[0]}/provenance.json" for name in read}
    assert {f"published/{name}" for name in read | beside} | data == packed


@pytest.mark.parametrize("folder", sorted(PUBLISHED.glob("*/")), ids=lambda folder: folder.name)
def test_every_published_table_has_its_digest(folder):
    tables = json.loads((folder / "provenance.json").read_text())["tables"]
    for path in [*folder.glob("*.csv"), *folder.glob("*.csv.gz")]:
        assert tables[path.name.removesuffix(".gz")] == digest(path)
