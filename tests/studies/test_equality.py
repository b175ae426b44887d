"""Two folders of results: what counts as the same, and what is said where they are not."""

import shutil

import pandas as pd
import pytest

from studies.old import app
from studies.measures.equality import MEASURED, SAME
from studies.measures.published import PUBLISHED, columns


def same(*arguments):
    return app.run((SAME,), ["same", *map(str, arguments)])


@pytest.fixture
def two(tmp_path):
    """A published table twice: its folders, and the table."""
    for name in ("before", "after"):
        (tmp_path / name / "sweep").mkdir(parents=True)
        shutil.copy(PUBLISHED / "sweep" / "sweep.csv", tmp_path / name / "sweep")
    return tmp_path / "before", tmp_path / "after"


def change(folder, **columns):
    path = folder / "sweep" / "sweep.csv"
    table = pd.read_csv(path, keep_default_na=False, na_values=["nan"])
    for name, made in columns.items():
        table[name] = made(table[name])
    table.to_csv(path, index=False, na_rep="nan")


def test_the_published_tables_are_their_own(capsys):
    assert same(PUBLISHED, PUBLISHED) == 0
    lines = capsys.readouterr().out.splitlines()
    assert len(lines) == len(list(PUBLISHED.rglob("*.csv"))) > 20
    assert all(line.endswith(": equal") for line in lines)


def test_run_times_are_not_compared_and_all_else_is(two, capsys):
    change(two[1], wall_s=lambda x: 2.0 * x)
    assert same(*two) == 0
    change(two[1], peak_ratio=lambda x: x * (1.0 + 1e-12))
    assert same(*two) == 1
    assert "peak_ratio differs in " in capsys.readouterr().out
    assert same(*two, "--within", "1e-9") == 0
    change(two[1], outcome=lambda x: x.where(x.index != 3, "lost"))
    assert same(*two, "--within", "1e-9") == 1
    assert "outcome differs in 1 of " in capsys.readouterr().out


def test_what_is_missing_or_shaped_otherwise_is_said(two, capsys):
    table = pd.read_csv(two[1] / "sweep" / "sweep.csv")
    table[:-1].to_csv(two[1] / "sweep" / "sweep.csv", index=False)
    assert same(*two) == 1
    assert f"{len(table)} rows before, {len(table) - 1} after" in capsys.readouterr().out
    table.drop(columns="impacts").to_csv(two[1] / "sweep" / "sweep.csv", index=False)
    assert same(*two) == 1
    assert "other columns: impacts" in capsys.readouterr().out
    (two[1] / "sweep" / "sweep.csv").unlink()
    assert same(*two) == 1
    assert "it is missing" in capsys.readouterr().out
    assert same(two[0], two[1] / "nowhere") == 2
    assert "AFTER is " in capsys.readouterr().err


def test_what_is_measured_is_a_column():
    assert {name for table, name in columns() if not table} >= MEASURED
