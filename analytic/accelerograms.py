"""Files of recorded ground motion: PEER's AT2, ESM's ASC, a column of samples, a table of two.

A file that leaves a doubt is refused: nothing is filled in, thinned or guessed.
"""

import math
import re
import stat
from collections.abc import Iterable, Sequence
from itertools import takewhile
from pathlib import Path
from reprlib import repr as shown
from typing import Literal

import numpy as np

from analytic.block import GRAVITY
from analytic.motion import FloatArray

MOST_SAMPLES = 1_000_000
"""Longest record that is read: 83 minutes at 200 Hz."""
BYTES = 64
"""Bytes of a file for each sample at most: two columns of 17 digits."""
Units = Literal["g", "mg", "m/s2", "cm/s2", "mm/s2", "gal"]
UNITS = {"g": GRAVITY, "mg": 1e-3 * GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 1e-3, "gal": 0.01}
"""Unit of acceleration -> m/s2; g is that of the blocks, so that what lifts one is g tan alpha."""
UNEVEN = 0.03
"""Part of a step by which a printed time may miss its place: what four decimals do to 256 Hz."""

NUMBER = r"[+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:[eE][+-]?\d+)?"
"""A number as programs print it; Python itself also takes 1_000, Arabic digits and NaN."""
PLAIN, TOUCHING = (re.compile(f"(?>{NUMBER}){many}", re.ASCII) for many in ("", "{2,}"))
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
NO_TEXT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\udc80-\udcff]")
"""Control characters, and the bytes that are not UTF-8."""

FOREIGN = {
    "COSMOS": r".*\(Format v[\d.]+ with \d+ text lines",
    "GeoNet": r".*accelerogram .*GNS Science",
    "SMC": r"\d [A-Z]{4,}[A-Z ]*$|\*\s*$",
    "CSMIP": r"(UN)?CORRECTED ACCELEROGRAM|RESPONSE AND FOURIER",
    "K-NET": r"Origin Time\s+\d",
    "SIMBAD": r".*\bSIMBAD\b",
}
"""Format that is not read -> how its first line begins."""
NOT_SECONDS = r"(?:(?:[mun]|milli|micro|nano)s(?:ec\w*)?|min\w*|hours?|hz)\b"
FORMS = [
    re.compile(form, re.IGNORECASE | re.ASCII)
    for form in (
        rf"^\s*(?P<count>\d+)\s+(?P<dt>{NUMBER})\s+NPTS\s*,\s*DT\b",
        rf"\b(?P<count>\d+) points at equal spacing of (?P<dt>{NUMBER})(?![\d.]|\s*{NOT_SECONDS})",
        r"\bNPTS\s*=\s*(?P<count>\d+)\b",
        rf"\bDT\s*=\s*(?P<dt>{NUMBER})(?![\w.]|\s*{NOT_SECONDS})",
        r"^NDATA:\s*(?P<count>\S.*?)\s*$",
        r"^SAMPLING_INTERVAL_S:\s*(?P<dt>\S.*?)\s*$",
        r"^\s*\*+\s*begin\b",
    )
]
"""How the header of an AT2 or an ASC file says the number of samples, their step [s], its end."""
END = re.compile(r"\s*\*+\s*end\b", re.IGNORECASE)
ASC = re.compile("data_type:(?!.*spectr).*acceleration$", re.IGNORECASE)
"""What an ASC file, whose header is keys before colons, must say."""

