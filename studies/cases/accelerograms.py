"""Recorded accelerograms as a command takes them: read, corrected, refused in one line."""

from collections.abc import Sequence
from pathlib import Path
from typing import Literal

import numpy as np

from analytic.accelerograms.units import UNITS, Units
from analytic.record import Record
from studies.cases.refusal import BadInputError

__all__ = ["UNITS", "Baseline", "Units", "baseline_note", "corrected", "read_record", "recorded"]

Baseline = Literal["none", "constant", "linear"]
"""How a record is corrected: not at all, or by what its samples lose."""

DRIFT = 1e-6
"""Part of its largest velocity up to which a base that comes to rest may miss it, by rounding."""


def read_record(path: Path, units: str | None = None, argument: str = "--record") -> Record:
    """Read a recorded ground acceleration, as `Record.read` does.

    Parameters
    ----------
    path : Path
    units : str, optional
        One of UNITS; needed where the file does not state its own.
    argument : str, optional
        What a refusal names.

    Raises
    ------
    BadInputError
        Where that raises ValueError.
    """
    try:
        return Record.read(path, units)
    except ValueError as error:
        problem = str(error).removeprefix("path").replace("; units must", "; --units must")
        raise BadInputError(f"{argument}{problem}") from error


def corrected(record: Record, baseline: Baseline | None) -> Record:
    """Return a record without its mean or its linear trend, or as it is.

    Parameters
    ----------
    record : Record
    baseline : {"none", "constant", "linear"} or None
        The mean is taken away, or the line that fits best; None is "none".

    Raises
    ------
    ValueError
        If nothing but rounding is left.
    """
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

    Parameters
    ----------
    paths : sequence of Path
    units : str or None
        One of UNITS; needed where a file does not state its own.
    baseline : {"none", "constant", "linear"}, optional
        As for `corrected`.
    argument : str, optional
        What a refusal names.

    Returns
    -------
    list of Record
        Acceleration [m/s2] over time [s], in the order of the paths.

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
