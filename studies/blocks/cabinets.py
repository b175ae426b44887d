"""A list of blocks as a table: name, width and height, and perhaps friction."""

import csv
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from analytic.block import RigidBlock
from analytic.slide import SlidingBlock
from analytic.text import is_number, lines_of, shown
from studies.cases.refusal import BadInputError
from studies.kit.scene_options import MOST_M

NEEDED = ("name", "width", "height")
COLUMNS = (*NEEDED, "friction")
SHOWN = 10
"""Bad lines that a refusal names; it is one line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cabinet:
    """A block of a list, in metres, with the friction of its base where that is given."""

    name: str
    width_m: float
    height_m: float
    friction: float | None = None

    @property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=self.width_m, height=self.height_m)

    @property
    def system(self) -> RigidBlock | SlidingBlock:
        """The block, or the one that slides: its friction is below B/H."""
        friction = self.friction
        if friction is None or friction >= self.width_m / self.height_m:
            return self.block
        return SlidingBlock(width=self.width_m, height=self.height_m, friction=friction)


def read_cabinets(path: Path) -> list[Cabinet]:
    """Read a list, separated by commas, semicolons or tabs; BadInputError names every bad line."""
    found, bad = dict[str, Cabinet](), list[str]()
    try:
        for line, cells in _rows(lines_of(path)):
            try:
                cabinet = _cabinet(cells)
                if cabinet.name in found:
                    raise _bad("name", cabinet.name, "each block's own")
                found[cabinet.name] = cabinet
            except ValueError as error:
                bad.append(f"line {line}: {error}")
        if not found and not bad:
            raise ValueError("it has no rows; it must have a block a line below the names")
    except (ValueError, csv.Error) as error:
        bad.append(str(error))
    if bad:
        more = [f"{len(bad) - SHOWN} more lines cannot be used"] if len(bad) > SHOWN else []
        raise BadInputError(f"the list is {str(path)!r}; {'; '.join([*bad[:SHOWN], *more])}")
    return [*found.values()]


def _rows(lines: Sequence[str]) -> Iterator[tuple[int, dict[str, str]]]:
    """Yield the cells of each row by their columns, and the line that it ends on."""
    head = next((line for line in lines if line.strip()), "")
    separator = max((",", ";", "\t"), key=head.count)
    ended = (f"{line}\n" for line in lines)  # a name may hold the end of a line
    reader = csv.reader(ended, delimiter=separator, skipinitialspace=True, strict=True)
    rows = ([word.strip() for word in row] for row in reader if any(row))
    heads = [name.lower() for name in next(rows, [])]
    if not {*NEEDED} <= {*heads} <= {*COLUMNS} or len(heads) > len({*heads}):
        words = "name, width and height, in metres, and may be friction, each once"
        raise ValueError(f"it has the columns {', '.join(heads)!r}; they must be {words}")
    for row in rows:
        many = len(row) != len(heads)
        yield reader.line_num, {} if many else dict(zip(heads, row, strict=True))


def _cabinet(cells: Mapping[str, str]) -> Cabinet:
    """Return the block of a line; ValueError names its first bad value."""
    if not cells:
        raise ValueError("it must have a value for each column")
    if not (0 < len(name := cells["name"]) <= 300 and name.isprintable()):
        raise _bad("name", name, "1 to 300 letters, without ends of lines, tabs and the like")
    width, height = (_number(cells, name, 1e-3, MOST_M, " m") for name in NEEDED[1:])
    # no base is smoother
    friction = _number(cells, "friction", 1e-3, 1e6) if cells.get("friction") else None
    return Cabinet(name=name, width_m=width, height_m=height, friction=friction)


def _number(
    cells: Mapping[str, str], column: str, low: float, high: float, unit: str = ""
) -> float:
    word = cells[column]
    value = float(word) if is_number(word) else math.nan
    if not low <= value <= high:
        meant = f" ({1e-3 * value:g} for {value:g} mm?)" if unit == " m" and value > high else ""
        point = ", with a decimal point" if "," in word else ""
        raise _bad(column, word, f"from {low:.6g} to {high:.6g}{unit}{meant}{point}")
    return value


def _bad(column: str, value: str, allowed: str) -> ValueError:
    return ValueError(f"{column} is {shown(value)}; it must be {allowed}")
