"""Files of text that others wrote, and the numbers in them."""

import math
import re
from pathlib import Path
from reprlib import repr as shown

MOST_WORDS, MOST_BYTES = 2_500_000, 64_000_000
"""Longest text that is read: a table of two columns, 100 minutes at 200 Hz."""
NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
"""A number as programs print it; Python itself also takes 1_000, Arabic digits and NaN."""
PLAIN, TOUCHING = (re.compile(f"(?>{NUMBER}){many}", re.ASCII) for many in ("", "{2,}"))
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
NO_TEXT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\udc80-\udcff]")
"""Control characters, and the bytes that are not UTF-8."""


def lines_of(path: Path) -> list[str]:
    """Return the lines of a text file; ValueError if it is none, or too long."""
    try:
        if path.exists() and not path.is_file():  # a pipe would be waited for
            raise OSError(0, "it is a folder, a pipe or a device")
        with path.open("rb") as file:
            content = file.read(MOST_BYTES + 1)
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", error)
        raise ValueError(f"it must be a file that can be read ({reason})") from error
    if len(content) > MOST_BYTES or len(content.split()) > MOST_WORDS:
        raise ValueError(f"it must hold at most {MOST_WORDS} words, in {MOST_BYTES} bytes")
    lines = re.split("\r\n?|\n", content.decode("utf-8-sig", "surrogateescape"))
    for at, no_text in enumerate(map(NO_TEXT.search, lines), start=1):
        if no_text:
            byte = ord(no_text[0]) & 0xFF
            raise ValueError(f"line {at}: the byte 0x{byte:02x} is not text in UTF-8")
    return lines


def is_number(word: str) -> bool:
    """Whether a word is a number, or one that is not finite."""
    return bool(PLAIN.fullmatch(word) or NOT_FINITE.fullmatch(word))


def finite_number(word: str) -> float:
    """Return the number that a word is, not taking what is too small for floating point for 0."""
    if not is_number(word):
        one = f"a number{' with a decimal point' if ',' in word else ''}"
        raise ValueError("numbers that stand apart" if TOUCHING.fullmatch(word) else one)
    if not math.isfinite(float(word)):
        raise ValueError("a finite number")
    if float(word) == 0.0 and re.search("[1-9]", re.split("[eE]", word)[0]):
        raise ValueError(f"0, or at least {math.ulp(0.0):g}")
    return float(word)


def number_in(line: int, word: str) -> float:
    """Return the number that a word of a line is; ValueError names the line."""
    try:
        return finite_number(word)
    except ValueError as error:
        said = word[:40] if is_number(word) else shown(word)
        raise ValueError(f"line {line}: {said} must be {error}") from error
