"""What was found of restitution, in words and as a table."""

from __future__ import annotations

import math

import pandas as pd

from studies.measures.words import listed
from studies.restitution.strikes import BASE, COLUMNS, PHASES, VARIED
from studies.restitution.ways import SHOWN

GOOD = 0.05
"""A coefficient that comes out within this is kept."""

USUAL = f"{BASE.step:g}/p, {BASE.rate:g} α p, {BASE.height:g} m and H/B {BASE.aspect:g}"
"""From which one thing at a time is varied."""


def _ranges(words: str) -> str:
    """Return from where to where things are varied; words name them in their order."""
    ends = [(*values, getattr(BASE, name)) for name, values in VARIED.items()]
    parts = zip(words.split(", "), ends, strict=True)
    return listed([word.format(f"{min(e):.2g} to {max(e):.2g}") for word, e in parts])


RANGES = _ranges("steps of {}/p, rates of {} α p, heights of {} m, H/B of {}")
"""Over what strikes are varied."""


def findings_text(corners: pd.DataFrame, rates: pd.DataFrame) -> str:
    """Return both tables as text."""
    return f"""\
A block turns about one corner and strikes its base with the other. Largest difference of
that corner's speed upwards over that of its approach from the coefficient that is wanted,
0 to 1, at {USUAL}, wherever in a step the
impact falls ({len(PHASES)} places); over
{RANGES};
and the corner's largest speed along the base, over the same. DT is the step in seconds:
{_by_engine(corners, quoted=True)}

Largest difference of the angular rate of the block after over before from
1 - 3/2 (1 + e) sin^2(alpha), of the same strikes:
{_by_engine(rates)}"""


def _by_engine(lines: pd.DataFrame, *, quoted: bool = False) -> str:
    """Return how far off each way is, below the name of its engine, and what is set."""
    over = dict(zip(COLUMNS.values(), ("steps", "rates", "heights", "slenderness"), strict=True))
    parts = []
    for engine, group in lines.groupby("engine", sort=False):
        parts.append(str(engine))
        for row in group.to_dict("records"):
            varied = ", ".join(f"{word} {_off(row[f'off_{name}'])}" for name, word in over.items())
            broken = f"; {row['broken']} strikes broken" if row["broken"] else ""
            slide = f"; along {_off(row['slide'])}" if quoted else ""
            parts.append(f"  {row['way']}: {_off(row['off'])}; over {varied}{slide}{broken}")
            if quoted:
                parts.append(f"    for {SHOWN:g}: {row['literal']}")
    return "\n".join(parts)


def _off(value: float) -> str:
    return "broken" if value == math.inf else f"{value:.3f}"


def best_of(corners: pd.DataFrame, by: str = "off_over_all") -> pd.DataFrame:
    """Return the way of each engine that is off least in a column."""
    return corners.loc[corners.groupby("engine", sort=False)[by].idxmin()]


def first_claim(corners: pd.DataFrame) -> str:
    """Say how well the engines keep a coefficient at best, and who does not as first asked."""
    best = best_of(corners)
    first = corners.drop_duplicates("engine")
    lost = list(first.loc[first["off"] > 10.0 * GOOD, "engine"])
    beside = f"; asked in the first way that comes to mind, {listed(lost)} miss it" if lost else ""
    return (
        "Of a coefficient of restitution from 0 to 1 a block that strikes with a corner keeps, "
        f"with each engine's best setting, all but {_ends(best, 'off_over_all')} over {RANGES}, "
        f"and all but {_ends(best, 'off')} at {USUAL}{beside}."
    )


def _ends(best: pd.DataFrame, column: str) -> str:
    """Return the least and the largest of a column, and of which engine."""
    ends = best.sort_values(column).iloc[[0, -1]].to_dict("records")
    return " to ".join(dict.fromkeys(f"{_off(row[column])} in {row['engine']}" for row in ends))
