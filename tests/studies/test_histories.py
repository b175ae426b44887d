"""The paper's time histories: what their tables hold, and whether its statements do."""

import numpy as np
import pandas as pd
import pytest

from studies import histories
from studies.kit.run import run
from studies.measures.claims import claim


def lines(number, **peaks):
    """Return rows of a figure: for each source its peaks panel by panel, inf where it overturns."""
    rows = [
        {
            "figure": number, "panel": panel, "source": source, "peak_ratio": peak,
            "outcome": "overturned" if np.isinf(peak) else "failed" if np.isnan(peak) else "rocked",
            **{name: [0.0, peak] for name in histories.SAMPLES},
        }
        for source, found in peaks.items()
        for panel, peak in zip("abc", found, strict=False)
    ]  # fmt: skip
    return pd.DataFrame(rows)


@pytest.mark.parametrize(
    ("housner", "modified", "holds"),
    [
        ((1.1, 1.2, 1.5), (1.0, 1.0, 1.0), True),
        ((1.1, 1.2, 1.0), (1.0, 1.0, 1.0), False),  # it does not grow
        ((1.1, 1.2, 1.2), (1.0, 1.0, 1.0), False),
        ((1.1, 1.2, 1.5), (1.0, 1.3, 1.0), False),  # the modified one is further off
        ((1.1, np.nan, 1.5), (1.0, 1.0, 1.0), None),  # a failed source cannot be tested
    ],
)
def test_figure_4_compares_errors_of_the_peak(housner, modified, holds):
    rows = lines(4, exact=(1.0, 1.0, 1.0), housner=housner, modified=modified)
    assert histories.tabulate(rows)["findings"]["holds"].tolist() == [holds]


@pytest.mark.parametrize(("peak", "holds"), [(np.inf, True), (0.9, False)])
def test_figure_5_compares_outcomes(peak, holds):
    rows = lines(5, exact=[0.5] * 3, housner=[0.5, np.inf, peak], modified=[0.5] * 3)
    tables = histories.tabulate(rows)
    assert tables["findings"]["holds"].tolist() == [holds]
    assert f"{'1' if holds else 'None'} of 1" in histories.finding(tables)


def test_samples_stand_beside_their_case_and_a_failed_line_has_none():
    jobs = histories.jobs((), False, histories.Options(figure=(2,), sources=("exact", "rk4")))
    rows = pd.DataFrame(run(jobs, histories.measure))
    table = histories.tabulate(rows)["figure-2"]
    assert table.groupby(["panel", "source"]).size().tolist() == [1501] * 4
    peaks = table["theta_ratio"].abs().groupby([table["panel"], table["source"]]).max()
    assert peaks["b", "exact"] == pytest.approx(0.1369, abs=1e-4)
    rows.loc[0, "outcome"] = "failed"
    found = histories.tabulate(rows)
    assert len(found["figure-2"]) == 3 * 1501
    assert found["findings"]["holds"].isna().all()  # average acceleration was not asked
    assert "No statement" in histories.finding(found)


def test_a_claim_needs_its_sources():
    table = pd.DataFrame({"source": ["exact"], "value": [2.0]})
    less = claim("two is less than one", "exact")(lambda t: (bool((t["value"] < 1).all()), "2"))
    lost = claim("nobody asked", "rk4")(lambda t: (True, ""))
    assert list(pd.DataFrame([less(table), lost(table)])["holds"]) == [False, None]
