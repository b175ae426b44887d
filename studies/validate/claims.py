"""What random cases say, in tables and a sentence, with bounds, and what was left out of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from math import inf
from typing import TYPE_CHECKING

import pandas as pd

from analytic.response import Outcome
from studies.cases.drawn import (
    FRICTION,
    KEPT,
    LEAST_NORMAL,
    LIFTED,
    NEAR,
    SLIDES,
    TIPS,
    Drawn,
    everything,
    fate_of,
)
from studies.measures.differences import WELL_CONDITIONED, conditioning_of, sensitivity_of
from studies.measures.halving import estimates_of, published_trust
from studies.measures.words import NAMED, gathered, listed, part, right_of
from studies.measures.wrongness import counted, wrong_in

if TYPE_CHECKING:
    pass

PEAKS, KAPPAS = (0.01, 0.1, 0.5), (10.0, 100.0)
"""Where bands end: of the exact peak over θcr, and of the larger of κ and κη."""

LEFT_OUT = {
    NEAR: f"the normal force falls to {LEAST_NORMAL:g} of the weight or less",
    LIFTED: "the normal force is lost: the pivot would have to be held down",
}
"""Cases that nobody was asked about -> why not."""

OF_FRAMES = {
    SLIDES: f"a foot or the beam would slide by a friction of {FRICTION:g}",
    TIPS: "the beam would tip",
}
"""The same, of frames alone."""


def census(seed: int, kept: int, scene: Drawn = "block") -> pd.DataFrame:
    """Count what was drawn until enough cases were kept, and why the others were left out.

    Parameters
    ----------
    seed : int
        Of the random cases.
    kept : int
        Cases to keep.
    scene : {"block", "frame"}, optional

    Returns
    -------
    DataFrame
        Rows drawn, kept, and those left out; the columns set, cases, overturned and share, both of
        the exact solution, and why.
    """
    left = LEFT_OUT if scene == "block" else LEFT_OUT | OF_FRAMES
    counts = {name: [0, 0] for name in ("drawn", KEPT, *left)}
    for drawn, exact in everything(seed, scene):
        if counts[KEPT][0] == kept:
            break
        for name in ("drawn", fate_of(drawn, exact)):
            counts[name][0] += 1
            counts[name][1] += exact.outcome is Outcome.OVERTURNED
    table = pd.DataFrame.from_dict(counts, orient="index", columns=["cases", "overturned"])
    table = table.assign(share=table["overturned"] / table["cases"])
    return table.rename_axis("set").reset_index().assign(why=[left.get(n, "") for n in counts])


def finding(compared: pd.DataFrame) -> str:
    """Say what each source gets right, and its largest error, everywhere and in calm cases."""
    right = [
        (str(source), right_of(rows)) for source, rows in compared.groupby("source", sort=False)
    ]
    calm = compared[sensitivity_of(compared) < WELL_CONDITIONED]
    return (
        "Outcomes right on random cases that nothing was tuned on: "
        f"{gathered(right)}. Peaks are off by up to {_sizes(compared)}; where neither κ nor the "
        f"sensitivity reaches {WELL_CONDITIONED:g}, by {_sizes(calm)}."
    )


FRAMES = {"columns": "{} columns", "load": "load {}"}
"""Column of a frame -> it in words."""


def width(compared: pd.DataFrame) -> str:
    """Say how wide random cases are: between which ends each of their numbers lies."""
    ends = {
        **{words: compared[name] for name, words in FRAMES.items() if name in compared},
        "H/B {}": compared["aspect"],
        "B {} m": compared["width_m"],
        "{} half cycles": compared["half_cycles"],
        "ω/p {}": compared["omega_over_p"],
        "{} onsets": compared["amplitude_g"] * compared["aspect"],
    }
    return ", ".join(
        words.format(f"{values.min():.3g} to {values.max():.3g}") for words, values in ends.items()
    )


def _sizes(compared: pd.DataFrame) -> str:
    largest = compared["error"].abs().groupby(compared["source"], sort=False).max().dropna()
    if len(largest) > NAMED:
        named = [f"{part(size)} ({name})" for name, size in largest.sort_values().items()]
        return listed([named[0], named[-1]], "to")
    return listed([part(size) for size in largest])


def quantiles(compared: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: outcomes right and wrong, and quantiles of the error."""
    levels = {"median_error": 0.5, "p90_error": 0.9, "p99_error": 0.99, "max_error": 1.0}
    return pd.DataFrame(
        [
            {
                "source": source,
                "cases": len(rows),
                "agree": rows["agrees"].sum(),
                **counted(wrong_in(rows)),
                **{name: rows["error"].abs().quantile(level) for name, level in levels.items()},
            }
            for source, rows in compared.groupby("source", sort=False)
        ]
    )


