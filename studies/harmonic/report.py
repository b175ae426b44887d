"""What the steady states say: branches, their shares of the starts, and the engines on them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pandas as pd

from analytic.response import Outcome
from studies.drawing.kept import Pictures, tell
from studies.kit import provenance
from studies.kit.tables import table_in
from studies.measures.words import out_of

NOUNS = {"frequency": "At {} frequencies", "amplitude": "At {} amplitudes"}
KIND, SPANNED = ["outcome", "period", "impacts"], ["x", "larger_ratio", "start_share"]
"""Columns that tell attractors apart, and those that change along one."""


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return the text."""
    table, asked = table_in(folder, "harmonic"), settings_of(folder)
    side = asked["starts"]
    tables = {
        f"Abscissae: all, those with several steady states, with one longer than a forcing period, "
        f"from which some of {side} rotations by {side} rates overturn and others do not, and all "
        "do": pd.DataFrame([counts(table)]),
        "Attractors of the exact solution, run by run (mirror images are one, and so are all that "
        "do not repeat, period 0; without a start: found by following the orbit from the next "
        "point)": branches(table),
        "Engines after some time on the exact orbit, difference of its larger rotation": (
            engine_errors(table_in(folder, "engines"))
        ),
    }
    return tell(folder, pictures(folder), headline(folder), tables)


def settings_of(folder: Path) -> dict[str, Any]:
    """Return what a folder's sweep was asked for, from its provenance."""
    return dict(provenance.record_of(folder)["settings"])


def branches(table: pd.DataFrame) -> pd.DataFrame:
    """Return each kind of attractor with its sizes and shares of the starts.

    A line for every run of neighbouring abscissae; all orbits that do not repeat are of one kind.
    """
    known = table.assign(
        impacts=table["impacts"].where(table["period"] > 0, 0),
        place=table["x"].rank(method="dense"),
    ).sort_values("x", kind="stable")
    run = known.groupby(KIND)["place"].transform(lambda place: (place.diff() > 1).cumsum())
    found = known.groupby([*KIND, run], sort=False)[SPANNED].agg(["min", "max"])
    found.columns = found.columns.map("_".join)
    return found.reset_index(KIND)


def counts(table: pd.DataFrame) -> dict[str, int]:
    """Count abscissae: of several steady states, of a longer period, of some and all overturned."""
    steady = table["outcome"].isin([Outcome.ROCKED.value, Outcome.AT_REST.value])
    states = steady.groupby(table["x"]).sum()
    fallen = (table["outcome"] == Outcome.OVERTURNED.value).groupby(table["x"]).any()
    return {
        "all": len(states),
        "several": int((states > 1).sum()),
        "longer": table.loc[table["period"] > 1, "x"].nunique(),
        "both": int((fallen & (states > 0)).sum()),
        "fallen": int((fallen & (states == 0)).sum()),
    }


def engine_errors(engines: pd.DataFrame) -> pd.DataFrame:
    """Return how far each engine is from the exact orbit on which it started."""
    if engines.empty:
        return engines
    error = (engines["larger_ratio"] / engines["larger_exact"] - 1.0).abs()
    by = error.groupby(engines["source"], sort=False)
    return by.agg(orbits="size", kept="count", median_error="median", max_error="max").reset_index()


def headline(folder: Path) -> str:
    """Say at how many abscissae several steady states live, and where the start decides a fall."""
    found = counts(table_in(folder, "harmonic"))
    several, both = (out_of(found[name], found["all"]) for name in ("several", "both"))
    return (
        f"{NOUNS[settings_of(folder)['over']].format(several)} a block has more than one steady "
        f"state, and at {both} its start decides whether it overturns."
    )


def pictures(folder: Path) -> Pictures:
    """Draw the diagram of a folder from its tables alone."""
    from studies.harmonic.figure import draw_harmonic

    swept, over = table_in(folder, "harmonic"), settings_of(folder)["over"]
    return {"harmonic": draw_harmonic(swept, table_in(folder, "engines"), over)}
