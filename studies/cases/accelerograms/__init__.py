"""Recorded accelerograms: PEER's AT2 files, ESM's ASC files, tables of time and acceleration.

A file that leaves a doubt is refused with one line: nothing is filled in, thinned or guessed.
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from analytic.record import Record
from studies.cases.accelerograms import asc, at2, foreign, table
from studies.cases.accelerograms.text import lines_of
from studies.cases.accelerograms.units import UNITS, Units
from studies.cases.refusal import BadInputError

__all__ = ["UNITS", "Baseline", "Units", "baseline_note", "corrected", "read_record", "recorded"]

Baseline = Literal["none", "constant", "linear"]
"""How a record is corrected: not at all, or by what its samples lose."""


DRIFT = 1e-6
"""Part of its largest velocity up to which a base that comes to rest may miss it, by rounding."""

OTHER_SUFFIXES = (".vt2", ".dt2")
"""Of PEER's files of velocity and of displacement."""


def read_record(path: Path, units: str | None = None, argument: str = "--record") -> Record:
    """Read a recorded ground acceleration.

    Parameters
    ----------
    path : Path
        A PEER AT2 file, known by a header that says NPTS and DT; an ASC file of ESM or ITACA; or a
        table of two columns, time [s] and acceleration, separated by commas, semicolons or blanks,
        with or without a line of names, comments beginning with # or %. The first time becomes
        zero.
    units : str, optional
        One of UNITS; needed where the file does not state its own.
    argument : str, optional
        What a refusal names.

    Raises
    ------
    BadInputError
        If the file cannot be read or is of another format, its units are not known, a number is not
        finite, the count is not the stated one, steps are missing or not equal, or anything else in
        it leaves a doubt.
    """
    try:
        if path.suffix.lower() in OTHER_SUFFIXES:
            raise ValueError("it must be a file of acceleration, as AT2 files are")
        return _read(lines_of(path), units)
    except ValueError as problem:
        raise BadInputError(f"{argument} is {str(path)!r}; {problem}") from problem


def _read(lines: Sequence[str], units: str | None) -> Record:
    for read in (asc.read, at2.read):
        if record := read(lines, units):
            return record
    foreign.refuse(lines)
    return table.read(lines, units)


def corrected(record: Record, baseline: Baseline | None) -> Record:
    """Return a record without its mean or its linear trend, or as it is."""
    if baseline is None or baseline == "none":
        return record
    return record.detrended(baseline)


def recorded(
    paths: Sequence[Path],
    units: str | None,
    baseline: Baseline | None = None,
    argument: str = "--records",
) -> list[Record]:
    """Read records, all of the same units where they state none, and correct them.

    Raises
    ------
    BadInputError
        If one cannot be read, does not move, or is nothing but its trend.
    """
    motions = []
    for path in paths:
        motion = read_record(path, units, argument)
        if motion.peak == 0.0:
            raise BadInputError(
                f"{argument} is {str(path)!r}; it is zero throughout, and must not be"
            )
        try:
            motions.append(corrected(motion, baseline))
        except ValueError as error:
            raise BadInputError(f"{argument} is {str(path)!r}; {error}") from error
    return motions


def baseline_note(record: Record, baseline: str | None) -> str:
    """Say how a record was corrected, and what velocity it leaves the base with; or nothing."""
    words = [] if baseline in (None, "none") else [f"baseline corrected by detrend, {baseline}"]
    largest = float(np.abs(record.velocity(record.breakpoints)).max())
    if abs(record.final_velocity) > DRIFT * largest:
        part = abs(record.final_velocity) / largest
        words.append(
            f"the record's velocity ends at {record.final_velocity:.3g} m/s, {part:.2g} of its "
            "largest, and the base keeps it" + ("" if words else "; --baseline corrects it")
        )
    return "; ".join(words)