STATED = re.compile(
    r"\bunits?\b(?:\s*(?:\b(?:of|in|is|are)\b|[:=]))*\s*[(\[]?\s*([^\s,;)\]]*[^\s,;)\].:])"
    r"|(?:[(\[_]|\bin\s|\ba(?:g|cc\w*)?/)\s*((?:%g|m?g|gal|(?:[mc]?m|ft|in)/s2?)(?![\w/*%]))"
)
"""What follows the word units, and a unit in brackets, after an underscore or after the word in."""
ACCELERATION = re.compile(r"accel|\bacc(?![a-z])", re.IGNORECASE)
OTHER = re.compile(r"veloc\w*|\bvel(?![a-z])|displ\w*|\bdisp?(?![a-z])", re.IGNORECASE)
TIME = re.compile(r"\b(?:t|time)(?![a-z])", re.IGNORECASE)
A = re.compile(r"\bag?(?![a-z])|acc", re.IGNORECASE)
FIELD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?")
"""A name without blanks, but for one before the bracket of its unit."""
TIME_UNIT = re.compile(r"(?:[(\[_/]|\bin\b)\s*(?!s(?:ec(?:ond)?s?)?(?![^\W_]))([^\W_]+)", re.I)
SHORTER = re.compile(r"(?<![\w/])(ms|msecs?|milliseconds?|[µμ]s)\b", re.IGNORECASE)
"""A unit of times that are not seconds: behind a name, and anywhere."""
REMARK = re.compile(r"\s*[#%]")

Lines = Sequence[tuple[int, str]]
"""Lines of a file, each behind its number."""
Rows = Sequence[tuple[int, list[str]]]
"""Words of lines, each line's behind its number."""
Sampled = tuple[float, str, FloatArray]
"""Time between samples [s], unit of acceleration in a file, and samples."""


def read(path: Path, units: str | None, dt: float | None, insist: bool = True) -> Sampled:
    """Read a file, its samples in m/s2; `analytic.Record.read` says which, and what it refuses."""
    if units is not None and units not in UNITS:
        raise ValueError(f"units must be among {', '.join(UNITS)}, not {units!r}")
    if path.suffix.lower() in (".vt2", ".dt2"):
        raise ValueError("it must be a file of acceleration, as AT2 files are")
    header, below, said = _split([one for one in enumerate(lines_of(path), 1) if one[1].strip()])
    mark = next((mark for mark in ";," for _, row in below[:1] if not said and mark in row), None)
    rows = [(at, row.strip().rstrip(",;" if mark else "").split(mark)) for at, row in below]
    widths = [len(words) for _, words in rows]
    if widths[:1] == [2] and {*widths[1:]} == {1} and rows[0][1][0].isdecimal() and not said:
        (at, words), *rows = rows  # "npts dt" above the samples
        said = _number(at, words[1]), _number(at, words[0])
    elif dt is not None and not (said or mark or {*widths} <= {2} or _timed(rows)):
        said = dt, None
    if said:
        step, unit, samples = said[0], _unit(header, units, False), _numbers(rows)
    else:
        step, unit, samples = _table(header, rows, mark, units)
    count = samples.size if said is None or said[1] is None else said[1]
    if (most := max(samples.size, count)) > MOST_SAMPLES:
        raise ValueError(f"it holds {most:.0f} samples; it must hold {MOST_SAMPLES} at most")
    if count != samples.size:
        problem = f"it holds {samples.size} samples"
        raise ValueError(f"{problem}; it must hold the {count:.0f} of its header")
    if insist and dt not in (None, step):
        raise ValueError(f"it states a step of {step:g} s; dt must not be {dt:g}")
    if insist and units is not None and UNITS[units] != UNITS[unit]:
        raise ValueError(f"it states {unit}; units must not be {units}")
    with np.errstate(over="ignore"):  # what overflows is infinite, which no record is
        return step, unit, UNITS[unit] * samples


def _split(lines: Lines) -> tuple[Lines, Lines, tuple[float, float | None] | None]:
    """Return header, rows, and the step and count it says; a step alone needs "End Data" below."""
    top = lines[:100]
    asc = any(line.startswith("SAMPLING_INTERVAL_S:") for _, line in top)
    if asc:
        top = [*takewhile(lambda one: ":" in one[1], top)]
    end, said = len(top) if asc else 0, {"count": dict[float, None](), "dt": dict[float, None]()}
    for i, (at, line) in enumerate(top, start=1):
        forms = [] if REMARK.match(line) else FORMS
        for found in (one for form in forms for one in form.finditer(line)):
            end = max(end, i)
            for name, word in found.groupdict().items():
                if name == "count" and not word.isdecimal():
                    problem = f"line {at}: it says {shown(word)} samples"
                    raise ValueError(f"{problem}; it must be a whole number")
                said[name][_number(at, word)] = None
    closed = bool(lines and END.match(lines[-1][1]))
    if not (asc or said["count"] or (said["dt"] and closed)):
        return *_split_table(lines), None
    for name, values in said.items():
        if len(values) != 1 and (values or name == "dt" or not closed):
            number = " and ".join(f"{value:g}" for value in values) or "nothing"
            raise ValueError(f"its header says {number} as {name}; it must say one, dt in seconds")
    header = [one for one in lines[:end] if not asc or one[1].startswith(("DATA_", "UNITS:"))]
    if asc and not any(ASC.match(line.strip()) for _, line in header):
        kind = ", ".join(line for _, line in header)[:99]
        raise ValueError(f"it says {kind}; it must say DATA_TYPE: ACCELERATION")
    below = lines[end : -1 if closed else None]
    return header, below, (min(said["dt"]), next(iter(said["count"]), None))


