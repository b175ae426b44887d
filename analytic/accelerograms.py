"""Files of recorded ground motion: PEER's AT2, ESM's ASC, a column of samples, a table of two.

A file that leaves a doubt is refused: nothing is filled in, thinned or guessed.
"""

import math
import re
from collections.abc import Iterable, Sequence
from pathlib import Path
from reprlib import repr as shown
from typing import Literal

import numpy as np

from analytic.block import GRAVITY
from analytic.motion import FloatArray
from analytic.text import NUMBER, is_number, lines_of, number_in

Units = Literal["g", "mg", "m/s2", "cm/s2", "mm/s2", "gal"]
UNITS = {"g": GRAVITY, "mg": 1e-3 * GRAVITY, "m/s2": 1.0, "cm/s2": 0.01, "mm/s2": 1e-3, "gal": 0.01}
"""Unit of acceleration -> m/s2; g is that of the blocks, so that what lifts one is g tan alpha."""
UNEVEN = 0.03
"""Part of a step by which a printed time may miss its place: what four decimals do to 256 Hz."""

FOREIGN = {
    "COSMOS": r".*\(Format v[\d.]+ with \d+ text lines",
    "SMC": r"\d [A-Z]{4,}[A-Z ]*$|\*\s*$",
    "CSMIP or GeoNet": r"(UN)?CORRECTED ACCELEROGRAM|RESPONSE AND FOURIER",
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
        r"(?:\bNPTS\s*=|^NDATA:)\s*(?P<count>\d+(?:\.\d+)?)\b",
        rf"(?:\bDT\s*=|^SAMPLING_INTERVAL_S:)\s*(?P<dt>{NUMBER})(?![\w.]|\s*{NOT_SECONDS})",
        r"^(?:\s*\*+\s*begin\b|[\w/^]+:)",
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
OTHER = re.compile(r"veloc\w*|\bvel(?![a-z])|displ\w*|\bdisp?(?![a-z])", re.IGNORECASE)
TIME = re.compile(r"\b(?:t|time)(?![a-z])", re.IGNORECASE)
ACCELERATION = re.compile(r"\bag?(?![a-z]| [a-z]{3})|acc", re.IGNORECASE)
"""Its name, or an a that is no article."""
FIELD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?")
"""A name without blanks, but for one before the bracket of its unit."""
TIME_UNIT = re.compile(r"(?:[(\[_/]|\bin\b)\s*(?!s(?:ec(?:ond)?s?)?(?![^\W_]))([^\W_]+)", re.I)
"""A unit of times that are not seconds."""
REMARK = re.compile(r"\s*[#%]")

Lines = Sequence[tuple[int, str]]
Rows = Sequence[tuple[int, list[str]]]
"""Lines of a file, and their words, each behind its number."""
Sampled = tuple[float, FloatArray]
"""Time between samples [s], and samples."""


@np.errstate(over="ignore", invalid="ignore")  # what overflows is infinite, which no record is
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
    if not said and widths[:1] == [2] and {*widths[1:]} == {1} and rows[0][1][0].isdecimal():
        (at, words), *rows = rows  # "npts dt" above the samples
        said = number_in(at, words[1]), number_in(at, words[0])
    numbers = np.array([number_in(at, word.strip()) for at, words in rows for word in words])
    if not said and dt is not None and not mark and not _tabular(numbers, widths):
        said = dt, numbers.size
    step, samples = (said[0], numbers) if said else _table(header, rows, numbers, mark)
    unit = _unit(header, units)
    if said and said[1] not in (None, samples.size):
        problem = f"it holds {samples.size} samples"
        raise ValueError(f"{problem}; it must hold the {said[1]:.9g} of its header")
    if insist and dt not in (None, step):
        raise ValueError(f"it states a step of {step:g} s; dt must not be {dt:g}")
    if insist and units is not None and UNITS[units] != UNITS[unit]:
        raise ValueError(f"it states {unit}; units must not be {units}")
    return step, UNITS[unit] * samples


def _split(lines: Lines) -> tuple[Lines, Lines, tuple[float, float | None] | None]:
    """Return header, rows, and the step and count it says; a step alone needs "End Data" below."""
    said = {"count": dict[float, None](), "dt": dict[float, None]()}
    end, closed = 0, bool(lines and END.match(lines[-1][1]))
    for i, (at, line) in enumerate(lines[:100], start=1):
        forms = [] if REMARK.match(line) else FORMS
        for found in (one for form in forms for one in form.finditer(line)):
            end = i
            for name, word in found.groupdict().items():
                said[name][number_in(at, word)] = None
    header, below = lines[:end], lines[end : -1 if closed else None]
    if any(line.startswith("SAMPLING_INTERVAL_S:") for _, line in header):
        header = [one for one in header if one[1].startswith(("DATA_", "UNITS:"))]
        if not any(ASC.match(line.strip()) for _, line in header):
            kind = ", ".join(line for _, line in header)[:99]
            raise ValueError(f"it says {kind}; it must say DATA_TYPE: ACCELERATION")
    elif not (said["count"] or (said["dt"] and closed)):
        return *_split_table(lines), None
    for name, values in said.items():
        if len(values) != 1 and (values or name == "dt" or not closed):
            number = " and ".join(f"{value:g}" for value in values) or "nothing"
            raise ValueError(f"its header says {number} as {name}; it must say one, dt in seconds")
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


def _tabular(numbers: FloatArray, widths: Sequence[int]) -> bool:
    """Return whether rows are of two columns, or of one width, the first column of times."""
    if len({*widths}) > 1 or widths[:1] == [1]:
        return False
    return {*widths} <= {2} or (len(widths) > 2 and not _uneven(numbers[:: widths[0]]))


def _table(header: Lines, rows: Rows, numbers: FloatArray, mark: str | None) -> Sampled:
    """Read the numbers of a table of two columns, with a mark or blanks between them."""
    if mark is None and rows and all(len(words) == 1 for _, words in rows):
        raise ValueError('it has one column; dt, or a line "npts dt" above, must say a step')
    if len(rows) < 2:
        raise ValueError(f"it has {len(rows)} rows of numbers; it must have two or more")
    for at, width in ((at, len(words)) for at, words in rows if len(words) != 2):
        raise ValueError(f"line {at} has {width} columns; it must have two, time and acceleration")
    times, samples = numbers.reshape(-1, 2).T
    if not _named(header, mark):
        words = [word for _, row in rows for word in row]
        if mark == "," and not any(re.search(r"[.eE]|^[ \t]+\S", word) for word in words):
            other = "decimal points, semicolons between columns, or a line of their names"
            raise ValueError(f"its commas may be decimal ones; it must have {other}")
        if len(rows) > 2 and not _uneven(samples):
            problem = "both columns increase in equal steps; a line above must name them"
            raise ValueError(f"{problem}, as in t (s), a (g)")
    if at := _uneven(times):
        where = f"line {rows[at][0]}: the time {times[at]:g} s follows {times[at - 1]:g} s"
        usual = np.median(np.diff(times))
        raise ValueError(f"{where}; steps must be positive and equal, as most are: {usual:g} s")
    return (times[-1].item() - times[0].item()) / (len(times) - 1), samples


def _named(header: Lines, separator: str | None) -> bool:
    """Return whether a line names the columns; ValueError if not as time [s] and acceleration."""
    named = False
    for at, line in header:
        plain = line.strip("#% \t")
        mark = next((mark for mark in (separator, *",;\t") if mark and mark in plain), None)
        names = plain.rstrip(",;").split(mark) if mark else FIELD.findall(plain)
        heads = mark is not None and mark == separator and plain == line.strip()
        if len(names) == 2 and (heads or any(map(TIME.search, names))):
            named, (time, other) = True, (name.strip(' "') for name in names)
            if not TIME.search(time) or TIME.search(other) or not ACCELERATION.search(other):
                where = f"line {at}: its columns are {shown(time)} and {shown(other)}"
                raise ValueError(f"{where}; they must be time and acceleration, in this order")
            if found := TIME_UNIT.search(time):
                raise ValueError(f"line {at}: its times are in {found[1]!r}; they must be in s")
    return named


def _uneven(times: FloatArray) -> int:
    """Return the place of the first time that does not follow by the usual step, 0 if all do."""
    steps = np.diff(times)
    dt = (times[-1] - times[0]) / len(steps)
    wrong = (steps <= 0.0) | (steps > 1.5 * np.median(steps))
    if not wrong.any():
        wrong = np.abs(times - times[0] - np.arange(len(times)) * dt)[1:] > UNEVEN * dt
    return int(np.argmax(wrong)) + 1 if wrong.any() else 0


def _unit(header: Lines, given: str | None) -> str:
    """Return the unit that a header states, or the given one; refuse velocity and displacement."""
    stated = {unit: at for at, line in header for unit in _units_in(line)}
    proper = {*stated} & {*UNITS} and any(ACCELERATION.search(line) for _, line in header)
    for at, line in header:
        if (found := OTHER.search(line)) and not proper:
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
