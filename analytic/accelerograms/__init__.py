"""Recorded accelerograms: PEER's AT2 files, ESM's ASC files, tables of time and acceleration.

A file that leaves a doubt is refused: nothing is filled in, thinned or guessed.
"""

from collections.abc import Sequence
from pathlib import Path

from analytic.accelerograms.asc import read as read_asc
from analytic.accelerograms.at2 import read as read_at2
from analytic.accelerograms.foreign import refuse
from analytic.accelerograms.table import read as read_table
from analytic.accelerograms.text import lines_of
from analytic.accelerograms.units import UNITS, Sampled

OTHER_SUFFIXES = (".vt2", ".dt2")
"""Of PEER's files of velocity and of displacement."""


def read(path: Path, units: str | None) -> Sampled:
    """Read a file; `analytic.Record.read` says which.

    Raises
    ------
    ValueError
        As there, without the name of the file.
    """
    if units is not None and units not in UNITS:
        raise ValueError(f"units must be among {', '.join(UNITS)}, not {units!r}")
    if path.suffix.lower() in OTHER_SUFFIXES:
        raise ValueError("it must be a file of acceleration, as AT2 files are")
    return _read(lines_of(path), units)


def _read(lines: Sequence[str], units: str | None) -> Sampled:
    for reader in (read_asc, read_at2):
        if sampled := reader(lines, units):
            return sampled
    refuse(lines)
    return read_table(lines, units)