def _split_table(lines: Lines) -> tuple[Lines, Lines]:
    """Return what is above and below the first line that begins with a number; remarks go up."""
    first = next((line.strip() for _, line in lines), "")
    for name in (name for name, form in FOREIGN.items() if re.match(form, first, re.IGNORECASE)):
        raise ValueError(
            f"it is of another format, {name} ({shown(first)}); it must be a PEER AT2 or an ESM "
            "ASC file, or a table of two columns, time [s] and acceleration, made from it"
        )
    numbers = (at for at, line in lines if is_number(re.split(r"[\s,;]", line.strip())[0]))
    begin = next(numbers, math.inf)
    header = [one for one in lines if one[0] < begin or REMARK.match(one[1])]
    return header, [one for one in lines if one[0] >= begin and not REMARK.match(one[1])]


def _timed(rows: Rows) -> bool:
    """Return whether rows are of one width, the first column of times, which no samples are."""
    alike = len({len(words) for _, words in rows}) == 1 < len(rows[0][1])
    return alike and len(rows) > 2 and not _uneven(_numbers(rows)[:: len(rows[0][1])], rows)


def _table(header: Lines, rows: Rows, mark: str | None, units: str | None) -> Sampled:
    """Read a table of two columns, with a mark or blanks between them."""
    if mark is None and rows and all(len(words) == 1 for _, words in rows):
        raise ValueError('it has one column; dt, or a line "npts dt" above, must say a step')
    if len(rows) < 2:
        raise ValueError(f"it has {len(rows)} rows of numbers; it must have two or more")
    for at, width in ((at, len(words)) for at, words in rows if len(words) != 2):
        raise ValueError(f"line {at} has {width} columns; it must have two, time and acceleration")
    times, samples = _numbers(rows).reshape(-1, 2).T
    if not (named := _named(header, mark)):
        words = "\n".join(",".join(words) for _, words in rows)
        if mark == "," and not re.search(r"[.eE]|,[ \t]+\S", words):
            raise ValueError(
                "its commas may be decimal ones; it must have decimal points, semicolons or blanks "
                "between the columns, or a line of their names"
            )
        if len(rows) > 2 and not _uneven(samples, rows):
            problem = "both columns increase in equal steps; a line above must name them"
            raise ValueError(f"{problem}, as in t (s), a (g)")
    if problem := _uneven(times, rows):
        raise ValueError(problem)
    step = (times[-1].item() - times[0].item()) / (len(times) - 1)
    return step, _unit(header, units, named), samples


def _named(header: Lines, separator: str | None) -> bool:
    """Return whether a line names the columns; ValueError if not as time [s] and acceleration."""
    named = False
    for at, line in header:
        plain, found = line.strip("#% \t"), SHORTER.search(line)
        mark = next((mark for mark in (separator, *",;\t") if mark and mark in plain), None)
        names = plain.rstrip(",;").split(mark) if mark else FIELD.findall(plain)
        heads = mark is not None and mark == separator and plain == line.strip()
        if len(names) == 2 and (heads or any(map(TIME.search, names))):
            named, (time, other) = True, (name.strip(' "') for name in names)
            if not TIME.search(time) or TIME.search(other) or not A.search(other):
                where = f"line {at}: its columns are {shown(time)} and {shown(other)}"
                raise ValueError(f"{where}; they must be time and acceleration, in this order")
            found = TIME_UNIT.search(time) or found
        if found:
            raise ValueError(f"line {at}: its times are in {shown(found[1])}; they must be in s")
    return named


