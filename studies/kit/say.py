"""Words: a refusal or an exception in one line, a number in a sentence, a table as text."""

from __future__ import annotations

import io
import math
import os
import sys
from collections.abc import Iterable, Sequence
from contextlib import suppress
from itertools import accumulate
from textwrap import fill, wrap
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from collections.abc import Mapping

    import pandas as pd

WIDTH, SHOWN, SMALL = 99, 60, 1e-2
"""Letters of a line of text, rows of a table shown as text, and what is shown as a power of ten."""


def refuse(message: str) -> int:
    """Say why a command cannot be run; return the exit code."""
    say(f"rocking: {brief(message)}")
    return 2


def say(line: str) -> None:
    """Write a line to stderr, if somebody is there to read it."""
    with suppress(OSError):
        print(line, file=sys.stderr)


def brief(message: str) -> str:
    """Return a message in one line that a terminal can show, whatever values it repeats."""
    line = _shortened(" ".join(_shortened(word, 255) for word in message.split()), 1000)
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in line)


def one_line(error: BaseException) -> str:
    """Return an exception in one line, its kind first, whatever it does when it is printed."""
    kind = type(error).__name__
    try:
        return brief(f"{kind}: {error}".removesuffix(": "))
    except BaseException:
        return kind


def reason(error: Exception) -> str:
    """Return why a command could not go on."""
    if isinstance(error, OSError):
        return str(error)
    while isinstance(error.__cause__, Exception):
        error = error.__cause__
    return one_line(error)


def _shortened(text: str, longest: int) -> str:
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]}…{text[-half:]}"


def prepare_streams() -> None:
    """Send what goes to a closed stream nowhere, and show what a terminal cannot as marks."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:  # else a file or a pipe takes its number
        os.set_inheritable(number, True)
    os.close(number)
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")


def flush() -> None:
    """Write what is waiting to be written, or give it up where that has failed before."""
    try:
        sys.stdout.flush()
    except OSError:
        give_up_output()


def give_up_output() -> None:
    """Send further output nowhere, what is waiting to be written included."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def power(value: float) -> str:
    """Return a number in two digits with its power of ten: "2.9·10⁻⁶", "10⁻⁴"."""
    if not value:
        return "0"
    digits, exponent = f"{value:.1e}".split("e")
    ten = "10" + str(int(exponent)).translate(str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹"))
    return ten if digits == "1.0" else f"{digits.removesuffix('.0')}·{ten}"


def part(value: float) -> str:
    """Return a part of a whole: in per cent from a millionth on, as a power of ten below."""
    if not math.isfinite(value):
        return "without bound" if math.isinf(value) else "-"
    if abs(value) < 1e-6:
        return power(value)
    if 0.99 < value < 1.0:
        return f"{math.floor(1e3 * value) / 10.0:.1f} %"  # not all of it
    return f"{100.0 * value:.0f} %" if abs(value) >= 0.1 else f"{100.0 * value:.2g} %"


def signed(value: float) -> str:
    """Return a relative error in per cent with its sign: "+24 %", "−0.012 %"."""
    return ("−" if value < 0.0 else "+") + part(abs(value))


def out_of(count: float, total: float) -> str:
    """Return "all 960", "none of 960" or "949 of 960"."""
    if count == total > 1:
        return f"all {total:.0f}"
    return f"none of {total:.0f}" if count == 0 else f"{count:.0f} of {total:.0f}"


def listed(words: Iterable[object]) -> str:
    """Return words as a list in a sentence: "a, b and c"; "none" without any."""
    *first, last = list(words) or ["none"]
    return f"{', '.join(map(str, first))} and {last}" if first else str(last)


def duration(seconds: float) -> str:
    """Return a time in the unit in which it is between 1 and 1000."""
    for scale, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def capital(sentence: str) -> str:
    """Return a sentence with its first letter large."""
    return sentence[:1].upper() + sentence[1:]


def number(value: object) -> str:
    """Return a value as a reader sees it: a number in three digits, a dash for none."""
    if not isinstance(value, float):
        return str(value)
    if math.isnan(value):
        return "-"
    return f"{value:.1e}" if 0.0 < abs(value) < SMALL else f"{value:.3g}"


def in_columns(table: pd.DataFrame) -> str:
    """Return a table as aligned text, words to the left, numbers to the right: what fits a line."""
    numeric = [kind.kind in "biuf" for kind in table.dtypes]
    rows = [list(map(str, table.columns)), *table.head(SHOWN).map(number).to_numpy().tolist()]
    ends = [0, *accumulate(max(map(len, column)) + 2 for column in zip(*rows, strict=True))]
    last = min(max(sum(end <= WIDTH + 2 for end in ends) - 2, 1), len(numeric) - 1)
    last += numeric[last + 1 : last + 2] == [False] and WIDTH - ends[last + 1] >= 35  # wrapped
    start = ends[last]
    rows = [
        [*row[:last], f"\n{start * ' '}".join(wrap(row[last], max(WIDTH - start, 20)))]
        for row in rows
    ]
    more = [f"and {len(table) - SHOWN} more rows"] if len(table) > SHOWN else []
    if others := list(map(str, table.columns[last + 1 :])):
        more.append(fill(f"not shown: {', '.join(others)}", WIDTH))
    return "\n".join([aligned(rows, numeric[: last + 1]), *more])


def aligned(rows: Sequence[Sequence[str]], right: Sequence[bool]) -> str:
    """Return rows of cells as text, each column to the left or to the right."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    sides = zip(right, widths, strict=True)
    form = "  ".join(f"{{:{'>' if to_right else '<'}{width}}}" for to_right, width in sides)
    return "\n".join(form.format(*row).rstrip() for row in rows)


def as_text(finding: str, tables: Mapping[str, pd.DataFrame]) -> str:
    """Return paragraphs and, under their titles, the tables that have rows."""
    paragraphs = [fill(each, WIDTH) for each in finding.split("\n\n")]
    named = [(f"{title}:", table) for title, table in tables.items() if len(table)]
    shown = [f"{fill(title, WIDTH)}\n{in_columns(table)}" for title, table in named]
    return "\n\n".join([*paragraphs, *shown])