def worst(compared: pd.DataFrame, count: int = 5) -> pd.DataFrame:
    """Return the cases that each source gets wrong, and then those in which it errs most.

    Parameters
    ----------
    compared : DataFrame
        With the columns of `studies.measures.differences.with_reference`, and case.
    count : int, optional
        So many of each source at most, at least 1.

    Returns
    -------
    DataFrame
        Under the index of `compared`, source by source.
    """
    size = compared["error"].abs().where(compared["agrees"], inf)
    order = compared.assign(size=size).sort_values("size", ascending=False)
    first = order.groupby("source").head(count).sort_values("source", kind="stable")
    posed = ["case", "aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p"]
    posed += [name for name in FRAMES if name in order]
    found = ["outcome", "exact_outcome", "exact_peak", "error"]
    return first[["source", *posed, *found, "kappa", "kappa_eta", "sensitivity"]]


def bands(compared: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source and band of the cases that survive in the exact solution.

    Parameters
    ----------
    compared : DataFrame
        With the columns of `studies.measures.differences.with_reference`.

    Returns
    -------
    DataFrame
        The columns of bands.csv.
    """
    rocked = compared[compared["exact_outcome"] == "rocked"]
    ways = {"peak": (rocked["exact_peak"], PEAKS), "κ": (conditioning_of(rocked), KAPPAS)}
    return pd.concat(
        [_in_bands(rocked.assign(by=by, band=_band(*way))) for by, way in ways.items()],
        ignore_index=True,
    )


def _band(values: pd.Series[float], ends: Sequence[float]) -> pd.Series[str]:
    between = [f"from {low:g} to {high:g}" for low, high in pairwise(ends)]
    names = [f"below {ends[0]:g}", *between, f"above {ends[-1]:g}"]
    return pd.cut(values, [0.0, *ends, inf], right=False, labels=names)


def _in_bands(rows: pd.DataFrame) -> pd.DataFrame:
    sizes = rows.assign(size=rows["error"].abs()).sort_values("band", kind="stable")
    groups = sizes.groupby(["source", "by", "band"], sort=False, observed=True)
    table = groups.agg(
        cases=("agrees", "size"),
        right=("agrees", "sum"),
        median_error=("size", "median"),
        max_error=("size", "max"),
    ).reset_index()
    return table.astype({"band": str})


HALVES = "halves"
"""Table of the rows at half the step."""


def with_bounds(compared: pd.DataFrame, finer: pd.DataFrame) -> pd.DataFrame:
    """Add estimate, and bound: the estimate times the published factor, nan where none was.

    Parameters
    ----------
    compared : DataFrame
        With the columns of `studies.measures.differences.with_reference`.
    finer : DataFrame
        The same cases at half the step.
    """
    found = compared.assign(estimate=estimates_of(compared, finer))
    return found.assign(bound=found["estimate"] * found["source"].map(_factors(found)))


def bounded(compared: pd.DataFrame) -> pd.DataFrame:
    """Return of every source with estimates its factor, and how many errors that bounds.

    The factor is nan of a source whose estimates were never held against errors.
    """
    known = compared.dropna(subset=["error", "estimate"])
    known = known.assign(
        factor=known["source"].map(_factors(known)), within=known["error"].abs() <= known["bound"]
    )
    groups = known.groupby("source", sort=False)
    return groups.agg(
        factor=("factor", "first"), survivors=("within", "size"), bounded=("within", "sum")
    ).reset_index()


def _factors(rows: pd.DataFrame) -> dict[str, float]:
    trusts = {source: published_trust(str(source)) for source in rows["source"].unique()}
    return {source: math.nan if trust is None else trust.factor for source, trust in trusts.items()}
