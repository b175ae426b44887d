"""PEER's AT2 files and their kin: some lines of text, and then nothing but samples."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from analytic.accelerograms.text import MOST_SAMPLES, NUMBER, number, too_long
from analytic.accelerograms.units import Sampled, check_quantity, converted, numbered, unit_of

LONGEST_HEADER = 100
"""Lines in which a header is looked for."""

VALUE = rf"({NUMBER.pattern})"
PLAIN = re.IGNORECASE | re.ASCII
TRAILING = re.compile(rf"^\s*(\d{{1,12}})\s+{VALUE}\s+NPTS\s*,\s*DT\b", PLAIN)
SPACED = re.compile(rf"\b(\d{{1,12}}) points at equal spacing of {VALUE}\s*(\w+)", PLAIN)
COUNT = re.compile(r"\bNPTS\s*=\s*(\d{1,12})\b", PLAIN)
STEP = re.compile(rf"\bDT\s*=\s*{VALUE}(?![\w.])\s*([a-z]*)", PLAIN)
BEGIN = re.compile(r"^\s*\*+\s*begin\b", PLAIN)
END = re.compile(r"^\s*\*+\s*end\b", PLAIN)

NOT_SECONDS = re.compile(r"(?:[mun]|milli|micro|nano)s(?:ec\w*)?|min\w*|hours?|hz", PLAIN)
"""What a step may not be in."""


@dataclass(frozen=True, slots=True)
class Header:
    """What a header says.

    Attributes
    ----------
    lines : int
        Its length.
    counts : tuple of int
        Numbers of samples, as often as it says one.
    steps : tuple of float
        Times between samples [s], as often as it says one.
    """

    lines: int
    counts: tuple[int, ...]
    steps: tuple[float, ...]


def read(lines: Sequence[str], units: str | None) -> Sampled | None:
    """Read an AT2 file, or return None if the lines are not of one.

    Its header says the number of samples and their step, in any of the forms above. One that says
    the step alone must be closed by a line "*** End Data ***": it is whole then.

    Raises
    ------
    ValueError
        If the header contradicts itself or states no unit, if a word among the samples is no
        number, or if there are not as many as the header says.
    """
    header = _header(lines)
    last = _last(lines)
    closed = bool(END.match(lines[last]))
    if not header.counts and not (header.steps and closed):
        return None
    count, dt = _only("number of samples", header.counts), _only("step", header.steps)
    if dt is None:
        raise ValueError("it says NPTS; it must say DT, too")
    if count is not None and count > MOST_SAMPLES:
        raise too_long(int(count))
    said = numbered(lines, header.lines)
    check_quantity(said)
    unit = unit_of(said, units)
    samples = _samples(lines, header.lines, last if closed else last + 1)
    if count is not None and len(samples) != count:
        raise ValueError(
            f"it holds {len(samples)} samples; it must hold the {count:.0f} of its header"
        )
    return Sampled(dt, converted(samples, unit))


def _header(lines: Sequence[str]) -> Header:
    end, counts, steps = 0, list[int](), list[float]()
    for at, line in enumerate(lines[:LONGEST_HEADER], start=1):
        if line.lstrip()[:1] in ("#", "%"):
            continue
        found = TRAILING.search(line) or SPACED.search(line)
        if found:
            counts.append(int(found[1]))
            steps.append(_seconds(found[2], found[3] if found.re is SPACED else "", at))
        counts += [int(count) for count in COUNT.findall(line)]
        steps += [_seconds(step, unit, at) for step, unit in STEP.findall(line)]
        if found or COUNT.search(line) or STEP.search(line) or BEGIN.match(line):
            end = at
    return Header(end, tuple(counts), tuple(steps))


def _seconds(step: str, unit: str, line: int) -> float:
    if NOT_SECONDS.fullmatch(unit):
        raise ValueError(f"line {line}: the step is in {unit}; it must be in seconds")
    return number(step, line)


def _only(name: str, values: Sequence[float]) -> float | None:
    """Return the one value that is said, once or more often."""
    if len(set(values)) > 1:
        words = " and ".join(f"{value:g}" for value in dict.fromkeys(values))
        raise ValueError(f"its header says {words} as {name}; it must say one")
    return values[0] if values else None


def _last(lines: Sequence[str]) -> int:
    """Return the index of the last line that is not blank, or 0."""
    return next((at for at in reversed(range(len(lines))) if lines[at].strip()), 0)


def _samples(lines: Sequence[str], begin: int, end: int) -> list[float]:
    samples: list[float] = []
    for at in range(begin, end):
        samples += [number(word, at + 1) for word in lines[at].split()]
        if len(samples) > MOST_SAMPLES:
            raise too_long(MOST_SAMPLES, "more than ")
    return samples
