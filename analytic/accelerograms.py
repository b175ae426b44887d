"""Files of recorded ground motion: PEER's AT2, ESM's ASC, a column of samples, a table of two.

A file that leaves a doubt is refused: nothing is filled in, thinned or guessed.
"""

import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from analytic.block import GRAVITY
from analytic.motion import FloatArray
from analytic.text import MOST_SAMPLES, NUMBER, finite_number, is_number, lines_of, shown, too_long

Units = Literal["g", "mg", "m/s2", "cm/s2", "mm/s2", "gal"]
UNITS = {"g": GRAVITY, "mg": 1e-3 * GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 1e-3, "gal": 0.01}
"""Unit of acceleration -> m/s2; g is that of the blocks, so that what lifts one is g tan alpha."""

UNEVEN = 0.03
"""Part of a step by which a printed time may miss its place: what four decimals do to 256 Hz."""

FOREIGN = {
    "COSMOS": r".*\(Format v[\d.]+ with \d+ text lines",
    "GeoNet": r".*accelerogram .*GNS Science",
    "SMC": r"\d [A-Z][A-Z ]+$|\*\s*$",
    "CSMIP": r"(UN)?CORRECTED ACCELEROGRAM|RESPONSE AND FOURIER",
    "K-NET": r"Origin Time\s+\d",
    "SIMBAD": r".*\bSIMBAD\b",
}
"""Format that is not read -> how its first line looks."""

STATED = re.compile(
    r"\bunits?\b(?:\s*(?:\b(?:of|in|is|are)\b|[:=]))*\s*[(\[]?\s*([^\s,;)\]]*[^\s,;)\].:])"
    r"|(?:[(\[_]|\bin\s|\ba(?:g|cc\w*)?/)\s*((?:%g|m?g|gal|(?:[mc]?m|ft|in)/s2?)(?![\w/*%]))"
)
"""What follows the word units, and a unit in brackets, after an underscore or after the word in."""

QUANTITIES = {
    "acceleration": re.compile(r"accel|\bacc(?![a-z])", re.IGNORECASE),
    "velocity": re.compile(r"veloc|\bvel(?![a-z])", re.IGNORECASE),
    "displacement": re.compile(r"displ|\bdisp?(?![a-z])", re.IGNORECASE),
}
"""Quantity -> how a header names it."""

ASC = ("DATA_TYPE", "NDATA", "SAMPLING_INTERVAL_S", "UNITS")
"""Keys of an ASC file that a record depends on; only the last may be missing."""

AT2 = [
    re.compile(form, re.IGNORECASE | re.ASCII)
    for form in (
        rf"^\s*(?P<count>\d+)\s+(?P<dt>{NUMBER})\s+NPTS\s*,\s*DT\b",
        rf"\b(?P<count>\d+) points at equal spacing of (?P<dt>{NUMBER})\s*(?P<unit>\w+)",
        r"\bNPTS\s*=\s*(?P<count>\d+)\b",
        rf"\bDT\s*=\s*(?P<dt>{NUMBER})(?![\w.])\s*(?P<unit>(?!NPTS)[a-z]*)",
    )
]
"""How the header of an AT2 file says the number of samples and their step."""

TOUCHING = re.compile(f"(?:{NUMBER}){{2,}}", re.ASCII)
BEGIN, END = (re.compile(rf"\s*\*+\s*{word}\b", re.IGNORECASE) for word in ("begin", "end"))
NOT_SECONDS = re.compile(r"(?:[mun]|milli|micro|nano)s(?:ec\w*)?|min\w*|hours?|hz", re.IGNORECASE)

TIME = re.compile(r"\b(?:t|time)(?![a-z])", re.IGNORECASE)
ACCELERATION = re.compile(r"\bag?(?![a-z])|acc", re.IGNORECASE)
FIELD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?")
"""A name without blanks, but for one before the bracket of its unit."""
TIME_UNIT = re.compile(r"(?:[(\[_/]|\bin\b)\s*([^\W_]+)")
SHORTER = re.compile(r"(?<![\w/])(?:ms|msecs?|milliseconds?|[µμ]s)\b", re.IGNORECASE)

Lines = Sequence[tuple[int, str]]
"""Lines of a file, each behind its number."""


