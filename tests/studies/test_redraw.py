"""Results drawn again from their tables: as they are, and after somebody edited them."""

import shutil
from pathlib import Path

import pandas as pd
import pytest
from commanding import refused

from studies.__main__ import run
from studies.kit.provenance import seal
from studies.measures.published import PUBLISHED


def with_a_word(table, column):
    return table.astype({column: object}).assign(
        **{column: [*table[column].iloc[:-1].astype(str), "many"]}
    )


# (study, table, what is done to it, what the line names)
EDITS = [
    ("free", "free.csv", lambda t: with_a_word(t, "period_error"), "free"),
    ("free", "free.csv", lambda t: with_a_word(t, "tilt"), "free"),
    ("free", "free.csv", lambda t: t.drop(columns="source"), "source"),
    ("free", "free.csv", lambda t: t.drop(columns="decay_error"), "decay_error"),
    ("free", "free.csv", lambda t: t.head(0), "free.csv has no rows"),
    ("validity", "map.csv", lambda t: t.head(1), "validity"),
    ("validity", "map.csv", lambda t: t.head(0), "validity"),
    ("validity", "map.csv", lambda t: with_a_word(t, "min_normal"), "validity"),
    ("validity", "map.csv", lambda t: with_a_word(t, "omega_over_p"), "validity"),
    ("validity", "compared.csv", lambda t: t.drop(columns="verdict"), "verdict"),
    ("linearizations", "linearizations.csv", lambda t: t.head(0), "has no rows"),
    ("sweep", "sweep.csv", lambda t: with_a_word(t, "peak_ratio"), "rocking sweep"),
    ("sweep", "sweep.csv", lambda t: t.drop(columns="aspect"), "aspect"),
    ("stability", "stability.csv", lambda t: t.drop(columns="verdict"), "verdict"),
]


@pytest.mark.parametrize(("study", "table", "edit", "named"), EDITS)
def test_an_edited_table_is_one_line(study, table, edit, named, tmp_path, capsys):
    folder = Path(shutil.copytree(PUBLISHED / study, tmp_path / study))
    pictures = sorted(folder.glob("*.png"))
    before = {path: path.read_bytes() for path in pictures}
    edit(pd.read_csv(folder / table)).to_csv(folder / table, index=False)
    seal(folder)  # as a study that wrote it so would
    refused(capsys, ["redraw", folder], named)
    assert {path: path.read_bytes() for path in pictures} == before
    assert not list(folder.glob(".*"))


def test_of_a_folder_whose_tables_have_no_picture_it_is_said(tmp_path, capsys):
    folder = tmp_path / "precision"
    folder.mkdir()
    for name in ("reference.csv", "provenance.json"):
        shutil.copy(PUBLISHED / "precision" / name, folder)
    seal(folder)
    assert run(["redraw", str(folder)]) == 0
    assert capsys.readouterr().out == f"{folder}: none of its tables has a picture\n"


@pytest.mark.parametrize("content", [b"", b"\n\n\n", bytes(range(256)), b"a,b\n1,2,3\n4,5\n"])
def test_what_is_no_table_is_one_line(content, tmp_path, capsys):
    (tmp_path / "free.csv").write_bytes(content)
    refused(capsys, ["redraw", tmp_path])


@pytest.mark.slow
def test_results_are_drawn_from_their_tables_alone(tmp_path, capsys):
    for study in ("free", "sweep", "validity", "overturning"):
        folder = tmp_path / study
        folder.mkdir()
        # a map's window is in its provenance, and its long tables are packed
        for pattern in ("*.csv", "*.csv.gz", "provenance.json"):
            for path in (PUBLISHED / study).glob(pattern):
                shutil.copy(path, folder)
        seal(folder)
        assert run(["redraw", str(folder), "--suffix", "svg"]) == 0
        drawn = [Path(line) for line in capsys.readouterr().out.splitlines()]
        assert [path.suffix for path in drawn] == [".svg"] * len(drawn) != []
        assert all(path.read_text().startswith("<?xml") for path in drawn)
        published = {path.stem for path in (PUBLISHED / study).glob("*.png")}
        assert {path.stem for path in drawn} == published


def test_a_picture_that_cannot_be_written_is_named(tmp_path, capsys, monkeypatch):
    folder = Path(shutil.copytree(PUBLISHED / "free", tmp_path / "free"))
    seal(folder)
    (folder / ".part.free.png").mkdir()
    refused(capsys, ["redraw", folder], "free.png")
