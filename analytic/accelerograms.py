"""Files of recorded ground motion: PEER's AT2, ESM's ASC, a column of samples, a table of two.

A file that leaves a doubt is refused: nothing is filled in, thinned or guessed.
"""

import math
import re
import stat
from collections.abc import Iterable, Sequence
from pathlib import Path
from reprlib import repr as shown
from typing import Literal

import numpy as np
from numpy.typing import ArrayLike

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
PLAIN, TOUCHING = (re.compile(f"(?:{NUMBER}){many}", re.ASCII) for many in ("", "{2,}"))
NOT_FINITE = re.compile(r"[+-]?(?:nan|inf|infinity)", re.IGNORECASE)
NO_TEXT = re.compile("[\x00-\x08\x0b\x0c\x0e-\x1f\x7f-\x9f\udc80-\udcff]")
"""Control characters, and the bytes that are not UTF-8."""

FOREIGN = re.compile(
    r"(?i).*\(Format v[\d.]+ with \d+ text lines|.*accelerogram .*GNS Science|\d [A-Z][A-Z ]+$"
    r"|\*\s*$|(UN)?CORRECTED ACCELEROGRAM|RESPONSE AND FOURIER|Origin Time\s+\d|.*\bSIMBAD\b"
)
"""The first line of a file of COSMOS, GeoNet, SMC, CSMIP, K-NET or SIMBAD."""

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
    )
]
"""How the header of an AT2 or an ASC file says the number of samples and their step [s]."""
ASC = re.compile("data_type:(?!.*spectr).*acceleration$", re.IGNORECASE)
"""What an ASC file, whose header is keys before colons, must say."""
BEGIN, END = (re.compile(rf"\s*\*+\s*{word}\b", re.IGNORECASE) for word in ("begin", "end"))

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
TIME_UNIT = re.compile(r"(?:[(\[_/]|\bin\b)\s*([^\W_]+)")
SHORTER = re.compile(r"(?<![\w/])(?:ms|msecs?|milliseconds?|[µμ]s)\b", re.IGNORECASE)

REMARK = re.compile(r"\s*[#%]")

Lines = Sequence[tuple[int, str]]
"""Lines of a file, each behind its number."""
Rows = Sequence[tuple[int, list[str]]]
"""Words of lines, each line's behind its number."""


Sampled = tuple[float, str, FloatArray]
"""Time between samples [s], unit of acceleration in a file, and samples [m/s2]."""


def read(path: Path, units: str | None, dt: float | None, insist: bool = True) -> Sampled:
    """Read a file; `analytic.Record.read` says which, and when it raises ValueError."""
    if units is not None and units not in UNITS:
        raise ValueError(f"units must be among {', '.join(UNITS)}, not {units!r}")
    if path.suffix.lower() in (".vt2", ".dt2"):
        raise ValueError("it must be a file of acceleration, as AT2 files are")
    lines = [(at, line) for at, line in enumerate(lines_of(path), start=1) if line.strip()]
    header, below, said = _split(lines)
    if not said and lines and FOREIGN.match(lines[0][1].strip()):
        raise ValueError(
            f"it is of another format ({shown(lines[0][1].strip())}); it must be a PEER AT2 or an "
            "ESM ASC file, or a table of two columns, time [s] and acceleration, made from it"
        )
    mark = next((mark for mark in ";," for _, row in below[:1] if not said and mark in row), None)
    rows = [(at, row.strip().rstrip(",;" if mark else "").split(mark)) for at, row in below]
    widths = [len(words) for _, words in rows]
    if widths[:1] == [2] and {*widths[1:]} == {1} and rows[0][1][0].isdecimal() and not said:
        (at, words), *rows = rows  # "npts dt" above the samples
        said = _number(at, words[1]), _whole(at, words[0])
    if not said and dt is not None and not (mark or {*widths} <= {2} or _timed(rows)):
        said = dt, None
    if said:
        _check_quantity(header)
        samples = [_number(at, word) for at, words in rows for word in words]
        found = _sampled(said[0], samples, header, units, said[1])
    else:
        found = _table(header, rows, mark, units)
    if insist and dt is not None and found[0] != dt:
        raise ValueError(f"it states a step of {found[0]:g} s; dt must not be {dt:g}")
    if insist and units is not None and UNITS[units] != UNITS[found[1]]:
        raise ValueError(f"it states {found[1]}; units must not be {units}")
    return found


