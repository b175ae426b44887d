"""Blocks that strike their base with a corner, one thing varied at a time, and what they keep."""

import math
from collections.abc import Sequence

import pandas as pd

from engines import ENGINES
from engines.run.strike import Strike, strike
from studies.kit.journal import Row
from studies.restitution.asked import one_at_a_time

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


def measured(engines: Sequence[str]) -> pd.DataFrame:
    """Return a row for each engine, way and strike; nan where the library went wrong."""
    rows: list[Row] = []
    for engine in engines:
        for way in ENGINES[engine].bouncing:
            if way.block is None:
                continue
            for varied, asked in one_at_a_time(BASE, VARIED):
                found = strike(ENGINES[engine], asked, way.block(asked.restitution))
                rows.append(
                    {
                        **{"engine": engine, "way": way.name, "varied": COLUMNS.get(varied, "")},
                        **{"wanted": asked.restitution, "phase": asked.phase},
                        **{column: getattr(asked, name) for name, column in COLUMNS.items()},
                        "kept_ratio": asked.kept,
                        **found._asdict(),
                    }
                )
    return pd.DataFrame(rows)


def struck(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and way: how far off what blocks keep is at most.

    Parameters
    ----------
    rows : DataFrame
        From `measured`.

    Returns
    -------
    DataFrame
        engine, way; off: the largest difference of the ratio of rates from that of the theory,
        wherever in a step the impact falls; off_p_dt, ...: the same over what is varied;
        off_over_all: the largest of these; corner:
        the largest difference of the corner's ratio of speeds from what is wanted; slide: the
        largest speed of the corner along the base, over that of its approach.
    """
    table = []
    for (engine, way), group in rows.groupby(["engine", "way"], sort=False):
        off = (group["rate_ratio"] - group["kept_ratio"]).abs().fillna(math.inf)
        corner = (group["corner_ratio"] - group["wanted"]).abs().fillna(math.inf)
        usual = group["varied"] == ""
        names = {"": "off", **{name: f"off_{name}" for name in COLUMNS.values()}}
        mine = {column: off[group["varied"] == name].max() for name, column in names.items()}
        slide = group["slide_ratio"].abs()[usual].max()
        table.append(
            {
                **{"engine": engine, "way": way, **mine, "off_over_all": off.max()},
                **{"corner": corner[usual].max(), "slide": slide},
            }
        )
    return pd.DataFrame(table)
