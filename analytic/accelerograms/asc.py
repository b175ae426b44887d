"""Files of the European and Italian strong-motion archives, ESM and ITACA: keys, then a column."""

from collections.abc import Sequence

from analytic.accelerograms.text import number, shown, whole
from analytic.accelerograms.units import Sampled, converted, unit_of

STEP, COUNT, UNIT, TYPE = KEYS = ("SAMPLING_INTERVAL_S", "NDATA", "UNITS", "DATA_TYPE")
"""The keys that a record depends on; the others are about the event and the station."""


def read(lines: Sequence[str], units: str | None) -> Sampled | None:
    """Read an ASC file of ESM or ITACA, or return None if the lines are not of one.

    Parameters
    ----------
    lines : sequence of str, those of the file
    units : str or None, a unit of UNITS for a file that states none

    Raises
    ------
    ValueError
        If a key is missing or doubtful, if the file is not one of acceleration, if a line among the
        samples is no number, or if there are not as many as the header says.
    """
    if not any(line.startswith(f"{STEP}:") for line in lines[:100]):
        return None
    end = next((at for at, line in enumerate(lines) if ":" not in line), len(lines))
    said: dict[str, tuple[int, str]] = {}
    for at, line in enumerate(lines[:end], start=1):
        key, _, value = line.partition(":")
        if key in KEYS and value.strip():
            if key in said:
                raise ValueError(f"line {at}: {key} must not be said twice")
            said[key] = at, value.strip()
    for key in (TYPE, COUNT, STEP):
        if key not in said:
            raise ValueError(f"it does not say {key}, and must")
    at, kind = said[TYPE]
    if not kind.upper().endswith("ACCELERATION") or "SPECTRUM" in kind.upper():
        raise ValueError(f"line {at}: {TYPE} is {shown(kind)}; it must be ACCELERATION")
    at, unit = said.get(UNIT, (0, ""))
    count = whole(COUNT, *said[COUNT])
    rows = [(n, line.strip()) for n, line in enumerate(lines[end:], start=end + 1)]
    samples = [number(word, n) for n, word in rows if word]
    dt = number(said[STEP][1], said[STEP][0])
    return Sampled(dt, converted(samples, unit_of({at: f"units: {unit}"}, units), count))
