"""Recorded accelerograms: PEER's AT2 files, and tables of time and acceleration.

A file that leaves a doubt is refused with one line: nothing is filled in, thinned or guessed.
"""

import itertools
import math
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from analytic.block import STANDARD_GRAVITY
from analytic.record import Record
from studies.kit.arguments import BadInputError

Units = Literal["g", "m/s2", "cm/s2", "gal"]

UNITS: Mapping[str, float] = {"g": STANDARD_GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "gal": 0.01}
"""Unit of acceleration -> m/s2."""

UNEVEN = 0.03
"""Part of a step by which a printed time may miss its place: what four decimals do to 256 Hz."""

COUNT_FIRST = re.compile(r"^\s*(\d+)\s+([\d.eE+-]+)\s+NPTS\s*,\s*DT", re.IGNORECASE)
COUNT_NAMED = re.compile(r"NPTS\s*=\s*(\d+)\s*,\s*DT\s*=\s*([\d.eE+-]+)", re.IGNORECASE)
"""The last line of the header of an AT2 file, as it was and as it is."""

STATED = re.compile(
    r"(?:[(\[_]|\bunits?\b\s*(?:of|in|:|=)?\s*)"
    r"(cm/s(?:ec)?(?:\^?[2²]|/s(?:ec)?)|m/s(?:ec)?(?:\^?[2²]|/s(?:ec)?)|gal|g)(?=[\s)\],;]|$)",
    re.IGNORECASE,
)
"""A unit as a header states it: in brackets, after an underscore, or after the word units."""


def read_record(path: Path, units: str | None = None, argument: str = "--record") -> Record:
    """Read a recorded ground acceleration.

    Parameters
    ----------
    path : Path
        A PEER AT2 file, known by the line of its header that says NPTS and DT; or a table of two
        columns, time [s] and acceleration, separated by commas, semicolons or blanks, with or
        without a line of names, comments beginning with # or %. The first time becomes zero.
    units : str, optional
        One of UNITS; needed where the file does not state its own.
    argument : str, optional
        What a refusal names.

    Raises
    ------
    BadInputError
        If the file cannot be read, its units are not known, a number is not finite, the count is
        not the stated one, or steps are missing or not equal.
    """
    try:
        lines = path.read_text(encoding="utf-8-sig", errors="replace").splitlines()
    except OSError as error:
        raise _refused(
            argument, path, f"it must be a file that can be read ({error.strerror})"
        ) from error
    try:
        for number, line in enumerate(lines):
            if found := COUNT_NAMED.search(line) or COUNT_FIRST.match(line):
                return _peer(lines, number, int(found[1]), float(found[2]), units)
        return _table(lines, units)
    except ValueError as problem:
        raise _refused(argument, path, str(problem)) from problem


def _refused(argument: str, path: Path, problem: str) -> BadInputError:
    return BadInputError(f"{argument} is {str(path)!r}; {problem}")


def _peer(lines: Sequence[str], last: int, count: int, dt: float, units: str | None) -> Record:
    unit = _unit(" ".join(line for line in lines[: last + 1] if "UNITS" in line.upper()), units)
    numbered = enumerate(lines[last + 1 :], start=last + 2)
    samples = [_number(word, at) for at, line in numbered for word in line.split()]
    if len(samples) != count:
        raise ValueError(f"it holds {len(samples)} samples; it must hold the {count} of its header")
    return _record(dt, samples, unit)


def _table(lines: Sequence[str], units: str | None) -> Record:
    names = ""
    rows: list[tuple[int, float, float]] = []
    for at, line in enumerate(lines, start=1):
        words = line.replace(",", " ").replace(";", " ").split()
        if not words or words[0][0] in "#%" or not (rows or _is_number(words[0])):
            names += f" {line}"
        elif len(words) != 2:
            columns = f"line {at} has {len(words)} columns"
            raise ValueError(f"{columns}; it must have two, time and acceleration")
        else:
            rows.append((at, _number(words[0], at), _number(words[1], at)))
    if len(rows) < 2:
        raise ValueError(f"it has {len(rows)} rows of numbers; it must have two or more")
    return _record(_step(rows), [row[2] for row in rows], _unit(names, units))


def _step(rows: Sequence[tuple[int, float, float]]) -> float:
    """Return the step [s] of equally spaced times."""
    steps = sorted(b[1] - a[1] for a, b in itertools.pairwise(rows))
    usual = steps[len(steps) // 2]
    for (_, before, _), (at, time, _) in itertools.pairwise(rows):
        ratio = (time - before) / usual if usual > 0.0 else 0.0
        if ratio <= 0.0:
            raise ValueError(f"line {at}: the time {time:g} s must be later than {before:g} s")
        if ratio > 1.5:
            raise ValueError(
                f"line {at}: a gap from {before:g} to {time:g} s; steps must all be {usual:g} s"
            )
    dt = (rows[-1][1] - rows[0][1]) / (len(rows) - 1)
    for place, (at, time, _) in enumerate(rows):
        if abs(time - rows[0][1] - place * dt) > UNEVEN * dt:
            raise ValueError(
                f"line {at}: the time {time:g} s is not a whole number of steps of {dt:g} s after "
                "the first; steps must be equal"
            )
    return dt


def _record(dt: float, samples: Sequence[float], unit: float) -> Record:
    return Record(dt=dt, samples=unit * np.array(samples))


def _unit(header: str, given: str | None) -> float:
    """Return the unit [m/s2] that a header states, or that was given."""
    words = {
        re.sub(r"\^2|²|/s$", "2", word.lower().replace("sec", "s"))
        for word in STATED.findall(header)
    }
    stated = {UNITS[word] for word in words}
    if len(stated) > 1:
        raise ValueError(f"it names several units, {', '.join(sorted(words))}; it must state one")
    if given is None and not stated:
        raise ValueError(f"it does not state its units; --units must: {', '.join(UNITS)}")
    if given is not None and stated and UNITS[given] not in stated:
        raise ValueError(f"it states {words.pop()}; --units must not be {given}")
    return stated.pop() if stated else UNITS[given or ""]


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _number(word: str, line: int) -> float:
    try:
        value = float(word)
    except ValueError:
        raise ValueError(f"line {line}: {word!r} must be a number") from None
    if not math.isfinite(value):
        raise ValueError(f"line {line}: {word} must be a finite number")
    return value
