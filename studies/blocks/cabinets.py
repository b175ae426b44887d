"""A list of blocks as a table: name, width and height, perhaps friction, and further columns."""

import csv
import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from pathlib import Path
from reprlib import repr as shown
from typing import Literal

from analytic.block import RigidBlock
from analytic.slide import SlidingBlock
from analytic.text import is_number, lines_of
from studies.cases.refusal import BadInputError
from studies.kit.scene_options import MOST_M

Unit = Literal["m", "cm", "mm", "in"]
UNITS: Mapping[str, float] = {"m": 1.0, "cm": 0.01, "mm": 1e-3, "in": 0.0254}
"""Unit of a size -> m."""
NEEDED = ("name", "width", "height")
HEAD = re.compile(r"(width|height)[\s_,]*[(\[]?(mm|cm|m|in)[)\]]?")
"""The name of a column that states its unit."""
SKIPPED = re.compile(r"\s*#|sep=.$")
"""Lines that belong to no table: comments, and how a spreadsheet names its separator."""
MEANT = ("friction", "friction coefficient", "friction_coefficient", "cof", "mu", "µ", "μ")
"""Names of a column that may be meant as friction."""
THOUSANDS = re.compile(r"[1-9]\d{0,2}([.,]\d{3})+([.,]\d*)?")

Cells = Mapping[str, str]


@dataclass(frozen=True, slots=True, kw_only=True)
class Cabinet:
    """A block of a list, in metres, with the friction of its base where that is given."""

    name: str
    width_m: float
    height_m: float
    friction: float | None = None
    further: Cells = field(default_factory=dict)  # cells of columns of other names

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


def read_cabinets(path: Path, unit: Unit = "m", taken: Sequence[str] = ()) -> list[Cabinet]:
    """Read a list, separated by commas, semicolons or tabs; BadInputError names what is wrong."""
    found, bad = dict[str, Cabinet](), dict[tuple[str, str], list[tuple[int, str]]]()
    try:
        if path.suffix.lower() in (".xlsx", ".xls", ".ods", ".numbers"):
            raise ValueError("it must be text; a spreadsheet saves it as CSV in UTF-8")
        lines = ["" if SKIPPED.match(line) else line for line in lines_of(path)]
        for line, cells, units in _rows(lines, unit, taken):
            try:
                cabinet = _cabinet(cells, units)
                if cabinet.name in found:
                    raise _bad("name", cabinet.name, "be each block's own")
                found[cabinet.name] = cabinet
            except ValueError as error:
                said, allowed = error.args
                same = bad.setdefault((said.partition(" ")[0], allowed), [])
                same.append((line, f"{said}; it must {allowed}"))
        if not found and not bad:
            raise ValueError("it has no rows; it must have a block a line below the names")
        problems = []
    except (ValueError, csv.Error) as error:
        problems = [str(error)]
    for (line, said), *others in bad.values():
        more = f" and {len(others)} more" if others else ""
        problems.append(f"line {line}{more}: {said}")
    if problems:
        raise BadInputError(f"the list is {str(path)!r}; {'; '.join(problems)}")
    return [*found.values()]


def _rows(
    lines: Sequence[str], unit: Unit, taken: Sequence[str]
) -> Iterator[tuple[int, Cells, Cells]]:
    """Yield the line that each row ends on, its cells by their columns, and the columns' units."""
    filled = [at for at, line in enumerate(lines) if line.strip()] or [0]
    named = (at for at in filled if all(word in lines[at].lower() for word in NEEDED))
    begin = next(named, filled[0])
    separator = max((",", ";", "\t"), key=lines[begin].count)
    ended = (f"{line}\n" for line in lines[begin:])  # a name may hold the end of a line
    reader = csv.reader(ended, delimiter=separator, skipinitialspace=True, strict=True)
    rows = ([word.strip() for word in row] for row in reader if any(map(str.strip, row)))
    heads, units = list[str](), dict[str, str]()
    for word in next(rows, []):
        stated = HEAD.fullmatch(word.lower())
        plain = stated[1] if stated else word.lower()
        heads.append(plain if plain in (*NEEDED, "friction") else word)
        units[heads[-1]] = stated[2] if stated else unit
    while heads[-1:] == [""]:
        heads.pop()
    if not {*NEEDED} <= {*heads} or len(heads) > len({*heads}):
        words = "name, width and height, and may be friction and others, each once"
        raise ValueError(f"it has the columns {', '.join(heads)!r}; they must be {words}")
    for head in {*heads} - {*NEEDED, "friction"}:
        if head in taken:
            raise ValueError(
                f"its column {head!r} must be renamed, since the results have a column of that name"
            )
        if not head or head.lower() in MEANT or get_close_matches(head.lower(), MEANT, cutoff=0.7):
            raise ValueError(f"its column {shown(head)} must have a name, friction if it is that")
    for row in rows:
        while len(row) > len(heads) and not row[-1]:
            row.pop()
        whole = len(row) == len(heads)
        yield reader.line_num, dict(zip(heads, row, strict=True)) if whole else {}, units


def _cabinet(cells: Cells, units: Cells) -> Cabinet:
    """Return the block of a line; ValueError says its first bad value, and what it must do."""
    if not cells:
        words = "have one for each column; decimal commas need semicolons between columns"
        raise ValueError("it has more cells or fewer than the names", words)
    if not (0 < len(name := cells["name"]) <= 300 and name.isprintable()):
        raise _bad("name", name, "be 1 to 300 letters, without ends of lines, tabs and the like")
    width, height = (_number(cells, name, units[name]) for name in NEEDED[1:])
    friction = _number(cells, "friction") if cells.get("friction") else None
    further = {head: cells[head] for head in cells if head not in (*NEEDED, "friction")}
    return Cabinet(name=name, width_m=width, height_m=height, friction=friction, further=further)


def _number(cells: Cells, column: str, unit: str = "") -> float:
    """Return a size in metres, or a friction; a decimal comma is one."""
    word = cells[column]
    plain, scale = word.replace(",", "."), UNITS.get(unit, 1.0)
    low, high = (1e-3, MOST_M) if unit else (1e-3, 1e6)  # no base is smoother
    value = scale * float(plain) if is_number(plain) else math.nan
    if unit not in ("", "m") and THOUSANDS.fullmatch(word):
        raise _bad(column, word, f"be in {unit} without a mark between thousands")
    if not low <= value <= high:
        allowed = f"be from {low / scale:.6g} to {high / scale:.6g} {unit}".rstrip()
        large = unit == "m" and value > high
        raise _bad(column, word, f"{allowed}; --unit mm takes millimetres" if large else allowed)
    return value


def _bad(column: str, value: str, allowed: str) -> ValueError:
    return ValueError(f"{column} is {shown(value)}", allowed)
