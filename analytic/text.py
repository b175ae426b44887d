"""A text file of numbers, and its words as numbers, or the reason why it is none."""

import math
import re
import reprlib
import stat
from pathlib import Path

import numpy as np

MOST_SAMPLES = 1_000_000
"""Longest record that is read: 83 minutes at 200 Hz."""

BYTES_PRINTED = 16
"""Bytes of a file for each sample: the width of a column in most of them."""

MOST_BYTES = 4 * BYTES_PRINTED * MOST_SAMPLES
"""Largest file that is read; the factor is for two columns of 17 digits."""

NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
"""A number as programs print it; Python itself also takes 1_000, Arabic digits and NaN."""

PLAIN = re.compile(NUMBER, re.ASCII)
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
CONTROL = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f]")


def lines_of(path: Path) -> list[str]:
    """Return the lines of a text file, without their ends.

    Raises
    ------
    ValueError
        If it is no file that can be read, too large for a record, or holds bytes that are no text.
    """
    content = _content(path).removeprefix(b"\xef\xbb\xbf")
    content = content.replace(b"\r\n", b"\n").replace(b"\r", b"\n")
    try:
        text = content.decode("utf-8")
    except UnicodeDecodeError as error:
        line = content.count(b"\n", 0, error.start) + 1
        problem = f"the byte 0x{content[error.start]:02x} is not text in UTF-8"
        raise ValueError(f"line {line}: {problem}") from error
    if found := CONTROL.search(text):
        line = text.count("\n", 0, found.start()) + 1
        raise ValueError(f"line {line}: {found[0]!r} is not text")
    return text.split("\n")


def _content(path: Path) -> bytes:
    """Return the bytes of a regular file of bearable size; nothing else is opened."""
    kinds = {"d": "a folder", "p": "a named pipe", "s": "a socket"}
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            raise ValueError(f"it is {kinds.get(stat.filemode(found.st_mode)[0], 'a device')}")
        with path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ValueError(f"it must be a file that can be read ({reason})") from error
    if len(content) > MOST_BYTES:
        raise too_long(max(found.st_size, len(content)) // BYTES_PRINTED, "some ")
    dark = np.frombuffer(content, dtype=np.uint8) > ord(" ")
    words = int(np.count_nonzero(dark[1:] & ~dark[:-1]))
    if words > 2 * MOST_SAMPLES + 10_000:
        raise too_long(words // 2, "at least ")
    return content


def too_long(count: int, about: str = "") -> ValueError:
    """Return the refusal of a record of so many samples."""
    return ValueError(f"it holds {about}{count} samples; it must hold {MOST_SAMPLES} at most")


def shown(word: str) -> str:
    """Return a word of a file in quotes, shortened where it is long."""
    return reprlib.repr(word)


def is_number(word: str) -> bool:
    """Whether a word is a number, or one that is not finite."""
    return bool(PLAIN.fullmatch(word) or NOT_FINITE.fullmatch(word))


def finite_number(word: str) -> float:
    """Return the number that a word is; ValueError says what else it must be.

    What is too small for floating point is not taken for 0.
    """
    if not is_number(word):
        raise ValueError(f"a number{' with a decimal point' if ',' in word else ''}")
    if not math.isfinite(float(word)):
        raise ValueError("a finite number")
    if float(word) == 0.0 and re.search("[1-9]", re.split("[eE]", word)[0]):
        raise ValueError(f"0, or at least {math.ulp(0.0):g}")
    return float(word)
