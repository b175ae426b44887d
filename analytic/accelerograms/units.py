"""What the header of a record says of its unit and of its quantity, and what leaves a doubt."""

import re
from collections.abc import Iterable, Mapping
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from analytic.accelerograms.text import MOST_SAMPLES, shown, too_long
from analytic.block import GRAVITY
from analytic.motion import FloatArray

Units = Literal["g", "mg", "m/s2", "cm/s2", "mm/s2", "gal"]

UNITS: Mapping[str, float] = {
    "g": GRAVITY,
    "mg": 1e-3 * GRAVITY,
    "m/s2": 1.0,
    "cm/s2": 0.01,
    "mm/s2": 1e-3,
    "gal": 0.01,
}
"""Unit of acceleration -> m/s2; g is that of the blocks, so that what lifts one is g tan alpha."""

STATED = re.compile(
    r"\bunits?\b(?:\s*(?:\b(?:of|in|is|are)\b|[:=]))*\s*[(\[]?\s*([^\s,;)\]]*[^\s,;)\].:])"
    r"|(?:[(\[_]|\bin\s|\ba(?:g|cc\w*)?/)\s*((?:%g|m?g|gal|(?:[mc]?m|ft|in)/s2?)(?![\w/*%]))"
)
"""What follows the word units, and a unit in brackets, after an underscore or after the word in."""

QUANTITIES = {
    "acceleration": re.compile(r"accel|\bacc(?![a-z])", re.IGNORECASE),
    "velocity": re.compile(r"veloc|\bvel(?![a-z])", re.IGNORECASE),
    "displacement": re.compile(r"displ|\bdisp?(?![a-z])", re.IGNORECASE),
}
"""Quantity -> how a header names it."""


class Sampled(NamedTuple):
    """What a file holds: time between samples [s], ground acceleration [m/s2]."""

    dt: float
    samples: FloatArray


def unit_of(header: Mapping[int, str], given: str | None) -> float:
    """Return the unit [m/s2] of a record's samples, which a header states or a user gives.

    Parameters
    ----------
    header : mapping of int to str, its lines by their numbers
    given : str or None, a unit of UNITS

    Raises
    ------
    ValueError
        If it is stated nowhere, or twice, or if the stated one is not of acceleration or not the
        given one.
    """
    stated = {unit: at for at, line in header.items() for unit in _units_in(line)}
    for unit, at in stated.items():
        if unit not in UNITS:
            raise ValueError(f"line {at} states {shown(unit)}; it must be among {', '.join(UNITS)}")
    if len({UNITS[unit] for unit in stated}) > 1:
        words = ", ".join(sorted(stated))
        raise ValueError(f"it names several units, {words}; it must state one")
    if given is None and not stated:
        raise ValueError(f"it does not state its units; units must: {', '.join(UNITS)}")
    unit = next(iter(stated), given or "")
    if given is not None and UNITS[given] != UNITS[unit]:
        raise ValueError(f"it states {unit}; units must not be {given}")
    return UNITS[unit]


def _units_in(line: str) -> Iterable[str]:
    """Yield the units that a line states as UNITS has them: cm/s2 for CM/SEC/SEC or cm s^-2."""
    plain = re.sub(r"\^|\*\*", "", line.lower()).replace("sec", "s").replace("²", "2")
    plain = re.sub(r"\s*/\s*", "/", plain).replace("/s/s", "/s2").replace("gals", "gal")
    plain = re.sub(r"(?<=[mt])[ .·*_]*(?:s-2|/s 2|(?<=_)s2)\b", "/s2", plain)
    return (one or other for one, other in STATED.findall(plain))


def converted(samples: ArrayLike, unit: float, count: int | None = None) -> FloatArray:
    """Return samples in m/s2; what overflows is infinite.

    Parameters
    ----------
    samples : array_like (n,), as they stand in the file
    unit : float, their unit [m/s2]
    count : int, optional, how many the header says there are

    Raises
    ------
    ValueError
        If there are more than a record may have, or not as many as a header says.
    """
    found = np.asarray(samples, dtype=np.float64)
    if found.size > MOST_SAMPLES:
        raise too_long(found.size)
    if count not in (None, found.size):
        raise ValueError(f"it holds {found.size} samples; it must hold the {count} of its header")
    with np.errstate(over="ignore"):
        return np.asarray(unit * found)


def check_quantity(header: Mapping[int, str]) -> None:
    """Raise ValueError if a header speaks of velocity or displacement, unless of acceleration, too.

    One that speaks of both must state a unit of acceleration.
    """
    spoken = {
        quantity: at
        for at, line in header.items()
        for quantity, name in QUANTITIES.items()
        if name.search(line)
    }
    stated = {unit for line in header.values() for unit in _units_in(line)}
    if "acceleration" in spoken and stated & UNITS.keys():
        return
    for quantity in spoken.keys() - {"acceleration"}:
        raise ValueError(f"line {spoken[quantity]} speaks of {quantity}; it must be acceleration")