def _uneven(times: FloatArray, rows: Rows) -> str:
    """Say why times, each of a row, do not increase in equal steps, or return an empty string."""
    with np.errstate(over="ignore", invalid="ignore"):
        steps = np.diff(times)
        usual, dt = float(np.median(steps)), float(times[-1] - times[0]) / len(steps)
        missed = np.abs(times - times[0] - np.arange(len(times)) * dt) > UNEVEN * dt
    jumps = np.flatnonzero((steps <= 0.0) | (steps > 1.5 * usual))
    for at in (jumps if jumps.size else np.flatnonzero(missed[1:])).tolist()[:1]:
        where = f"line {rows[at + 1][0]}: the time {times[at + 1]:g} s follows {times[at]:g} s"
        return f"{where}; steps must be positive and equal, as most are: {usual:g} s"
    return ""


def _unit(header: Lines, given: str | None, named: bool) -> str:
    """Return the unit that a header states, or the given one; refuse velocity and displacement."""
    stated = {unit: at for at, line in header for unit in _units_in(line)}
    proper = {*stated} & {*UNITS} and any(ACCELERATION.search(line) for _, line in header)
    for at, line in header:
        if (found := OTHER.search(line)) and not (proper or named):
            raise ValueError(f"line {at} speaks of {found[0].lower()}; it must be acceleration")
    for unit, at in stated.items():
        if unit not in UNITS:
            raise ValueError(f"line {at} states {shown(unit)}; it must be among {', '.join(UNITS)}")
    if len({UNITS[unit] for unit in stated}) > 1:
        raise ValueError(f"it names several units, {', '.join(sorted(stated))}; it must state one")
    if given is None and not stated:
        raise ValueError(f"it does not state its units; units must: {', '.join(UNITS)}")
    return next(iter(stated), given or "")


def _units_in(line: str) -> Iterable[str]:
    """Yield the units that a line states as UNITS has them: cm/s2 for CM/SEC/SEC or cm s^-2."""
    plain = re.sub(r"\^|\*\*", "", line.lower()).replace("sec", "s").replace("²", "2")
    plain = re.sub(r"\s*/\s*", "/", plain).replace("/s/s", "/s2").replace("gals", "gal")
    plain = re.sub(r"(?<=[mt])[ .·*_]*(?:s-2|/s 2|(?<=_)s2)\b", "/s2", plain)
    return (one or other for one, other in STATED.findall(plain))


def lines_of(path: Path) -> list[str]:
    """Return the lines of a text file; ValueError if it is none, or too large for a record."""
    kinds = {"d": "a folder", "p": "a named pipe", "s": "a socket"}
    try:
        found = path.stat()
        if (kind := stat.filemode(found.st_mode)[0]) != "-":
            raise OSError(0, f"it is {kinds.get(kind, 'a device')}")
        content = path.read_bytes() if found.st_size <= BYTES * MOST_SAMPLES else b""
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", error)
        raise ValueError(f"it must be a file that can be read ({reason})") from error
    dark = np.frombuffer(content, dtype=np.uint8) > ord(" ")
    words = int(np.count_nonzero(dark[1:] & ~dark[:-1]))
    least = max(words / 2.0 - 5000.0, found.st_size / BYTES)
    if least > MOST_SAMPLES:
        problem = f"it holds at least {least:.0f} samples"
        raise ValueError(f"{problem}; it must hold {MOST_SAMPLES} at most")
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


def _number(line: int, word: str) -> float:
    """Return the number that a word of a line is; ValueError names the line."""
    try:
        return finite_number(word)
    except ValueError as error:
        said = word[:40] if is_number(word) else shown(word)
        raise ValueError(f"line {line}: {said} must be {error}") from error


def _numbers(rows: Rows) -> FloatArray:
    return np.array([_number(at, word.strip()) for at, words in rows for word in words])