class Sampled(NamedTuple):
    """What a file holds: time between samples [s], ground acceleration [m/s2], its unit there."""

    dt: float
    unit: str
    samples: FloatArray


def read(path: Path, units: str | None, dt: float | None, insist: bool = True) -> Sampled:
    """Read a file; `analytic.Record.read` says which, and when it raises ValueError."""
    if units is not None and units not in UNITS:
        raise ValueError(f"units must be among {', '.join(UNITS)}, not {units!r}")
    if path.suffix.lower() in (".vt2", ".dt2"):
        raise ValueError("it must be a file of acceleration, as AT2 files are")
    lines = lines_of(path)
    first = next((line.strip() for line in lines if line.strip()), "")
    foreign = [name for name, begins in FOREIGN.items() if re.match(begins, first, re.IGNORECASE)]
    found = _asc(lines, units) or _at2(lines, units)
    if foreign and not found:
        raise ValueError(
            f"it is a {foreign[0]} file, which is not read; it must be a PEER AT2 or an ESM ASC "
            "file, or a table of two columns, time [s] and acceleration, made from it, for "
            "instance with gmprocess"
        )
    header, rows = _split(lines)
    found = found or _column(header, rows, units, dt) or _table(header, rows, units)
    if insist and dt is not None and found.dt != dt:
        raise ValueError(f"it states a step of {found.dt:g} s; dt must not be {dt:g}")
    if insist and units is not None and UNITS[units] != UNITS[found.unit]:
        raise ValueError(f"it states {found.unit}; units must not be {units}")
    return found


def _asc(lines: Sequence[str], units: str | None) -> Sampled | None:
    """Read a file of ESM or ITACA: keys, then a column; None if the lines are not of one."""
    if not any(line.startswith("SAMPLING_INTERVAL_S:") for line in lines[:100]):
        return None
    end = next((at for at, line in enumerate(lines) if ":" not in line), len(lines))
    said: dict[str, tuple[int, str]] = {}
    for at, line in enumerate(lines[:end], start=1):
        key, _, value = line.partition(":")
        if key in ASC and value.strip():
            if key in said:
                raise ValueError(f"line {at}: {key} must not be said twice")
            said[key] = at, value.strip()
    for key in ASC[:3]:
        if key not in said:
            raise ValueError(f"it does not say {key}, and must")
    at, kind = said["DATA_TYPE"]
    if not kind.upper().endswith("ACCELERATION") or "SPECTRUM" in kind.upper():
        raise ValueError(f"line {at}: DATA_TYPE is {shown(kind)}; it must be ACCELERATION")
    count, dt = _whole("NDATA", *said["NDATA"]), _number(*said["SAMPLING_INTERVAL_S"])
    rows = enumerate(map(str.strip, lines[end:]), start=end + 1)
    unit = [(at, f"units: {value}") for key, (at, value) in said.items() if key == "UNITS"]
    return _sampled(dt, [_number(at, row) for at, row in rows if row], unit, units, count)


def _at2(lines: Sequence[str], units: str | None) -> Sampled | None:
    """Read an AT2 file: text, then nothing but samples; None if the lines are not of one.

    A header that says the step alone must be closed by "*** End Data ***": the file is whole then.
    """
    end, counts, steps = 0, dict[float, None](), dict[float, None]()
    for at, line in enumerate(lines[:100], start=1):
        found = [] if _is_remark(line) else [one for form in AT2 for one in form.finditer(line)]
        for said in (match.groupdict() for match in found):
            if unit := NOT_SECONDS.fullmatch(said.get("unit", "")):
                raise ValueError(f"line {at}: the step is in {unit[0]}; it must be in seconds")
            counts |= {_whole("NPTS", at, said["count"]): None} if "count" in said else {}
            steps |= {_number(at, said["dt"]): None} if "dt" in said else {}
        end = at if found or BEGIN.match(line) else end
    last = next((at for at in reversed(range(len(lines))) if lines[at].strip()), 0)
    closed = bool(END.match(lines[last]))
    if not counts and not (steps and closed):
        return None
    if not steps:
        raise ValueError("it says NPTS; it must say DT, too")
    for name, values in (("step", steps), ("number of samples", counts)):
        if len(values) > 1:
            words = " and ".join(f"{value:g}" for value in values)
            raise ValueError(f"its header says {words} as {name}; it must say one")
    header = list(enumerate(lines[:end], start=1))
    _check_quantity(header)
    rows = enumerate(lines[end : last if closed else last + 1], start=end + 1)
    samples = [_number(at, word) for at, row in rows for word in row.split()]
    return _sampled(min(steps), samples, header, units, *counts)


