"""Recorded accelerograms: PEER's AT2 files, ESM's ASC files, tables of time and acceleration.

A file that leaves a doubt is refused: nothing is filled in, thinned or guessed.
"""

import re
from pathlib import Path

from analytic.accelerograms.asc import read as read_asc
from analytic.accelerograms.at2 import read as read_at2
from analytic.accelerograms.table import read as read_table
from analytic.accelerograms.text import lines_of
from analytic.accelerograms.units import UNITS, Sampled

FOREIGN = {
    "COSMOS": r".*\(Format v[\d.]+ with \d+ text lines",
    "SMC": r"[12] (UN)?CORRECTED ACCELEROGRAM|\*\s*$",
    "CSMIP": r"(UN)?CORRECTED ACCELEROGRAM|RESPONSE AND FOURIER",
    "K-NET": r"Origin Time\s+\d",
}
"""Format that is not read -> how its first line begins."""


def read(path: Path, units: str | None) -> Sampled:
    """Read a file; `analytic.Record.read` says which.

    Parameters
    ----------
    path : Path
    units : str or None, a unit of UNITS for a file that states none

    Raises
    ------
    ValueError
        As by `analytic.Record.read`, without the name of the file.
    """
    if units is not None and units not in UNITS:
        raise ValueError(f"units must be among {', '.join(UNITS)}, not {units!r}")
    if path.suffix.lower() in (".vt2", ".dt2"):
        raise ValueError("it must be a file of acceleration, as AT2 files are")
    lines = lines_of(path)
    if sampled := read_asc(lines, units) or read_at2(lines, units):
        return sampled
    first = next((line.strip() for line in lines if line.strip()), "")
    for name, begins in FOREIGN.items():
        if re.match(begins, first, re.IGNORECASE):
            raise ValueError(
                f"it is a {name} file, which is not read; it must be a PEER AT2 or an ESM ASC file,"
                " or a table of two columns, time [s] and acceleration, made from it, for instance"
                " with gmprocess"
            )
    return read_table(lines, units)
