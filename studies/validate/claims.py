"""What random cases say, and what was left out of them."""

from typing import NamedTuple

import pandas as pd

from studies.cases.drawn import LEAST_NORMAL, everything
from studies.measures.differences import conditioning_of, scientific
from studies.measures.words import NAMED, gathered, listed, out_of, part

WELL_CONDITIONED = 10.0
"""Below this κ the error of a peak says more about its source than about the case."""


class Census(NamedTuple):
    """How many cases were drawn until enough were kept, and those left out by their force N."""

    drawn: int
    kept: int
    near: int
    lifted: int


def census(seed: int, kept: int) -> Census:
    """Count what was drawn until `kept` cases had a least normal force above LEAST_NORMAL.

    near have one between 0 and that, lifted a negative one: their pivot would have to be held down.
    """
    forces: list[float] = []
    found = 0
    for _, normal in everything(seed):
        if found == kept:
            break
        forces.append(normal)
        found += normal > LEAST_NORMAL
    near = sum(0.0 < normal <= LEAST_NORMAL for normal in forces)
    return Census(len(forces), found, near, len(forces) - found - near)


def first_claim(compared: pd.DataFrame) -> str:
    """Say what each source gets right, and its largest error over κ."""
    scaled = (compared["error"].abs() / conditioning_of(compared)).groupby(
        compared["source"], sort=False
    )
    right = [
        (str(source), out_of(int(rows["agrees"].sum()), len(rows)))
        for source, rows in compared.groupby("source", sort=False)
    ]
    return (
        f"Outcomes right on random cases that nothing was tuned on: {gathered(right)}; "
        f"largest errors of the peak {_sizes(scaled.max())}."
    )


def _sizes(largest: "pd.Series[float]") -> str:
    """Return each source's number over κ, or the least and the largest of many."""
    if len(largest) > NAMED:
        by_size = largest.sort_values().items()
        least, *_, most = [f"{scientific(size)} κ ({name})" for name, size in by_size]
        return listed([least, most], "to")
    return f"{listed([scientific(size) for size in largest])} κ"


def claims(compared: pd.DataFrame, counted: Census) -> str:
    """Say what was asked, what each source got right of it, and what was not asked."""
    words = [_of_source(str(name), rows) for name, rows in compared.groupby("source", sort=False)]
    return (
        f"On {counted.kept} random cases: {'; '.join(words)}. They are what is left of "
        f"{counted.drawn} drawn where the normal force stays above {LEAST_NORMAL:g} of the weight: "
        f"in {counted.near} others it falls below that, and in {counted.lifted} below zero, so "
        "that its pivot would have to be held down; nobody was asked about those."
    )


def _of_source(source: str, rows: pd.DataFrame) -> str:
    """Return outcomes, the largest error where κ is small, and the largest over κ."""
    kappa, errors = conditioning_of(rows), rows["error"].abs()
    calm = errors[kappa < WELL_CONDITIONED]
    return (
        f"{source} gets {out_of(int(rows['agrees'].sum()), len(rows))} outcomes right, peaks "
        f"to {part(float(errors.median()))} in the median and {part(float(calm.max()))} at most "
        f"where κ < {WELL_CONDITIONED:g} ({len(calm.dropna())} peaks); over κ to "
        f"{scientific(float((errors / kappa).max()))} at most"
    )
