"""What a line above a table says of its two columns."""

import re
from collections.abc import Sequence
from dataclasses import dataclass

from analytic.accelerograms.text import shown
from analytic.accelerograms.units import QUANTITIES, Line, check_quantity, is_unit, unit_of

TIMES = {"t", "time", "times", "zeit", "temps", "tiempo", "tempo"}
"""Names of a column of times."""

OTHERS = {"v", "d"}
"""Names of columns that are not of acceleration, besides QUANTITIES."""

SECONDS = {
    **dict.fromkeys(("s", "sec", "secs", "second", "seconds"), 1.0),
    **dict.fromkeys(("ms", "msec", "msecs", "millisecond", "milliseconds"), 1e-3),
}
"""Unit of time -> s."""

SHORTER = re.compile(r"(?<![\w/])(?:ms|msecs?|milliseconds?|[µμ]s)\b", re.IGNORECASE)

LABEL = re.compile(
    r"(?P<name>.*?)\s*(?:(?P<mark>[(\[]|_|/|\bin\s)\s*(?P<unit>[^_]+?)[)\]]?)?", re.IGNORECASE
)
"""A name and, in brackets, after an underscore, a slash or the word in, a unit."""

FIELD = re.compile(r"[^\s(\[]+(?:\s*[(\[][^)\]]*[)\]])?")
"""A label without blanks, but for one before its bracket."""


@dataclass(frozen=True, slots=True)
class Label:
    """What stands above a column: its name, and its unit or nothing."""

    name: str
    unit: str

    @property
    def words(self) -> set[str]:
        """The words of the name."""
        return set(re.findall(r"[^\W\d_]+", self.name.lower()))

    @property
    def of_time(self) -> bool:
        """Whether the column is one of times."""
        return bool(self.words & TIMES) or self.unit.lower() in SECONDS

    @property
    def quantity(self) -> str:
        """What else the column is of, or nothing."""
        found = (quantity for quantity, name in QUANTITIES.items() if name.search(self.name))
        return next(found, "another quantity" if self.words & OTHERS else "")


@dataclass(frozen=True, slots=True)
class Header:
    """What stands beside the numbers.

    Attributes
    ----------
    second : float
        Unit of the times [s].
    unit : float
        Unit of the accelerations [m/s2].
    named : bool
        Whether a line says which column is which.
    """

    second: float
    unit: float
    named: bool


def read_header(beside: Sequence[Line], separator: str | None, units: str | None) -> Header:
    """Read the lines beside the numbers of a table.

    Parameters
    ----------
    beside : sequence of Line
    separator : str or None
        What separates the columns; None for blanks.
    units : str or None
        The unit that was given.

    Raises
    ------
    ValueError
        If the columns are not said to be time and acceleration in this order, or a unit is not
        known, or doubtful.
    """
    found = [(line, labels) for line in beside if (labels := _labels(line.text, separator))]
    if not found:
        check_quantity(beside)
        return Header(_unstated_second(beside), unit_of(beside, units), named=False)
    line, (time, other) = found[-1]
    if other.of_time or not time.of_time or other.quantity not in ("acceleration", ""):
        where = f"line {line.number}: its columns are {shown(time.name)} and {shown(other.name)}"
        raise ValueError(f"{where}; they must be time and acceleration, in this order")
    if not other.quantity and other.words != {"a"}:
        check_quantity(beside)
    stated = [Line(line.number, f"units: {other.unit}")] if is_unit(other.unit) else []
    second = _second(time.unit, line.number) if time.unit else _unstated_second(beside)
    return Header(second, unit_of([*beside, *stated], units), named=True)


def _labels(text: str, separator: str | None) -> tuple[Label, Label] | None:
    """Return what a line says of two columns, or None if it speaks of something else."""
    remarks = text.lstrip()[:1] in ("#", "%")
    plain = re.sub(r"\s*/\s*", "/", text.strip("#% \t")).replace("_s2", "/s2").replace('"', "")
    mark = next((mark for mark in (separator, ",", ";", "\t") if mark and mark in plain), None)
    fields = plain.split(mark) if mark else FIELD.findall(plain.replace(" in ", "/"))
    labels = [_label(field.strip()) for field in fields]
    if len(labels) != 2:
        return None
    first, second = labels
    heads = not remarks and (bool(second.quantity) or mark == separator is not None)
    return (first, second) if first.of_time or second.of_time or heads else None


def _label(field: str) -> Label:
    match = LABEL.fullmatch(field)
    return Label(match["name"], (match["unit"] or "").strip(" .")) if match else Label(field, "")


def _second(stated: str, line: int) -> float:
    """Return the unit of time [s] that a label states."""
    if stated.lower() not in SECONDS:
        raise ValueError(f"line {line}: its times are in {shown(stated)}; they must be in s or ms")
    return SECONDS[stated.lower()]


def _unstated_second(beside: Sequence[Line]) -> float:
    """Return the unit of time [s] where no label states one: a second, unless others are named."""
    for line in beside:
        if found := SHORTER.search(line.text):
            problem = f"line {line.number} speaks of {found[0]}"
            raise ValueError(f"{problem}; a name above the times must state their unit, s or ms")
    return 1.0
