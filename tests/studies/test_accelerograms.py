"""Recorded accelerograms in a comparison: scaled, corrected, and what is said of them."""

import numpy as np
import pytest
from commanding import BLOCK, compared, refused
from records import write_record
from scipy.signal import detrend

from analytic import GRAVITY, Record, RigidBlock, simulate
from studies.__main__ import run
from studies.cases.accelerograms import read_record

ASKED = [*BLOCK, "--sources", "exact", "housner", "--record"]


def test_compare_takes_a_record(tmp_path, capsys):
    """A pulse as AT2 file gives the pulse's answer, within its samples' (omega dt)^2/8."""
    samples = 0.2 * GRAVITY * np.sin(2.0 * np.pi * np.linspace(0.0, 1.0, 401))
    path = write_record(tmp_path / "pulse.AT2", Record(dt=0.0025, samples=samples))
    plot = tmp_path / "plot.png"
    asked = [*BLOCK, "--sources", "exact", "rk45", "--record", path]
    code, rows = compared(capsys, *asked, "--pga", "0.4")
    found = [row["peak_ratio"] for row in rows.values()]
    assert (code, found) == (0, pytest.approx([0.385153] * 2, rel=1e-3))
    assert run(["compare", *map(str, asked), "--scale", "2", "--plot", str(plot)]) == 0
    text = capsys.readouterr().out
    assert "ground  record, 0.4 g, 1.25 m/s, 401 samples every 0.0025 s, 1 s" in text
    assert plot.stat().st_size > 4_000


def shaken(folder, offset):
    """Write 2 s of a sine of 0.25 g at 1 Hz with an offset [g]."""
    samples = 0.25 * np.sin(2.0 * np.pi * np.linspace(0.0, 2.0, 401)) + offset
    record = Record(dt=0.005, samples=GRAVITY * samples)
    return write_record(folder / f"{offset}.AT2", record)


def told(path, capsys, *options):
    """Return the message of each source, and the table."""
    code, rows = compared(capsys, *ASKED, path, *options)
    assert code == run(["compare", *ASKED, str(path), *options]) == 0
    return [row["message"] for row in rows.values()], capsys.readouterr().out


def test_a_velocity_that_does_not_end_at_zero_is_reported(tmp_path, capsys):
    """An offset of 0.01 g for 2 s is 0.1962 m/s. It is said, and nothing is changed."""
    path = shaken(tmp_path, 0.01)
    said = "the record's velocity ends at 0.196 m/s, 0.21 of its largest, and the base keeps it"
    messages, text = told(path, capsys)
    assert messages == [f"{said}; --baseline corrects it"] * 2
    assert f"\nbase    {said}; --baseline corrects it\n" in text
    assert all(said in words for words in told(path, capsys, "--baseline", "none")[0])
    messages, text = told(shaken(tmp_path, 0.0), capsys)
    assert messages == ["", ""]
    assert "velocity ends" not in text


@pytest.mark.parametrize("baseline", ["constant", "linear"])
def test_a_baseline_is_corrected_by_a_named_method(baseline, tmp_path, capsys):
    """As SciPy's detrend does, before the record is scaled; and the answer says so."""
    path, options = shaken(tmp_path, 0.03), ["--baseline", baseline, "--pga", "0.35"]
    left = detrend(read_record(path).samples, type=baseline)
    record = Record(dt=0.005, samples=left).scaled_to(0.35 * GRAVITY)
    expected = simulate(RigidBlock(width=0.5, height=1.5), record).peak_ratio
    _, rows = compared(capsys, *ASKED, path, *options)
    assert rows["exact"]["peak_ratio"] == pytest.approx(expected, rel=1e-9)
    messages, text = told(path, capsys, *options)
    assert messages[0].startswith(f"baseline corrected by detrend, {baseline}")
    assert f"\nbase    baseline corrected by detrend, {baseline}" in text


def test_nothing_but_a_trend_is_refused(tmp_path, capsys):
    path = tmp_path / "motion.txt"
    path.write_text("# units: g\n0 0.3\n0.1 0.3\n0.2 0.3\n")
    asked = ["compare", *ASKED, path, "--baseline", "constant", "--pga", "1"]
    refused(capsys, asked, "--record: the record is its own constant trend")
