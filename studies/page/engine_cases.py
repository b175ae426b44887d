"""What engines answer over the plane of pulses, small enough to be held by a page."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import pandas as pd

from studies.cases.paper import PULSES
from studies.defaults.claims import INVALID
from studies.defaults.study import read
from studies.measures.again import written_out

DIGITS = 5
OVERTURNED = -1.0
"""What stands in place of a peak; a case that failed has None."""
AXES = ("half_cycles", "aspect", "width_m", "onsets", "omega_over_p")
"""Columns of the grid, the last running fastest."""


def engine_cases(folder: Path) -> dict[str, Any]:
    """Return what the exact solution and the engines answer on the grid of `rocking defaults`.

    Returns
    -------
    dict
        Of each of AXES its values; peaks: source -> the peaks of all cases, in their order, without
        the study's table of no source; judged: of each case 1, or 0 where the block would slide or
        lift off; rests: for how long all is at rest before the pulse of each [s]; written: the
        sources that `rocking export` writes out.
    """
    path = folder / "defaults" / "defaults.csv"
    if not path.is_file():
        return {"peaks": {}}
    rows = read(path.parent)
    rows = rows.assign(
        half_cycles=rows["pulse"].map(PULSES),
        peak=rows["peak_ratio"].mask(rows["outcome"] == "overturned", OVERTURNED),
    )
    axes = {name: sorted(rows[name].unique().tolist()) for name in AXES}
    order = pd.MultiIndex.from_product(list(axes.values()), names=AXES)
    wide = rows.pivot(index=list(AXES), columns="source", values="peak").reindex(order)
    found = {str(name): [_short(peak) for peak in wide[name]] for name in rows["source"].unique()}
    slides = rows[rows["verdict"] == INVALID].drop_duplicates(list(AXES))
    judged = 1 - order.isin(pd.MultiIndex.from_frame(slides[list(AXES)])).astype(int)
    rests = rows.drop_duplicates(list(AXES)).set_index(list(AXES))["rest_s"].reindex(order)
    return {
        **axes,
        "peaks": found,
        "judged": judged.tolist(),
        "rests": rests.tolist(),
        "written": list(filter(written_out, found)),
    }


def _short(value: float) -> float | None:
    return float(f"{value:.{DIGITS}g}") if math.isfinite(value) else None
