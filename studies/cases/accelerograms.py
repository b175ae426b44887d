"""Recorded accelerograms as a command takes them: read, corrected, refused in one line."""

import re
from pathlib import Path
from typing import Literal

import numpy as np

from analytic.record import Record
from studies.cases.refusal import BadInputError

Baseline = Literal["none", "constant", "linear"]
"""How a record is corrected: not at all, or by what its samples lose."""


def read_record(
    path: Path,
    units: str | None = None,
    baseline: Baseline | None = None,
    dt: float | None = None,
    *,
    insist: bool = True,
    option: str = "--record",
) -> Record:
    """Read a recorded ground acceleration [m/s2], as `Record.read` does, and correct it."""
    try:
        record = Record.read(path, units, dt, insist=insist)
    except ValueError as error:
        problem = re.sub(r"; units(?= must)", "; --units", str(error).removeprefix("path"))
        problem = re.sub(r"; dt(?=,| must not)", "; --record-dt", problem)
        raise BadInputError(f"{option}{problem}") from error
    try:
        if baseline == "constant" or baseline == "linear":
            record = record.detrended(baseline)
    except ValueError as error:
        raise BadInputError(f"{option} is {str(path)!r}; {error}") from error
    if record.peak == 0.0:
        raise BadInputError(f"{option} is {str(path)!r}; it is zero throughout, and must not be")
    return record


def baseline_note(record: Record, baseline: str | None) -> str:
    """Say how a record was corrected, and what velocity it leaves the base with, if any."""
    words = [] if baseline in (None, "none") else [f"baseline corrected by detrend, {baseline}"]
    largest = float(np.abs(record.velocity(record.breakpoints)).max())
    if abs(record.final_velocity) > 1e-6 * largest:  # less is rounding
        part = abs(record.final_velocity) / largest
        words.append(
            f"the record's velocity ends at {record.final_velocity:.3g} m/s, {part:.2g} of its "
            "largest, and the base keeps it" + ("" if words else "; --baseline corrects it")
        )
    return "; ".join(words)