def _column(header: Lines, rows: Lines, units: str | None, dt: float | None) -> Sampled | None:
    """Read samples alone; their step is given, or stands with their number on a line "npts dt"."""
    words = [(at, word) for at, row in rows for word in row.split()]
    widths, count = [len(row.split()) for _, row in rows], None
    if widths[:1] == [2] and {*widths[1:]} == {1} and words[0][1].isdecimal():
        count, dt = _whole("the number of samples", *words[0]), _number(*words[1])
        words = words[2:]
    elif not rows or {*widths} == {2} or any(mark in rows[0][1] for mark in ",;"):
        return None
    elif dt is None and {*widths} == {1}:
        raise ValueError('it has one column; dt, or a line "npts dt" above, must say a step')
    elif dt is None or (len({*widths}) == 1 and widths[0] > 2 and len(rows) > 2 and _timed(rows)):
        return None
    _check_quantity(header)
    return _sampled(dt, [_number(*word) for word in words], header, units, count)


def _timed(rows: Lines) -> bool:
    """Return whether the first column is of times, which no samples are."""
    first = [row.split()[0] for _, row in rows]
    times = np.array([float(word) if is_number(word) else 0.0 for word in first])
    return not _uneven(times, range(len(times)))


def _table(header: Lines, rows: Lines, units: str | None) -> Sampled:
    """Read a table of two columns, separated by commas, semicolons or blanks."""
    separator = next((mark for mark in ";," for _, row in rows[:1] if mark in row), None)
    if len(rows) < 2:
        raise ValueError(f"it has {len(rows)} rows of numbers; it must have two or more")
    pairs = list[list[float]]()
    for at, row in rows:
        words = row.strip().rstrip(",;").split(separator)
        if len(words) != 2:
            problem = f"line {at} has {len(words)} columns; it must have two"
            raise ValueError(f"{problem}, time and acceleration")
        pairs.append([_number(at, word.strip()) for word in words])
    times, samples = np.transpose(pairs)
    numbers = [at for at, _ in rows]
    if not _named(header, separator):
        _check_quantity(header)
        if separator == "," and not any(re.search(r"[.eE]|,[ \t]+\S", row) for _, row in rows):
            raise ValueError(
                "its commas may be decimal ones; it must have decimal points, semicolons or blanks "
                "between the columns, or a line of their names"
            )
        if len(rows) > 2 and not _uneven(samples, numbers):
            raise ValueError(
                "both columns increase in equal steps; a line above must name them, as in t (s), "
                "a (g)"
            )
    if problem := _uneven(times, numbers):
        raise ValueError(problem)
    return _sampled(float(times[-1] - times[0]) / (len(times) - 1), samples, header, units)


def _named(header: Lines, separator: str | None) -> bool:
    """Return whether a line names the columns; ValueError if not as time [s] and acceleration."""
    named = False
    for at, line in header:
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
            if unit and unit[1].lower() not in ("s", "sec", "secs", "second", "seconds"):
                raise ValueError(f"line {at}: its times are in {shown(unit[1])}; they must be in s")
        if found := SHORTER.search(line):
            raise ValueError(f"line {at} speaks of {found[0]}; its times must be in s")
    return named


def _uneven(times: FloatArray, lines: Sequence[int]) -> str:
    """Say why times, each of a line, do not increase in equal steps, or return an empty string."""
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(times)
        usual, dt = float(np.median(steps)), float(times[-1] - times[0]) / len(steps)
        missed = np.abs(times - times[0] - np.arange(len(times)) * dt) > UNEVEN * dt
    for at in np.flatnonzero((steps <= 0.0) | (steps > 1.5 * usual)).tolist()[:1]:
        before, time, where = times[at], times[at + 1], f"line {lines[at + 1]}"
        if steps[at] <= 0.0 or usual <= 0.0:
            return f"{where}: the time {time:g} s must be later than {before:g} s"
        return f"{where}: a gap from {before:g} to {time:g} s; steps must all be {usual:g} s"
    for at in np.flatnonzero(missed).tolist()[:1]:
        where = f"line {lines[at]}: the time {times[at]:g} s is not a whole number of steps"
        return f"{where} of {dt:g} s after the first; steps must be equal"
    return ""


