"""The eight linearizations: the named ones among them, what each change does, the conclusions."""

import math

import numpy as np
import pandas as pd
import pytest

from analytic import MODELS, peak_ratios
from studies import linearizations
from studies.kit.run import run
from studies.linearizations import NAMED, VARIANTS, errors_on, grid
from studies.measures.differences import posed_cases


@pytest.mark.parametrize("changed", VARIANTS)
def test_each_change_is_what_it_says(changed):
    onset, frequency, saddle = map(int, changed)
    law = VARIANTS[changed].law(0.6, 0.7)
    assert law.onset == pytest.approx(math.tan(0.6) if onset else 0.6)
    assert law.k == pytest.approx(math.sqrt(math.cos(0.6)) if frequency else 1.0)
    assert law.saddle == pytest.approx(math.tan(0.6) if saddle else 0.6)
    if changed in NAMED:
        assert law == pytest.approx(MODELS[NAMED[changed]].law(0.6, 0.7), rel=1e-15)


def test_the_saddle_alone_scales_the_rotation_and_changes_no_outcome():
    """A linear model's equation holds for any multiple of y that scales saddle and forcing."""
    cases = grid("paper").iloc[::7]
    posed = posed_cases(cases)
    scale = np.tan(posed[0]) / posed[0]
    for changed in ("00", "01", "10", "11"):
        at_alpha, outcome = peak_ratios(*posed, model=VARIANTS[f"{changed}0"])
        at_tangent, same = peak_ratios(*posed, model=VARIANTS[f"{changed}1"])
        # but for a block whose side touches the ground, at 90 degrees whatever its saddle
        assert np.mean(outcome == same) > 0.99
        both = np.isfinite(at_alpha) & np.isfinite(at_tangent)
        np.testing.assert_allclose(at_tangent[both], (scale * at_alpha)[both], rtol=1e-11)


def test_grids_have_no_copies_and_errors_are_against_the_exact_peak():
    assert len(grid("paper")) == 480
    assert not grid("wide").duplicated().any()
    errors = errors_on("paper", "111")
    row = errors[errors["error"].notna()].iloc[40]
    posed = (math.atan(1 / row["aspect"]), *row[["amplitude_g", "omega_over_p", "half_cycles"]])
    peaks = [float(peak_ratios(*posed, model=name)[0]) for name in ("modified", "exact")]
    assert row["error"] == pytest.approx(peaks[0] / peaks[1] - 1.0)


def test_tables_follow_the_rows(monkeypatch):
    monkeypatch.setattr(linearizations, "GRIDS", ("paper",))
    rows = pd.DataFrame(run(linearizations.jobs((), False), linearizations.measure))
    wide = rows.assign(
        grid="wide", by_aspect=[[dict(it) for it in each] for each in rows["by_aspect"]]
    )
    both = pd.concat([rows, wide], ignore_index=True)
    tables = linearizations.tabulate(both)
    lines = tables["linearizations"].set_index(["grid", "changed"])
    assert len(lines) == 16
    assert lines.loc[("paper", "000"), ["cases", "wrong", "false"]].tolist() == [480, 26, 25]
    assert tables["slenderness"].groupby("grid")["false"].sum()["paper"] == lines["false"].sum() / 2
    assert tables["findings"]["holds"].tolist() == [False]
    assert "onset" in linearizations.finding(tables) and "61 %" in linearizations.finding(tables)
    both["median_error"] = [0.1 if changed[1] == "1" else 0.2 for changed in both["changed"]]
    assert linearizations.tabulate(both)["findings"]["holds"].tolist() == [True]
