"""The journal of a results folder: damage, strangers, links, pipes."""

import gzip
import itertools
import json
import os
import resource
from pathlib import Path

import pytest

from studies.catalogue import CHAPTERS, STUDIES
from studies.old.drafts import draft
from studies.old.journal import FolderError, named, open_journal, rows_in, seal, unseal
from studies.measures.published import PUBLISHED
from studies.page.facts import FIRST

SUBJECT = {"study": "test", "settings": {"seed": 1}}
MAKERS = [{"engines/one.py": "a"}, {"engines/one.py": "b", "numpy": "2.4"}]
MADE = named(MAKERS[0])
ROWS = {f"key {n}": {"outcome": "rocked", "peak_ratio": 0.1 * n, "message": "θ"} for n in range(3)}
WRITING = [study for study in STUDIES if study.products]
OF_FOLDER = {chapter.folder: study for study, chapter in CHAPTERS}


@pytest.fixture(autouse=True)
def no_waiting_for_the_disk(monkeypatch):
    monkeypatch.setattr(os, "fsync", lambda _: None)


def fill(folder):
    with open_journal(folder, SUBJECT, ()) as journal:
        for number, (key, row) in enumerate(ROWS.items()):
            journal.append(key, row, MAKERS[number == 2])
    return folder / "journal.jsonl"


def kept(folder):
    with open_journal(folder, SUBJECT, ()) as journal:
        return {key: entry.row for key, entry in journal.kept.items()}


def test_no_flipped_bit_gives_another_row(tmp_path):
    path = fill(tmp_path)
    content = path.read_bytes()
    for place, bit in itertools.product(range(len(content) - 1), range(8)):
        damaged = bytearray(content)
        damaged[place] ^= 1 << bit
        with pytest.raises(FolderError):
            if place <= content.index(b"\n"):
                path.write_bytes(damaged)
                kept(tmp_path)
            else:
                rows_in(tmp_path, bytes(damaged))
    # without its end the last line counts as not completed
    path.write_bytes(content[:-1] + b"?")
    assert kept(tmp_path) == dict([*ROWS.items()][:-1])


def test_a_journal_that_ends_anywhere_goes_on_with_its_whole_lines(tmp_path):
    path = fill(tmp_path)
    content = path.read_bytes()
    for length in range(len(content) + 1):
        path.write_bytes(content[:length])
        whole = [line for line in content[:length].split(b"\n")[:-1] if b'"row"' in line]
        assert kept(tmp_path) == dict(list(ROWS.items())[: len(whole)])


@pytest.mark.parametrize("room", [0, 5])
def test_a_disk_is_full_to_the_byte_or_in_the_middle_of_a_row(room, tmp_path):
    path, (usual, most) = fill(tmp_path), resource.getrlimit(resource.RLIMIT_FSIZE)
    with open_journal(tmp_path, SUBJECT, ()) as journal:
        resource.setrlimit(resource.RLIMIT_FSIZE, (path.stat().st_size + room, most))
        try:
            with pytest.raises(OSError, match=f"the disk is full: '{path}'"):
                journal.append("another", ROWS["key 0"], MAKERS[0])
        finally:
            resource.setrlimit(resource.RLIMIT_FSIZE, (usual, most))
    assert kept(tmp_path) == ROWS


@pytest.mark.parametrize("place", [1, 3, 4])
def test_a_damaged_line_is_named(place, tmp_path):
    path = fill(tmp_path)
    lines = path.read_bytes().splitlines(keepends=True)
    lines[place - 1] = lines[place - 1].replace(b"test", b"rest").replace(b"rocked", b"failed")
    path.write_bytes(b"".join(lines))
    with pytest.raises(FolderError, match=f"damaged in line {place}$"):
        kept(tmp_path)
    assert path.read_bytes() == b"".join(lines)


ROCKED = {"outcome": "rocked"}
DAMAGED = [
    *(b"\n", b"?\n", b"[" * 100_000 + b"\n", b'{"key": "a", "row": {"outcome": "rocked"}}\n'),
    *map(
        seal,
        [
            *({}, {"key": "a"}, {"key": 1, "made": MADE, "row": ROCKED}),
            {"key": "a", "made": MADE, "row": ["outcome"]},
            {"key": "a", "made": MADE, "row": {}},
            {"key": "a", "row": ROCKED},
            {"key": "a", "made": "unknown", "row": ROCKED},
            {"made": MADE, "of": MAKERS[1]},
            {"made": MADE, "of": list(MAKERS[0])},
        ],
    ),
]


@pytest.mark.parametrize("line", DAMAGED, ids=range(len(DAMAGED)))
def test_a_line_without_its_fields_is_damaged(line, tmp_path):
    with fill(tmp_path).open("ab") as journal:
        journal.write(line)
    with pytest.raises(FolderError, match="damaged in line 7"):
        kept(tmp_path)


