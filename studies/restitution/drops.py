"""Drops that vary one thing at a time, and what each engine makes of them."""

import math
from collections.abc import Hashable, Sequence
from dataclasses import asdict, replace

import pandas as pd

from engines import ENGINES
from engines.parts.drop import SHOWN, Drop
from studies.kit.journal import Row
from studies.measures.formulas import by_step
from studies.restitution.asked import one_at_a_time

BASE = Drop(restitution=0.0)
"""From which one thing at a time is varied."""

VARIED = {"dt_s": (1e-4, 1 / 240), "speed": (0.1, 10.0), "radius": (0.01, 1.0)}
"""What is varied -> its other values."""

BROKEN = 10.0
"""A sphere that comes back so many times as fast was thrown by a contact that is unstable."""


def measured(engines: Sequence[str]) -> pd.DataFrame:
    """Return a row for each engine, way and drop; no ratio, nan, where the library went wrong."""
    rows: list[Row] = []
    for engine in engines:
        for way in ENGINES[engine].bouncing:
            for varied, drop in one_at_a_time(BASE, VARIED):
                rows.append(
                    {
                        "engine": engine,
                        "way": way.name,
                        "varied": varied,
                        **{_column(name): value for name, value in asdict(drop).items()},
                        "speed_ratio": way.dropped(drop),
                        "literal": way.setting(drop),
                    }
                )
    return pd.DataFrame(rows).drop(columns="gravity_m_s2")


def _column(name: str) -> str:
    units = {"speed": "speed_m_s", "radius": "radius_m", "gravity": "gravity_m_s2"}
    return {"restitution": "wanted", **units}.get(name, name)


def kept(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each engine and way: how far off coefficients are at most.

    Parameters
    ----------
    rows : DataFrame
        From `measured`.

    Returns
    -------
    DataFrame
        engine, way; off: the largest difference of what is found from what is wanted, wherever the
        impact falls in a step; off_dt_s, off_speed, off_radius: the same over what is varied;
        off_over_all: the largest of these; broken: drops that the library did not survive; literal:
        what is set for 0.6, what follows the step being a formula of DT, the step [s].
    """
    table = []
    for (engine, way), group in rows.groupby(["engine", "way"], sort=False):
        off = (group["speed_ratio"] - group["wanted"]).abs()
        off = off.where(group["speed_ratio"] < BROKEN, math.inf)
        names = {"": "off", **{name: f"off_{name}" for name in VARIED}}
        mine = {column: off[group["varied"] == name].max() for name, column in names.items()}
        table.append(
            {
                **{"engine": engine, "way": way, **mine, "off_over_all": off.max()},
                **{
                    "broken": int((off == math.inf).sum()),
                    "literal": _formula(str(engine), str(way)),
                },
            }
        )
    return pd.DataFrame(table)


def _formula(engine: Hashable, name: Hashable) -> str:
    """Return what is set for the coefficient that is quoted, by the step."""
    way = next(way for way in ENGINES[str(engine)].bouncing if way.name == name)
    return by_step(lambda dt_s: way.setting(replace(BASE, restitution=SHOWN, dt_s=dt_s)))
