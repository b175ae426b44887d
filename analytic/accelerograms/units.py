"""What the header of a record says of its unit and of its quantity, and what leaves a doubt."""

import re
from collections.abc import Iterable, Mapping, Sequence
from typing import Literal, NamedTuple

import numpy as np

from analytic.accelerograms.text import shown
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

WORD = (
    r"(?:%g|m?g|gals?|(?:[mc]?m|ft|in)\s*/\s*s(?:ec)?\s*(?:/\s*s(?:ec)?|(?:\^|\*\*)?[2²])?"
    r"|(?:[mc]?m|ft)(?:[ .·*]?s\^?-2)?)(?![\w/^*²%])"
)
"""A unit of acceleration, velocity or displacement, as headers write it."""

STATED = re.compile(rf"(?:[(\[_]\s*|\bin\s+)({WORD})", re.IGNORECASE)
"""A unit in brackets, after an underscore or after the word in."""

UNITS_OF = re.compile(
    r"\bunits?\b(?:\s+(?:of|in|is|are)\b|\s*[:=])*\s*[(\[]?\s*" rf"({WORD}|[^\s,;)\]]+)",
    re.IGNORECASE,
)
"""What follows the word units, a unit or not."""

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


class Line(NamedTuple):
    """A line of a header, and its number in the file."""

    number: int
    text: str


def plain_unit(word: str) -> str:
    """Return a unit as UNITS writes it, as in cm/s2 for CM/SEC/SEC or cm s^-2."""
    word = re.sub(r"[\s^]|\*\*", "", word.lower()).rstrip(".:").replace("²", "2")
    word = re.sub(r"(?<=m|t)[.·*]?s-2$", "/s2", word.replace("sec", "s"))
    return re.sub(r"/s/s$", "/s2", word).replace("gals", "gal")


def is_unit(word: str) -> bool:
    """Whether a word is a unit of acceleration, velocity or displacement."""
    return bool(re.fullmatch(WORD, word.strip(), re.IGNORECASE))


def numbered(lines: Sequence[str], end: int) -> list[Line]:
    """Return the lines before an index, numbered as an editor does."""
    return [Line(at, text) for at, text in enumerate(lines[:end], start=1)]


def unit_of(header: Sequence[Line], given: str | None) -> float:
    """Return the unit [m/s2] that a header states, or that was given.

    Raises
    ------
    ValueError
        If it is stated nowhere, or twice, or if the stated one is not of acceleration or not the
        given one.
    """
    stated = {unit: line for line in header for unit in _units_in(line.text)}
    for unit, line in stated.items():
        if unit not in UNITS:
            allowed = ", ".join(UNITS)
            raise ValueError(f"line {line.number} states {shown(unit)}; it must be among {allowed}")
    if len({UNITS[unit] for unit in stated}) > 1:
        words = ", ".join(sorted(stated))
        raise ValueError(f"it names several units, {words}; it must state one")
    if given is None and not stated:
        raise ValueError(f"it does not state its units; units must: {', '.join(UNITS)}")
    for unit in stated:
        if given is not None and UNITS[given] != UNITS[unit]:
            raise ValueError(f"it states {unit}; units must not be {given}")
    return UNITS[next(iter(stated), given or "")]


def converted(samples: Sequence[float], unit: float) -> FloatArray:
    """Return samples [m/s2] from their unit [m/s2]; what overflows is infinite."""
    with np.errstate(over="ignore"):
        return unit * np.array(samples)


def _units_in(text: str) -> Iterable[str]:
    """Yield the units that a line states; one of length may be of something else, as a depth."""
    for word in UNITS_OF.findall(text):
        yield plain_unit(word)
    speaks = any(name.search(text) for name in QUANTITIES.values())
    for word in STATED.findall(text):
        if (unit := plain_unit(word)) in UNITS or speaks:
            yield unit


def check_quantity(header: Sequence[Line]) -> None:
    """Raise ValueError if a header speaks of velocity or displacement, unless of acceleration, too.

    One that speaks of both must state a unit of acceleration.
    """
    spoken = {
        quantity: line
        for line in header
        for quantity, name in QUANTITIES.items()
        if name.search(line.text)
    }
    accelerations = spoken.pop("acceleration", None)
    stated = {unit for line in header for unit in _units_in(line.text)}
    if accelerations and stated & UNITS.keys():
        return
    for quantity, line in spoken.items():
        raise ValueError(f"line {line.number} speaks of {quantity}; it must be acceleration")