def _split(lines: Lines) -> tuple[Lines, Lines, tuple[float, float | None] | None]:
    """Return header, rows, and the step and count it says; a step alone needs "End Data" below."""
    asc = any(line.startswith("SAMPLING_INTERVAL_S:") for _, line in lines[:100])
    end, said = 0, {"count": dict[float, None](), "dt": dict[float, None]()}
    for i, (at, line) in enumerate(lines[:100], start=1):
        if asc and ":" not in line:
            break
        found = [one for form in FORMS for one in form.finditer(line) if not REMARK.match(line)]
        for name, word in (pair for one in found for pair in one.groupdict().items()):
            said[name][_whole(at, word) if name == "count" else _number(at, word)] = None
            end = i
        end = i if asc or BEGIN.match(line) else end
    closed = bool(lines and END.match(lines[-1][1]))
    if not (asc or said["count"] or (said["dt"] and closed)):
        words = (re.split(r"[\s,;]", line.strip())[0] for _, line in lines)
        end = next((i for i, word in enumerate(words) if is_number(word)), len(lines))
        header = [*lines[:end], *(line for line in lines[end:] if REMARK.match(line[1]))]
        return header, [line for line in lines[end:] if not REMARK.match(line[1])], None
    for name, values in said.items():
        if len(values) != 1 and (values or name == "dt" or not closed):
            number = " and ".join(f"{value:g}" for value in values) or "nothing"
            raise ValueError(f"its header says {number} as {name}; it must say one, dt in seconds")
    header = [line for line in lines[:end] if not asc or line[1].startswith(("DATA_", "UNITS:"))]
    if asc and not any(ASC.match(line.strip()) for _, line in header):
        kind = ", ".join(line for _, line in header)[:99]
        raise ValueError(f"it says {kind}; it must say DATA_TYPE: ACCELERATION")
    below = lines[end : -1 if closed else None]
    return header, below, (min(said["dt"]), next(iter(said["count"]), None))


def _timed(rows: Rows) -> bool:
    """Return whether rows are of one width, the first column of times, which no samples are."""
    times = np.array([float(words[0]) if is_number(words[0]) else 0.0 for _, words in rows])
    alike = len({len(words) for _, words in rows}) == 1 < len(rows[0][1])
    return alike and len(rows) > 2 and not _uneven(times, range(len(times)))


def _table(header: Lines, rows: Rows, separator: str | None, units: str | None) -> Sampled:
    """Read a table of two columns, separated by commas, semicolons or blanks."""
    if separator is None and rows and all(len(words) == 1 for _, words in rows):
        raise ValueError('it has one column; dt, or a line "npts dt" above, must say a step')
    if len(rows) < 2:
        raise ValueError(f"it has {len(rows)} rows of numbers; it must have two or more")
    for at, width in ((at, len(words)) for at, words in rows if len(words) != 2):
        raise ValueError(f"line {at} has {width} columns; it must have two, time and acceleration")
    numbers = [[_number(at, word.strip()) for word in words] for at, words in rows]
    (times, samples), lines = np.transpose(numbers), [at for at, _ in rows]
    if not _named(header, separator):
        _check_quantity(header)
        joined = "\n".join(",".join(words) for _, words in rows)
        if separator == "," and not re.search(r"[.eE]|,[ \t]+\S", joined):
            raise ValueError(
                "its commas may be decimal ones; it must have decimal points, semicolons or blanks "
                "between the columns, or a line of their names"
            )
        if len(rows) > 2 and not _uneven(samples, lines):
            problem = "both columns increase in equal steps; a line above must name them"
            raise ValueError(f"{problem}, as in t (s), a (g)")
    if problem := _uneven(times, lines):
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
            named, (time, other) = True, (name.strip(' "') for name in names)
            if not TIME.search(time) or TIME.search(other) or not A.search(other):
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
    jumps = np.flatnonzero((steps <= 0.0) | (steps > 1.5 * usual))
    for at in (jumps if jumps.size else np.flatnonzero(missed[1:])).tolist()[:1]:
        where = f"line {lines[at + 1]}: the time {times[at + 1]:g} s follows {times[at]:g} s"
        return f"{where}; steps must be positive and equal, as most are: {usual:g} s"
    return ""


