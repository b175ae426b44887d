"""The eight linearizations: the named ones among them, what changes what, the page."""

import math

import numpy as np
import pytest

from analytic import MODELS, peak_ratios
from studies.linearizations import study as linearizations
from studies.linearizations.study import NAMED, VARIANTS, errors_on, grid


@pytest.mark.parametrize(("changed", "name"), NAMED.items())
def test_the_named_models_are_among_the_variants(changed, name):
    alpha = np.linspace(0.05, 1.2, 9)
    for ours, theirs in zip(
        VARIANTS[changed].constants(alpha), MODELS[name].constants(alpha), strict=True
    ):
        np.testing.assert_allclose(ours, theirs, rtol=1e-15)


@pytest.mark.parametrize("changed", VARIANTS)
def test_each_change_is_what_it_says(changed):
    onset, frequency, saddle = map(int, changed)
    law = VARIANTS[changed].law(0.6, 0.7)
    assert law.onset == pytest.approx(math.tan(0.6) if onset else 0.6)
    assert law.k == pytest.approx(math.sqrt(math.cos(0.6)) if frequency else 1.0)
    assert law.saddle == pytest.approx(math.tan(0.6) if saddle else 0.6)


def test_the_saddle_alone_scales_the_rotation_and_changes_no_outcome():
    """A linear model's equation holds for any multiple of y that scales saddle and forcing."""
    cases = grid("paper").iloc[::7]
    posed = (np.arctan(1.0 / cases["aspect"]), *cases.iloc[:, 1:].to_numpy().T)
    for changed in ("00", "01", "10", "11"):
        at_alpha, outcome = peak_ratios(*posed, model=VARIANTS[f"{changed}0"])
        at_tangent, same = peak_ratios(*posed, model=VARIANTS[f"{changed}1"])
        # but for a block whose side touches the ground, at 90 degrees whatever its saddle
        assert np.mean(outcome == same) > 0.99
        both = np.isfinite(at_alpha) & np.isfinite(at_tangent)
        scale = (np.tan(posed[0]) / posed[0]).to_numpy()
        np.testing.assert_allclose(at_tangent[both], (scale * at_alpha)[both], rtol=1e-11)


def test_grids_have_no_copies_and_errors_are_against_the_exact_peak():
    assert len(grid("paper")) == 480
    assert not grid("wide").duplicated().any()
    errors = errors_on("paper")
    row = errors[(errors["changed"] == "111") & errors["error"].notna()].iloc[40]
    posed = (math.atan(1 / row["aspect"]), *row[["amplitude_g", "omega_over_p", "half_cycles"]])
    peaks = [float(peak_ratios(*posed, model=name)[0]) for name in ("modified", "exact")]
    assert row["error"] == pytest.approx(peaks[0] / peaks[1] - 1.0)
    assert row["difference"] == pytest.approx(peaks[0] - peaks[1])


def test_every_variant_is_summarized_on_both_grids():
    lines = linearizations.summarize(linearizations.all_errors())
    assert len(lines) == 16 and not lines.duplicated(["grid", "changed"]).any()


def test_what_the_named_linearizations_miss_at_each_slenderness():
    errors = linearizations.all_errors()
    found = linearizations.by_slenderness(errors)
    assert len(found) == 12
    mine = errors[(errors["grid"] == "wide") & (errors["changed"] == "111")]
    mine = mine[mine["aspect"] == found.index[3]]
    assert found["modified error"].iloc[3] == mine["error"].abs().median()
    assert found["modified wrong"].iloc[3] == mine["wrong"].mean()
    worse = errors.assign(wrong=errors["wrong"] | (errors["changed"] == "111"))
    assert linearizations.modified_is_better(errors).holds
    assert not linearizations.modified_is_better(worse).holds
