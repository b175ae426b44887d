"""Files of the European and Italian strong-motion archives, ESM and ITACA: keys, then a column."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from analytic.accelerograms.text import MOST_SAMPLES, number, shown, too_long
from analytic.accelerograms.units import Line, Sampled, converted, unit_of

STEP, COUNT, UNIT, TYPE = "SAMPLING_INTERVAL_S", "NDATA", "UNITS", "DATA_TYPE"
"""The keys that a record depends on; the others are about the event and the station."""

WHOLE = re.compile(r"\d{1,12}", re.ASCII)


@dataclass(frozen=True, slots=True)
class Header:
    """What a header says.

    Attributes
    ----------
    lines : int
        Its length.
    dt : float
        Time between samples [s].
    count : int
        Number of samples.
    unit : float
        Of the samples [m/s2].
    """

    lines: int
    dt: float
    count: int
    unit: float


def read(lines: Sequence[str], units: str | None) -> Sampled | None:
    """Read an ASC file of ESM or ITACA, or return None if the lines are not of one.

    Raises
    ------
    ValueError
        If a key is missing or doubtful, if the file is not one of acceleration, if a line among the
        samples is no number, or if there are not as many as the header says.
    """
    if not any(line.startswith(f"{STEP}:") for line in lines[:100]):
        return None
    header = _header(lines, units)
    numbered = enumerate(lines[header.lines :], start=header.lines + 1)
    samples = [number(line.strip(), at) for at, line in numbered if line.strip()]
    if len(samples) != header.count:
        problem = f"it must hold the {header.count} of its header"
        raise ValueError(f"it holds {len(samples)} samples; {problem}")
    return Sampled(header.dt, converted(samples, header.unit))


def _header(lines: Sequence[str], units: str | None) -> Header:
    keys: dict[str, Line] = {}
    end = 0
    for at, line in enumerate(lines, start=1):
        key, colon, value = line.partition(":")
        if not colon:
            break
        end = at
        if key in keys and key in (STEP, COUNT, UNIT, TYPE):
            raise ValueError(f"line {at}: {key} must not be said twice")
        keys[key] = Line(at, value.strip())
    kind, count, step = (_value(keys, key) for key in (TYPE, COUNT, STEP))
    if not kind.text.upper().endswith("ACCELERATION"):
        raise ValueError(
            f"line {kind.number}: {TYPE} is {shown(kind.text)}; it must be ACCELERATION"
        )
    if not WHOLE.fullmatch(count.text):
        raise ValueError(f"line {count.number}: {COUNT} is {shown(count.text)}; it must be whole")
    if int(count.text) > MOST_SAMPLES:
        raise too_long(int(count.text))
    stated = Line(keys[UNIT].number, f"units: {keys[UNIT].text}") if UNIT in keys else kind
    return Header(
        lines=end,
        dt=number(step.text, step.number),
        count=int(count.text),
        unit=unit_of([Line(kind.number, kind.text), stated], units),
    )


def _value(keys: Mapping[str, Line], key: str) -> Line:
    if key not in keys or not keys[key].text:
        raise ValueError(f"it does not say {key}, and must")
    return keys[key]
