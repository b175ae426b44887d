"""Where PyBullet's extension keeps the clients that Python connects: no function of it tells.

Its file does, as to a debugger, in the table of symbols; a build without one is left alone.
"""

from pathlib import Path
from typing import Any

import numpy as np

BEGINNING = b"\x7fELF\x02\x01"
"""Of a file of 64 bits and little endian."""

START, COUNT = (0x28, "<u8"), (0x3C, "<u2")
"""Where its header says at which byte its sections are described, and how many there are."""

SECTION = np.dtype(
    [
        *(("name", "<u4"), ("kind", "<u4"), ("flags", "<u8"), ("address", "<u8"), ("at", "<u8")),
        *(("size", "<u8"), ("link", "<u4"), ("info", "<u4"), ("align", "<u8"), ("entry", "<u8")),
    ]
)
SYMBOL = np.dtype(
    [
        *(("name", "<u4"), ("info", "u1"), ("other", "u1"), ("section", "<u2")),
        *(("value", "<u8"), ("size", "<u8")),
    ]
)
SYMBOLS = 2
"""Kind of the section that holds all symbols."""


def spans(file: Path, *names: str) -> list[tuple[int, int]]:
    """Return where variables and functions stand in a shared library, and how many bytes they take.

    Parameters
    ----------
    file : Path
        The library.
    names : str
        As they were linked.

    Raises
    ------
    ValueError
        If it is no such file, or does not name each of them once.
    """
    data = np.memmap(file, mode="r")
    if data[: len(BEGINNING)].tobytes() != BEGINNING:
        raise ValueError(f"{file.name} is no ELF file of 64 bits")
    start, count = (int(np.frombuffer(data, kind, 1, at)[0]) for at, kind in (START, COUNT))
    sections = data[start : start + count * SECTION.itemsize].view(SECTION)
    (table,) = sections[sections["kind"] == SYMBOLS]
    symbols = _inside(data, table).view(SYMBOL)
    words = _inside(data, sections[table["link"]]).tobytes()
    found = []
    for name in names:
        (symbol,) = symbols[symbols["name"] == words.index(f"\0{name}\0".encode()) + 1]
        found.append((int(symbol["value"]), int(symbol["size"])))
    return found


def _inside(data: Any, section: Any) -> Any:
    return data[int(section["at"]) : int(section["at"] + section["size"])]
