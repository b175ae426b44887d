"""The cases that engines were asked, small enough to be held by a page."""

import math
from pathlib import Path
from typing import Any

import pandas as pd

from studies.cases.paper import PULSES
from studies.measures.presets import in_order, is_engine, preset_of
from studies.page.facts import PRESETS_FROM

CASE = ["pulse", "aspect", "width_m", "amplitude_g", "omega_over_p"]
DIGITS = 8
OVERTURNED = -1.0
"""What stands in place of a peak; a case that failed has None."""


def engine_cases(folder: Path) -> dict[str, Any]:
    """Return what the exact solution and the engines say of the paper's cases.

    Returns
    -------
    dict
        sources: the exact solution and engines, those with the libraries' defaults first; rows: of
        each case the half cycles, H/B, B [m], amplitude [g], omega/p, and each source's peak.
    """
    tables = [folder / name / "sweep.csv" for name in PRESETS_FROM]
    held = [pd.read_csv(path) for path in tables if path.is_file()]
    if not held:
        return {"sources": [], "rows": []}
    rows = pd.concat(held, ignore_index=True)
    engines = [name for name in rows["source"].unique() if is_engine(name)]
    order = in_order(map(preset_of, engines))
    sources = ["exact", *sorted(engines, key=lambda name: order.index(preset_of(name)))]
    rows = rows.assign(
        amplitude_g=1.0 / rows["aspect"] + rows["excess_g"],
        peak=rows["peak_ratio"].mask(rows["outcome"] == "overturned", OVERTURNED),
    )
    wide = rows.drop_duplicates([*CASE, "source"]).pivot(
        index=CASE, columns="source", values="peak"
    )
    found = wide.reindex(columns=sources)
    return {
        "sources": sources,
        "rows": [
            [PULSES[str(case[0])], *(_short(x) for x in (*case[1:], *peaks))]
            for case, peaks in zip(found.index, found.to_numpy(float), strict=True)
        ],
    }


def _short(value: float) -> float | None:
    """Return a number in few digits; None for none."""
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