def _sampled(
    dt: float, samples: ArrayLike, header: Lines, given: str | None, count: float | None = None
) -> Sampled:
    """Return samples in m/s2, of the stated unit or the given one; what overflows is infinite."""
    stated = {unit: at for at, line in header for unit in _units_in(line)}
    for unit, at in stated.items():
        if unit not in UNITS:
            raise ValueError(f"line {at} states {shown(unit)}; it must be among {', '.join(UNITS)}")
    if len({UNITS[unit] for unit in stated}) > 1:
        raise ValueError(f"it names several units, {', '.join(sorted(stated))}; it must state one")
    if given is None and not stated:
        raise ValueError(f"it does not state its units; units must: {', '.join(UNITS)}")
    unit, found = next(iter(stated), given or ""), np.asarray(samples, dtype=np.float64)
    if found.size > MOST_SAMPLES:
        raise _too_long(found.size)
    if count not in (None, found.size):
        raise ValueError(f"it holds {found.size} samples; it must hold the {count} of its header")
    with np.errstate(over="ignore"):
        return dt, unit, np.asarray(UNITS[unit] * found)


def _units_in(line: str) -> Iterable[str]:
    """Yield the units that a line states as UNITS has them: cm/s2 for CM/SEC/SEC or cm s^-2."""
    plain = re.sub(r"\^|\*\*", "", line.lower()).replace("sec", "s").replace("²", "2")
    plain = re.sub(r"\s*/\s*", "/", plain).replace("/s/s", "/s2").replace("gals", "gal")
    plain = re.sub(r"(?<=[mt])[ .·*_]*(?:s-2|/s 2|(?<=_)s2)\b", "/s2", plain)
    return (one or other for one, other in STATED.findall(plain))


def _check_quantity(header: Lines) -> None:
    """Refuse velocity or displacement, unless acceleration and a unit of it are spoken of too."""
    stated = any(unit in UNITS for _, line in header for unit in _units_in(line))
    proper = stated and any(ACCELERATION.search(line) for _, line in header)
    for at, line in header:
        if (found := OTHER.search(line)) and not proper:
            raise ValueError(f"line {at} speaks of {found[0].lower()}; it must be acceleration")


def lines_of(path: Path) -> list[str]:
    """Return the lines of a text file; ValueError if it is none, or too large for a record."""
    kinds = {"d": "a folder", "p": "a named pipe", "s": "a socket"}
    try:
        found = path.stat()
        if not stat.S_ISREG(found.st_mode):
            raise ValueError(f"it is {kinds.get(stat.filemode(found.st_mode)[0], 'a device')}")
        with path.open("rb") as file:
            content = file.read(BYTES * MOST_SAMPLES + 1)
    except (OSError, ValueError) as error:
        reason = error.strerror if isinstance(error, OSError) else error
        raise ValueError(f"it must be a file that can be read ({reason})") from error
    dark = np.frombuffer(content, dtype=np.uint8) > ord(" ")
    words = int(np.count_nonzero(dark[1:] & ~dark[:-1]))
    least = max(words / 2.0 - 5000.0, max(found.st_size, len(content)) / BYTES)
    if least > MOST_SAMPLES:
        raise _too_long(least, "at least ")
    text = content.decode("utf-8-sig", "surrogateescape")
    text = text.replace("\r\n", "\n").replace("\r", "\n")
    if no_text := NO_TEXT.search(text):
        line, byte = text.count("\n", 0, no_text.start()) + 1, ord(no_text[0]) & 0xFF
        raise ValueError(f"line {line}: the byte 0x{byte:02x} is not text in UTF-8")
    return text.split("\n")


def is_number(word: str) -> bool:
    """Whether a word is a number, or one that is not finite."""
    return bool(PLAIN.fullmatch(word) or NOT_FINITE.fullmatch(word))


def finite_number(word: str) -> float:
    """Return the number that a word is, not taking what is too small for floating point for 0."""
    if not is_number(word):
        raise ValueError(f"a number{' with a decimal point' if ',' in word else ''}")
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
        apart = TOUCHING.fullmatch(word) and not is_number(word)
        said = word[:40] if is_number(word) else shown(word)
        problem = "numbers that stand apart" if apart else error
        raise ValueError(f"line {line}: {said} must be {problem}") from error


def _whole(line: int, word: str) -> int:
    """Return the number of samples that a line of a header says in plain digits."""
    if not (word.isascii() and word.isdecimal()):
        raise ValueError(f"line {line}: it says {shown(word)} samples; it must be a whole number")
    count = int(word[:12])
    if count > MOST_SAMPLES:
        raise _too_long(count)
    return count


def _too_long(count: float, about: str = "") -> ValueError:
    return ValueError(f"it holds {about}{count:.0f} samples; it must hold {MOST_SAMPLES} at most")
