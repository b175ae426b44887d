"""Which block overturns first: the lines of a list in the order of their margins, and in words."""

from __future__ import annotations

import math
import shlex
from collections.abc import Mapping, Sequence
from typing import Any

import pandas as pd

from studies.measures.words import capital, listed, out_of
from studies.sources.registry import resolve

NEAR = 0.01
"""An answer hangs on its amplitude where its scale is so near to the margin, relative to it."""


def ranked(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each block and record, the least margin of a block first.

    Parameters
    ----------
    rows : DataFrame
        The columns of blocks.csv.
    """
    lines = rows.drop_duplicates(["name", "record"])
    least = lines.groupby("name")["margin"].transform("min")
    order = lines.assign(least=least, place=range(len(lines)))
    by = ["least", "name", "margin", "place"]
    return order.sort_values(by, kind="stable").drop(columns=["least", "place"])


def first_words(lines: pd.DataFrame) -> str:
    """Say how many blocks overturn under a record as strong as it is or less, and which first."""
    blocks = lines["name"].nunique()
    fallen = lines.loc[lines["margin"] <= 1.0, "name"].nunique()
    finite = lines[lines["margin"].map(math.isfinite)]
    if finite.empty:
        return f"None of {blocks} blocks was found to overturn under any factor on a record"
    first = finite.iloc[0]
    words = f"{out_of(fallen, blocks)} blocks overturn under a record as it is, or weaker"
    return (
        f"{capital(words)}; "
        f"the first is {first['name']}, at {first['margin']:.4g} times {first['record']}"
    )


def counted(rows: pd.DataFrame) -> list[str]:
    """Say for each scale and source how many cases end in which way."""
    said = []
    for (scale, source), group in rows.groupby(["scale", "source"], sort=False):
        counts = group["outcome"].value_counts()
        words = [f"{count} {outcome}" for outcome, count in counts.items()]
        said.append(f"at scale {scale:g} {source} has {listed(words)}")
    return said


def doubts(rows: pd.DataFrame) -> list[str]:
    """Say how many blocks slide or lift off the pivot, and how many answers hang on a hundredth."""
    cases = rows.drop_duplicates(["name", "record", "scale"])
    near = (cases["scale"] / cases["margin"] - 1.0).abs() < NEAR
    words = {
        "slide, for they need more friction than they have": cases["friction"]
        < cases["friction_needed"],
        "would lift their pivot off, where no answer holds": cases["min_normal"] < 0.0,
        f"are within {100.0 * NEAR:g} % of the factor that first overturns them": near,
    }
    return [f"{int(where.sum())} of {len(cases)} {what}" for what, where in words.items()]


def command_of(line: Mapping[Any, Any], sources: Sequence[str], settings: Mapping[str, str]) -> str:
    """Return the command that compares the sources on a case of the list."""
    engines = any(resolve(name).engine for name in sources)
    asked = ("width", "width_m"), ("height", "height_m"), ("scale", "scale"), ("tilt", "tilt")
    values = {name: line[column] for name, column in asked}
    values["friction"] = line["friction"] if engines else math.nan
    known = {name: value for name, value in values.items() if not math.isnan(value)}
    known |= {name: word for name, word in settings.items() if word}
    said = " ".join(f"--{name} {value}" for name, value in known.items())
    record = shlex.quote(str(line["record"]))
    return f"rocking compare {said} --record {record} --sources {' '.join(sources)}"
