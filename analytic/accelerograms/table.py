"""Tables of two columns, time and acceleration, with or without a line of their names."""

import itertools
import re
from collections.abc import Iterable, Sequence
from typing import NamedTuple

from analytic.accelerograms.columns import read_header
from analytic.accelerograms.text import MOST_SAMPLES, is_number, number, too_long
from analytic.accelerograms.units import Line, Sampled, converted

UNEVEN = 0.03
"""Part of a step by which a printed time may miss its place: what four decimals do to 256 Hz."""


class Sample(NamedTuple):
    """A line of numbers: where it is in the file, and what it says in the file's units."""

    line: int
    time: float
    acceleration: float


def read(lines: Sequence[str], units: str | None) -> Sampled:
    """Read a table of two columns, separated by commas, semicolons or blanks.

    Raises
    ------
    ValueError
        If the columns are not two, are swapped or may be, if their commas may be decimal ones, if
        a number is not finite, steps are missing or not equal, or no unit is known.
    """
    begin = next((at for at, line in enumerate(lines) if _is_row(line)), len(lines))
    separator = next((mark for mark in ";," if mark in "".join(lines[begin : begin + 1])), None)
    rows = _rows(lines, begin, separator)
    if len(rows) < 2:
        raise ValueError(f"it has {len(rows)} rows of numbers; it must have two or more")
    numbered = enumerate(lines, start=1)
    beside = [Line(at, text) for at, text in numbered if at <= begin or _is_remark(text)]
    header = read_header(beside, separator, units)
    if not header.named:
        _check_order(rows)
        _check_commas([lines[row.line - 1] for row in rows], separator)
    dt = _step([(row.line, header.second * row.time) for row in rows])
    return Sampled(dt, converted([row.acceleration for row in rows], header.unit))


def _is_remark(line: str) -> bool:
    return line.lstrip()[:1] in ("#", "%")


def _is_row(line: str) -> bool:
    return is_number(re.split(r"[\s,;]", line.strip(), maxsplit=1)[0])


def _rows(lines: Sequence[str], begin: int, separator: str | None) -> list[Sample]:
    rows: list[Sample] = []
    for at, line in enumerate(lines[begin:], start=begin + 1):
        text = line.strip().rstrip(",;")
        if not text or _is_remark(text):
            continue
        words = text.split(separator)
        if len(words) != 2:
            columns = f"line {at} has {len(words)} columns"
            raise ValueError(f"{columns}; it must have two, time and acceleration")
        rows.append(Sample(at, number(words[0].strip(), at), number(words[1].strip(), at)))
        if len(rows) > MOST_SAMPLES:
            raise too_long(MOST_SAMPLES, "more than ")
    return rows


def _check_commas(rows: Iterable[str], separator: str | None) -> None:
    """Raise ValueError if every row may be one number with a decimal comma."""
    if separator == "," and not any(re.search(r"[.eE]|,[ \t]+\S", row) for row in rows):
        raise ValueError(
            "its commas may be decimal ones; it must have decimal points, semicolons or blanks "
            "between the columns, or a line of their names"
        )


def _check_order(rows: Sequence[Sample]) -> None:
    """Raise ValueError if the second column may be the times, too."""
    if len(rows) < 3:
        return
    try:
        _step([(row.line, row.acceleration) for row in rows])
    except ValueError:
        return
    raise ValueError(
        "both columns increase in equal steps; a line above must name them, as in t (s), a (g)"
    )


def _step(times: Sequence[tuple[int, float]]) -> float:
    """Return the step [s] of equally spaced times, each with its line."""
    steps = sorted(after - before for (_, before), (_, after) in itertools.pairwise(times))
    usual = steps[len(steps) // 2]
    for (_, before), (line, time) in itertools.pairwise(times):
        ratio = (time - before) / usual if usual > 0.0 else 0.0
        if ratio <= 0.0:
            raise ValueError(f"line {line}: the time {time:g} s must be later than {before:g} s")
        if ratio > 1.5:
            raise ValueError(
                f"line {line}: a gap from {before:g} to {time:g} s; steps must all be {usual:g} s"
            )
    dt = (times[-1][1] - times[0][1]) / (len(times) - 1)
    for place, (line, time) in enumerate(times):
        if abs(time - times[0][1] - place * dt) > UNEVEN * dt:
            raise ValueError(
                f"line {line}: the time {time:g} s is not a whole number of steps of {dt:g} s "
                "after the first; steps must be equal"
            )
    return dt
