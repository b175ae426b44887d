"""PEER's AT2 files and their kin: some lines of text, and then nothing but samples."""

import re
from collections.abc import Iterable, Sequence

from analytic.accelerograms.text import NUMBER, number, whole
from analytic.accelerograms.units import Sampled, check_quantity, converted, unit_of

LONGEST_HEADER = 100
"""Lines in which a header is looked for."""

TRAILING = rf"^\s*(?P<count>\d+)\s+(?P<dt>{NUMBER})\s+NPTS\s*,\s*DT\b"
SPACED = rf"\b(?P<count>\d+) points at equal spacing of (?P<dt>{NUMBER})\s*(?P<unit>\w+)"
COUNT = r"\bNPTS\s*=\s*(?P<count>\d+)\b"
STEP = rf"\bDT\s*=\s*(?P<dt>{NUMBER})(?![\w.])\s*(?P<unit>(?!NPTS)[a-z]*)"
FORMS = [re.compile(form, re.IGNORECASE | re.ASCII) for form in (TRAILING, SPACED, COUNT, STEP)]
"""How a header says the number of samples and their step."""

BEGIN, END = (re.compile(rf"\s*\*+\s*{word}\b", re.IGNORECASE) for word in ("begin", "end"))

NOT_SECONDS = re.compile(r"(?:[mun]|milli|micro|nano)s(?:ec\w*)?|min\w*|hours?|hz", re.IGNORECASE)
"""What a step may not be in."""


def read(lines: Sequence[str], units: str | None) -> Sampled | None:
    """Read an AT2 file, or return None if the lines are not of one.

    Its header says the number of samples and their step, in any of the forms above. One that says
    the step alone must be closed by a line "*** End Data ***": it is whole then.

    Parameters
    ----------
    lines, units
        As for `analytic.accelerograms.asc.read`.

    Raises
    ------
    ValueError
        If the header contradicts itself or states no unit, if a word among the samples is no
        number, or if there are not as many as the header says.
    """
    end, counts, steps = _header(lines)
    last = next((at for at in reversed(range(len(lines))) if lines[at].strip()), 0)
    closed = bool(END.match(lines[last]))
    if not counts and not (steps and closed):
        return None
    if not steps:
        raise ValueError("it says NPTS; it must say DT, too")
    dt, count = _only("step", steps), _only("number of samples", counts) if counts else None
    header = dict(enumerate(lines[:end], start=1))
    check_quantity(header)
    unit = unit_of(header, units)
    rows = enumerate(lines[end : last if closed else last + 1], start=end + 1)
    samples = [number(word, at) for at, row in rows for word in row.split()]
    return Sampled(dt, converted(samples, unit, None if count is None else int(count)))


def _header(lines: Sequence[str]) -> tuple[int, list[int], list[float]]:
    """Return the length of a header, and each number of samples and step [s] that it says."""
    end, counts, steps = 0, list[int](), list[float]()
    for at, line in enumerate(lines[:LONGEST_HEADER], start=1):
        if line.lstrip()[:1] in ("#", "%"):
            continue
        found = [said.groupdict() for form in FORMS for said in form.finditer(line)]
        for said in found:
            if unit := NOT_SECONDS.fullmatch(said.get("unit", "")):
                raise ValueError(f"line {at}: the step is in {unit[0]}; it must be in seconds")
            counts += [whole("NPTS", at, said["count"])] if "count" in said else []
            steps += [number(said["dt"], at)] if "dt" in said else []
        if found or BEGIN.match(line):
            end = at
    return end, counts, steps


def _only(name: str, values: Iterable[float]) -> float:
    if len(found := list(dict.fromkeys(values))) > 1:
        words = " and ".join(f"{value:g}" for value in found)
        raise ValueError(f"its header says {words} as {name}; it must say one")
    return found[0]
