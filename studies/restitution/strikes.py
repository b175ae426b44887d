"""Blocks that strike their base with a corner, one thing varied at a time, and what comes out."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import partial
from itertools import product
from typing import NamedTuple

import pandas as pd

from engines import ENGINES
from studies.old.journal import Row
from studies.measures.formulas import by_step
from studies.restitution.strike import Strike, strike
from studies.restitution.ways import SHOWN, WAYS

WANTED = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Coefficients of restitution."""

PHASES = (0.1, 0.5, 0.9)
"""Parts of a step after which the impact falls."""

BASE = Strike(restitution=0.0)
"""From which one thing at a time is varied."""

VARIED = {
    "step": (1e-4, 4e-3),
    "rate": (0.1, 2.0),
    "height": (0.1, 10.0),
    "aspect": (4.0,),
}
"""What is varied -> its other values."""

COLUMNS = {"step": "p_dt", "rate": "rate_over_alpha_p", "height": "height_m", "aspect": "aspect"}
"""Names of what is varied in the table."""

BROKEN = 10.0
"""A corner that comes off so many times as fast was thrown by a contact that is unstable."""


class Measure(NamedTuple):
    """What a strike is asked: columns of what is found and of what is right, and how it is drawn.

    What is above the top, or broken, stands there as a cross.
    """

    found: str
    right: str
    label: str
    low: float
    top: float


CORNER = Measure("corner_ratio", "wanted", "Speed of the corner, after over before", -0.05, 1.35)
"""The speed of the corner after over before: the coefficient itself."""
RATE = Measure("rate_ratio", "kept_ratio", "Angular rate, after over before", -0.75, 1.15)
"""The angular rate of the block after over before, which follows from it."""


def all_strikes() -> Iterator[tuple[str, Strike]]:
    """Yield what is varied, "" for nothing, and what is asked."""
    others: list[tuple[str, dict[str, float]]] = [("", {})]
    others += [(name, {name: value}) for name, values in VARIED.items() for value in values]
    for (name, other), wanted, phase in product(others, WANTED, PHASES):
        yield name, replace(BASE, restitution=wanted, phase=phase, **other)


def measured(engines: Sequence[str]) -> pd.DataFrame:
    """Return a row for each engine, way and strike; nan where the library went wrong."""
    rows: list[Row] = []
    for engine in engines:
        for way, (varied, asked) in product(WAYS[engine], all_strikes()):
            found = strike(ENGINES[engine], asked, way)
            rows.append(
                {
                    **{"engine": engine, "way": way.name, "varied": COLUMNS.get(varied, "")},
                    **{"wanted": asked.restitution, "phase": asked.phase},
                    **{column: getattr(asked, name) for name, column in COLUMNS.items()},
                    **{"kept_ratio": asked.kept, **found._asdict()},
                }
            )
    return pd.DataFrame(rows)


def lines(rows: pd.DataFrame, measure: Measure) -> pd.DataFrame:
    """Return a line for each engine and way: how far off a measure is at most.

    Parameters
    ----------
    rows : DataFrame
        From `measured`.
    measure : Measure

    Returns
    -------
    DataFrame
        The columns of corners.csv and of rates.csv.
    """
    table = []
    for (engine, name), group in rows.groupby(["engine", "way"], sort=False):
        off = (group[measure.found] - group[measure.right]).abs()
        off = off.where(group["corner_ratio"] < BROKEN, math.inf)
        usual = group["varied"] == ""
        names = {"": "off"} | {column: f"off_{column}" for column in COLUMNS.values()}
        mine = {column: off[group["varied"] == varied].max() for varied, column in names.items()}
        literal = next(way.literal for way in WAYS[str(engine)] if way.name == name)
        table.append(
            {
                **{"engine": engine, "way": name, **mine, "off_over_all": off.max()},
                "broken": int((off == math.inf).sum()),
                "slide": group["slide_ratio"].abs()[usual].max(),
                "literal": by_step(partial(literal, SHOWN)),
            }
        )
    return pd.DataFrame(table)