def _is_remark(line: str) -> bool:
    return line.lstrip().startswith(("#", "%"))


def _split(lines: Sequence[str]) -> tuple[Lines, Lines]:
    """Return the lines above the first row of numbers with all remarks, and the rows."""
    numbered = list(enumerate(lines, start=1))
    first = (at for at, line in numbered if is_number(re.split(r"[\s,;]", line.strip())[0]))
    begin = next(first, len(lines) + 1)
    header = [(at, line) for at, line in numbered if at < begin or _is_remark(line)]
    below = numbered[begin - 1 :]
    return header, [(at, line) for at, line in below if line.strip() and not _is_remark(line)]


def _sampled(
    dt: float, samples: ArrayLike, header: Lines, given: str | None, count: float | None = None
) -> Sampled:
    """Return the samples in m/s2, of the unit that a header states, or else a user gives.

    What overflows is infinite. ValueError if the unit is stated nowhere or twice or is not of
    acceleration, or there are too many samples, or not as many as a header says.
    """
    stated = {unit: at for at, line in header for unit in _units_in(line)}
    for unit, at in stated.items():
        if unit not in UNITS:
            raise ValueError(f"line {at} states {shown(unit)}; it must be among {', '.join(UNITS)}")
    if len({UNITS[unit] for unit in stated}) > 1:
        words = ", ".join(sorted(stated))
        raise ValueError(f"it names several units, {words}; it must state one")
    if given is None and not stated:
        raise ValueError(f"it does not state its units; units must: {', '.join(UNITS)}")
    unit = next(iter(stated), given or "")
    found = np.asarray(samples, dtype=np.float64)
    if found.size > MOST_SAMPLES:
        raise too_long(found.size)
    if count not in (None, found.size):
        raise ValueError(f"it holds {found.size} samples; it must hold the {count} of its header")
    with np.errstate(over="ignore"):
        return Sampled(dt, unit, np.asarray(UNITS[unit] * found))


def _units_in(line: str) -> Iterable[str]:
    """Yield the units that a line states as UNITS has them: cm/s2 for CM/SEC/SEC or cm s^-2."""
    plain = re.sub(r"\^|\*\*", "", line.lower()).replace("sec", "s").replace("²", "2")
    plain = re.sub(r"\s*/\s*", "/", plain).replace("/s/s", "/s2").replace("gals", "gal")
    plain = re.sub(r"(?<=[mt])[ .·*_]*(?:s-2|/s 2|(?<=_)s2)\b", "/s2", plain)
    return (one or other for one, other in STATED.findall(plain))


def _check_quantity(header: Lines) -> None:
    """Raise ValueError if a header speaks of velocity or displacement.

    One that speaks of acceleration, too, must state a unit of it.
    """
    found = [
        (at, kind) for at, line in header for kind in QUANTITIES if QUANTITIES[kind].search(line)
    ]
    spoken = {kind: at for at, kind in found}
    stated = {unit for _, line in header for unit in _units_in(line)}
    if "acceleration" in spoken and stated & UNITS.keys():
        return
    for quantity in spoken.keys() - {"acceleration"}:
        raise ValueError(f"line {spoken[quantity]} speaks of {quantity}; it must be acceleration")


def _number(line: int, word: str) -> float:
    """Return the number that a word of a line is; ValueError names the line."""
    try:
        return finite_number(word)
    except ValueError as error:
        said, problem = shown(word), f"must be {error}"
        if is_number(word):
            said = said[1:-1]
        elif TOUCHING.fullmatch(word):
            said, problem = f"the numbers of {said}", "must stand apart"
        raise ValueError(f"line {line}: {said} {problem}") from error


def _whole(name: str, line: int, word: str) -> int:
    """Return the number of samples that a line of a header says in plain digits."""
    if not (word.isascii() and word.isdecimal()):
        raise ValueError(f"line {line}: {name} is {shown(word)}; it must be whole")
    count = int(word[:12])
    if count > MOST_SAMPLES:
        raise too_long(count)
    return count
