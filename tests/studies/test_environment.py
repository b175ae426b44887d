"""What the environment says: terminals of any width, and settings meant for other programs."""

import subprocess
import sys

import pytest
from commanding import CASE, ROOT

from studies.__main__ import COMMANDS, run
from studies.kit import app


@pytest.mark.parametrize("columns", ["0", "1", "-1", "1000000000", "wide", ""])
def test_every_command_has_help_in_a_terminal_of_any_width(columns, monkeypatch, capsys):
    """All of them in the narrowest and the widest; what is no width is settled alike for each."""
    monkeypatch.setenv("COLUMNS", columns)
    app.settle_environment()
    for study in COMMANDS if columns in ("1", "1000000000") else COMMANDS[:3]:
        assert run([study.name, "--help"]) == 0
        output = capsys.readouterr()
        assert output.err == ""
        lines = output.out.splitlines()
        assert lines[0].startswith(f"Usage: rocking {study.name}")
        assert max(map(len, lines)) <= app.WIDEST


def test_settings_of_other_programs_change_nothing(tmp_path, monkeypatch):
    monkeypatch.setenv("MPLBACKEND", "nonsense")
    monkeypatch.setenv("NUMBA_NUM_THREADS", "0")
    plot = tmp_path / "plot.png"
    arguments = ["compare", *CASE, "--sources", "exact", "--json", "--plot", str(plot)]
    done = subprocess.run(
        [sys.executable, "-m", "studies", *arguments], cwd=ROOT, capture_output=True, text=True
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout.count("\n") == 1
    assert plot.read_bytes().startswith(b"\x89PNG")
