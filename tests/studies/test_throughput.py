"""The benchmark counts what it says: the same cases, the same outcomes."""

import pandas as pd
import pytest

from studies.__main__ import run
from studies.cases.window import Window
from studies.throughput import study as throughput
from studies.throughput.study import peer_solvers, points, timings


def test_every_solver_answers_the_same_cases(tmp_path, monkeypatch, capsys):
    monkeypatch.setattr(throughput, "QUICK_CASES", 400)
    monkeypatch.setattr(throughput, "QUICK_PEER_CASES", 64)
    assert run(["throughput", "--quick", "--threads", "2", "--out", str(tmp_path)]) == 0
    table = pd.read_csv(tmp_path / "throughput.csv")
    rate = table.loc[table["source"] == "exact", "cases_a_second"].max()
    told = " ".join(capsys.readouterr().out.split())
    assert told.startswith(f"The exact model decides up to {rate:,.0f} cases of an overturning map")
    assert "Peak memory of this process" in told
    assert set(table["pulse"]) == {"half-sine", "full-sine"}
    assert (table["wrong"] == 0).all()
    alone = table[(table["source"] == "exact") & (table["threads"] == 1)]
    assert alone["times_exact"].to_numpy() == pytest.approx([1.0, 1.0])
    assert table["busy"].between(0.0, 1.1).all()
    rates = table["cases"] / table["seconds"]
    assert table["cases_a_second"].to_numpy() == pytest.approx(rates.to_numpy())
    of_a_core = 1e-6 * table["us_a_case_and_core"] * rates
    assert of_a_core.to_numpy() == pytest.approx(table["threads"].to_numpy())


def test_points_fill_the_window():
    window = Window()
    x, onsets = points(window, 1000)
    assert len(x) == len(onsets) == 31**2
    assert window.low < x.min() < x.max() < window.high
    assert 1.0 < onsets.min() < onsets.max() < window.onsets


def test_steps_are_counted():
    rows = timings(Window(), 400, 1, 1).set_index("source")
    assert rows.loc["exact", "steps"] > 2.0
    assert "dop853 (SciPy)" in peer_solvers()


def test_heyoka_answers_alone_and_in_a_batch():
    reason = "heyoka, of the extra peers, is not installed"
    peer = pytest.importorskip("studies.throughput.heyoka_peer", reason=reason)
    window = Window(onsets=6.0)
    x, onsets = points(window, 400)
    right = (window.modes(x, onsets).mode >= 0).tolist()
    assert 0 < sum(right) < len(right)
    assert peer.HeyokaSolver()(window, x, onsets) == right
    batch = peer.HeyokaBatch()
    assert batch(window, x, onsets) == right
    assert batch(window, x[:3], onsets[:3]) == right[:3]  # lanes without a case
    assert batch.integrating_s > 0.0
