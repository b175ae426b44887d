"""Tables of two columns, time [s] and acceleration, with or without a line of their names."""

import re
from collections.abc import Iterable, Mapping, Sequence

import numpy as np

from analytic.accelerograms.text import is_number, number, shown
from analytic.accelerograms.units import Sampled, check_quantity, converted, unit_of
from analytic.motion import FloatArray

UNEVEN = 0.03
"""Part of a step by which a printed time may miss its place: what four decimals do to 256 Hz."""

TIME = re.compile(r"\b(?:t|time)(?![a-z])", re.IGNORECASE)
ACCELERATION = re.compile(r"\bag?(?![a-z])|acc", re.IGNORECASE)
FIELD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?")
"""A name without blanks, but for one before the bracket of its unit."""

TIME_UNIT = re.compile(r"(?:[(\[_/]|\bin\b)\s*([^\W_]+)")
SECONDS = ("s", "sec", "secs", "second", "seconds")
SHORTER = re.compile(r"(?<![\w/])(?:ms|msecs?|milliseconds?|[µμ]s)\b", re.IGNORECASE)


def read(lines: Sequence[str], units: str | None) -> Sampled:
    """Read a table of two columns, separated by commas, semicolons or blanks.

    Parameters
    ----------
    lines, units
        As for `analytic.accelerograms.asc.read`.

    Raises
    ------
    ValueError
        If the columns are not two, are swapped or may be, if their commas may be decimal ones, if
        a number is not finite, steps are missing or not equal, or no unit is known.
    """
    begin = next((at for at, line in enumerate(lines) if _is_row(line)), len(lines))
    separator = next((mark for mark in ";," if mark in "".join(lines[begin : begin + 1])), None)
    numbered = list(enumerate(lines, start=1))
    beside = {at: line for at, line in numbered if at <= begin or line.lstrip()[:1] in ("#", "%")}
    at = [n for n, line in numbered if n not in beside and line.strip()]
    rows = np.array([_row(lines[n - 1], separator, n) for n in at])
    if len(rows) < 2:
        raise ValueError(f"it has {len(rows)} rows of numbers; it must have two or more")
    if not _check_names(beside, separator):
        check_quantity(beside)
        _check_numbers(rows, [lines[n - 1] for n in at], separator)
    samples = converted(rows[:, 1], unit_of(beside, units))
    return Sampled(_step(rows[:, 0], at), samples)


def _is_row(line: str) -> bool:
    return is_number(re.split(r"[\s,;]", line.strip(), maxsplit=1)[0])


def _row(line: str, separator: str | None, at: int) -> tuple[float, float]:
    words = line.strip().rstrip(",;").split(separator)
    if len(words) != 2:
        raise ValueError(
            f"line {at} has {len(words)} columns; it must have two, time and acceleration"
        )
    return number(words[0].strip(), at), number(words[1].strip(), at)


def _check_names(beside: Mapping[int, str], separator: str | None) -> bool:
    """Return whether a line names the columns; ValueError if not as time [s] and acceleration."""
    named = False
    for at, line in beside.items():
        plain = line.strip("#% \t")
        mark = next((mark for mark in (separator, ",", ";", "\t") if mark and mark in plain), None)
        names = plain.rstrip(",;").split(mark) if mark else FIELD.findall(plain)
        heads = mark is not None and mark == separator and plain == line.strip()
        if len(names) == 2 and (heads or any(map(TIME.search, names))):
            named = True
            time, other = (name.strip(' "') for name in names)
            if not TIME.search(time) or TIME.search(other) or not ACCELERATION.search(other):
                where = f"line {at}: its columns are {shown(time)} and {shown(other)}"
                raise ValueError(f"{where}; they must be time and acceleration, in this order")
            unit = TIME_UNIT.search(time)
            if unit and unit[1].lower() not in SECONDS:
                raise ValueError(f"line {at}: its times are in {shown(unit[1])}; they must be in s")
        if found := SHORTER.search(line):
            raise ValueError(f"line {at} speaks of {found[0]}; its times must be in s")
    return named


def _check_numbers(rows: FloatArray, lines: Iterable[str], separator: str | None) -> None:
    """Raise ValueError if every row may be one number with a decimal comma, or columns swapped."""
    if separator == "," and not any(re.search(r"[.eE]|,[ \t]+\S", line) for line in lines):
        raise ValueError(
            "its commas may be decimal ones; it must have decimal points, semicolons or blanks "
            "between the columns, or a line of their names"
        )
    if len(rows) > 2:
        try:
            _step(rows[:, 1], range(len(rows)))
        except ValueError:
            return
        raise ValueError(
            "both columns increase in equal steps; a line above must name them, as in t (s), a (g)"
        )


def _step(times: FloatArray, lines: Sequence[int]) -> float:
    """Return the step [s] of equally spaced times, each with its line."""
    with np.errstate(over="ignore"):
        steps = np.diff(times)
    usual = float(np.median(steps))
    for at in np.flatnonzero((steps <= 0.0) | (steps > 1.5 * usual))[:1]:
        before, time = times[at], times[at + 1]
        if steps[at] <= 0.0 or usual <= 0.0:
            problem = f"the time {time:g} s must be later than {before:g} s"
        else:
            problem = f"a gap from {before:g} to {time:g} s; steps must all be {usual:g} s"
        raise ValueError(f"line {lines[int(at) + 1]}: {problem}")
    dt = float(times[-1] - times[0]) / (len(times) - 1)
    missed = np.abs(times - times[0] - np.arange(len(times)) * dt) > UNEVEN * dt
    for place in np.flatnonzero(missed)[:1]:
        raise ValueError(
            f"line {lines[int(place)]}: the time {times[place]:g} s is not a whole number of steps "
            f"of {dt:g} s after the first; steps must be equal"
        )
    return dt
