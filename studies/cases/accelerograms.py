"""Recorded accelerograms as a command takes them: read, corrected, refused in one line."""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from analytic.accelerograms.units import UNITS, Units
from analytic.record import Record
from studies.cases.refusal import BadInputError

__all__ = ["UNITS", "Baseline", "Units", "baseline_note", "read_record", "recorded"]

Baseline = Literal["none", "constant", "linear"]
"""How a record is corrected: not at all, or by what its samples lose."""

DRIFT = 1e-6
"""Part of its largest velocity up to which a base that comes to rest may miss it, by rounding."""


def read_record(
    path: Path,
    units: str | None = None,
    baseline: Baseline | None = None,
    argument: str = "--record",
) -> Record:
    """Read a recorded ground acceleration [m/s2], as `Record.read` does, and correct it.

    Parameters
    ----------
    path : Path
    units : str, optional
        One of UNITS; needed where the file does not state its own.
    baseline : {"none", "constant", "linear"}, optional
        What is taken away: nothing, the mean, or the line that fits best.
    argument : str, optional
        What a refusal names.

    Raises
    ------
    BadInputError
        If it cannot be read, or is nothing but its trend.
    """
    try:
        record = Record.read(path, units)
    except ValueError as error:
        problem = str(error).removeprefix("path").replace("; units must", "; --units must")
        raise BadInputError(f"{argument}{problem}") from error
    if baseline is None or baseline == "none":
        return record
    try:
        return record.detrended(baseline)
    except ValueError as error:
        raise BadInputError(f"{argument} is {str(path)!r}; {error}") from error


def recorded(
    paths: Sequence[Path], units: str | None, baseline: Baseline | None, argument: str
) -> list[Record]:
    """Read records that move, in the order of their paths.

    Parameters
    ----------
    paths : sequence of Path
    units, baseline, argument
        As for `read_record`.

    Raises
    ------
    BadInputError
        Also if one is zero throughout.
    """
    records = [read_record(path, units, baseline, argument) for path in paths]
    for path, record in zip(paths, records, strict=True):
        if record.peak == 0.0:
            words = "it is zero throughout, and must not be"
            raise BadInputError(f"{argument} is {str(path)!r}; {words}")
    return records


def baseline_note(record: Record, baseline: str | None) -> str:
    """Say how a record was corrected, and what velocity it leaves the base with.

    Parameters
    ----------
    record : Record
        As it is used: corrected, and scaled.
    baseline : {"none", "constant", "linear"} or None
        How it was corrected.

    Returns
    -------
    str
        Empty where it is as it was read, and comes to rest up to DRIFT of its largest velocity.
    """
    words = [] if baseline in (None, "none") else [f"baseline corrected by detrend, {baseline}"]
    largest = float(np.abs(record.velocity(record.breakpoints)).max())
    if abs(record.final_velocity) > DRIFT * largest:
        part = abs(record.final_velocity) / largest
        words.append(
            f"the record's velocity ends at {record.final_velocity:.3g} m/s, {part:.2g} of its "
            "largest, and the base keeps it" + ("" if words else "; --baseline corrects it")
        )
    return "; ".join(words)
