"""Formats that are not read, known by their first line."""

import re
from collections.abc import Sequence

FORMATS = {
    "COSMOS": re.compile(r".*\(Format v[\d.]+ with \d+ text lines", re.IGNORECASE),
    "SMC": re.compile(r"[12] (UN)?CORRECTED ACCELEROGRAM|\*\s*$", re.IGNORECASE),
    "CSMIP": re.compile(r"(UN)?CORRECTED ACCELEROGRAM|RESPONSE AND FOURIER", re.IGNORECASE),
    "K-NET": re.compile(r"Origin Time\s+\d", re.IGNORECASE),
}
"""Name -> how the file begins."""


def refuse(lines: Sequence[str]) -> None:
    """Raise ValueError if the lines are of one of these formats."""
    first = next((line.strip() for line in lines if line.strip()), "")
    for name, begins in FORMATS.items():
        if begins.match(first):
            raise ValueError(
                f"it is a {name} file, which is not read; it must be a PEER AT2 or an ESM ASC file,"
                " or a table of two columns, time [s] and acceleration, made from it, for instance"
                " with gmprocess"
            )
