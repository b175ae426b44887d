"""The data dictionary of the published tables, read as those do who have pandas and no more."""

import csv
import gzip
import re

import pandas as pd
import pytest
from commanding import ROOT

from studies.measures.published import columns

PUBLISHED = ROOT / "studies" / "published"
DICTIONARY = pd.read_csv(PUBLISHED / "columns.csv", keep_default_na=False)
TABLES = sorted(PUBLISHED.glob("*/*.csv*"))


def as_written(path):
    """Return the head and the rows of a table, every cell a word."""
    opened = gzip.open if path.suffix == ".gz" else open
    with opened(path, "rt", newline="", encoding="utf-8") as file:
        head, *rows = csv.reader(file)
    return head, rows


def is_of(kind, cell):
    """Return whether a cell can be read as what the dictionary says."""
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


def test_the_line_of_the_guide_reads_a_table():
    guide = (ROOT / "studies" / "GUIDE.md").read_text(encoding="utf-8")
    section = guide[guide.index("## The tables as data") :]
    code = re.search("```python\n(.*?)```", section, re.DOTALL)[1]
    known = {}
    exec(code.replace("studies/published", PUBLISHED.as_posix()), known)
    assert "studies" not in re.findall(r"(?:from|import) (\w+)", code)
    assert known["summary"]["cases"].max() == 960
    assert set(known["meaning"].index) == set(known["summary"].columns)