def test_what_made_a_row_is_written_once_and_read_back(tmp_path):
    path = fill(tmp_path)
    with open_journal(tmp_path, SUBJECT, ()) as journal:
        made = {key: journal.kept[key].maker for key in ROWS}
        journal.append("key 0", ROWS["key 1"], MAKERS[1])
        assert journal.kept["key 0"].maker == MAKERS[1]
    assert list(made.values()) == [MAKERS[0], MAKERS[0], MAKERS[1]]
    assert sum(b'"of"' in line for line in path.read_bytes().splitlines()) == len(MAKERS)
    assert kept(tmp_path) == ROWS | {"key 0": ROWS["key 1"]}


def test_a_packed_journal_goes_on_unpacked(tmp_path):
    path = fill(tmp_path)
    packed = path.with_name("journal.jsonl.gz")
    packed.write_bytes(gzip.compress(path.read_bytes()))
    path.unlink()
    assert kept(tmp_path) == ROWS
    with open_journal(tmp_path, SUBJECT, ()) as journal:
        journal.append("key 3", ROWS["key 0"], MAKERS[0])
    assert kept(tmp_path) == ROWS | {"key 3": ROWS["key 0"]}
    path.unlink()
    packed.write_bytes(packed.read_bytes()[:-9])
    with pytest.raises(FolderError, match=r"its journal\.jsonl\.gz is damaged$"):
        kept(tmp_path)
    assert not path.exists()


@pytest.mark.parametrize("line", [b"?", b"[]", b"[" * 100_000, b'{"other": 1}', b"\xff", b"{}"])
def test_another_first_line_is_no_journal(line, tmp_path):
    path = tmp_path / "journal.jsonl"
    for end in (b"", b"\n"):
        path.write_bytes(line + end)
        with pytest.raises(FolderError, match="not a journal"):
            kept(tmp_path)
        assert path.read_bytes() == line + end


def test_a_sealed_line_is_json():
    entry = {"key": "θ", "row": {"a": float("inf"), "b": None}}
    assert json.loads(seal(entry)) | entry == json.loads(seal(entry))
    assert unseal(seal(entry)[:-1]) == entry


@pytest.mark.parametrize("study", WRITING, ids=lambda study: study.name)
def test_whatever_a_study_writes_is_not_overwritten_where_it_is_another_s(study, tmp_path):
    products = study.products
    for name in (*products, "provenance.json", ".lock"):
        folder = tmp_path / name
        folder.mkdir()
        (folder / name).write_text("mine")
        with (
            pytest.raises(FolderError, match=f"{name} of unknown origin"),
            open_journal(folder, SUBJECT, products),
        ):
            pass
        assert {path.name for path in folder.iterdir()} <= {name, ".lock"}
        assert (folder / name).read_text() == "mine"


@pytest.mark.parametrize("folder", [name for name in OF_FOLDER if (PUBLISHED / name).is_dir()])
def test_whatever_a_study_writes_is_among_its_products(folder):
    products = {*OF_FOLDER[folder].products, "journal.jsonl", "provenance.json", FIRST}
    # what is large is published packed
    found = {path.name.removesuffix(".gz") for path in (PUBLISHED / folder).iterdir()}
    assert found <= products


@pytest.mark.parametrize("name", ["journal.jsonl", "journal.jsonl.gz", ".lock", "provenance.json"])
@pytest.mark.parametrize("kind", ["a link", "a link to nothing", "a pipe", "a folder", "/dev/full"])
def test_what_is_no_file_is_refused_and_never_waited_for(name, kind, tmp_path):
    target, folder = tmp_path / "target", tmp_path / "out"
    folder.mkdir()
    path = folder / name
    if kind == "a pipe":
        os.mkfifo(path)
    elif kind == "a folder":
        path.mkdir()
    else:
        path.symlink_to(kind if kind == "/dev/full" else target)
        if kind == "a link":
            target.touch()
    with pytest.raises(FolderError, match=f"its {name} must be a file"):
        kept(folder)
    assert target.exists() == (kind == "a link")
    assert not target.exists() or target.read_bytes() == b""


def test_a_draft_follows_no_link(tmp_path):
    target, path = tmp_path / "target", tmp_path / "table.csv"
    target.write_text("mine")
    (tmp_path / ".part.table.csv").symlink_to(target)
    with draft(path) as file:
        file.write(b"a,b\n")
    assert path.read_text() == "a,b\n"
    assert target.read_text() == "mine"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["table.csv", "target"]


def test_a_draft_that_fails_leaves_what_was_there_and_names_it(tmp_path):
    path = tmp_path / "table.csv"
    path.write_text("before")
    with pytest.raises(OSError, match=r"No space left .*table\.csv"), draft(path) as file:
        with Path("/dev/full").open("wb", buffering=0) as full:
            full.write(b"a")
        file.write(b"after")
    with pytest.raises(RuntimeError), draft(path) as file:
        file.write(b"after")
        raise RuntimeError
    assert path.read_text() == "before"
    assert sorted(path.name for path in tmp_path.iterdir()) == ["table.csv"]
