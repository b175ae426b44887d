"""The house holds its size: lines of Python, counted as `wc -l` counts them."""

from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.mark.parametrize(
    ("folders", "most"), [(("analytic", "engines", "studies"), 25_000), (("tests",), 11_000)]
)
def test_lines_are_at_most(folders, most, capsys):
    files = [path for folder in folders for path in (ROOT / folder).rglob("*.py")]
    lines = sum(path.read_bytes().count(b"\n") for path in files)
    with capsys.disabled():
        print(f"\n{', '.join(folders)}: {lines} lines of at most {most}")
    assert len(files) > 50
    assert lines <= most
