"""A list of blocks as a table: name, width and height, and perhaps friction and tilt."""

import csv
import math
import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from analytic.accelerograms.text import lines_of, number, shown
from analytic.block import RigidBlock
from analytic.slide import SlidingBlock
from studies.cases.refusal import BadInputError
from studies.old.standing import MOST_M

COLUMNS = ("name", "width", "height", "friction", "tilt")
NEEDED = COLUMNS[:3]
LEAST_M = 1e-3
"""Least size [m] of a block of a list."""
LEAST_FRICTION = 1e-3
"""Least coefficient of friction: no base is smoother."""
MOST_LETTERS = 300
"""Letters of a name."""
UNSEEN = re.compile("[\x00-\x1f\x7f-\x9f\u061c\u200b\u200e\u200f\u2028-\u202e\u2066-\u2069\ufeff]")
"""What no reader sees, or what turns the direction of the text around it."""
SEPARATORS = (",", ";", "\t")
SHOWN = 40
"""Bad values that a refusal names; it is one line."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Cabinet:
    """A block of a list, in metres; friction of its base and a tilt over α where they are given."""

    name: str
    width_m: float
    height_m: float
    friction: float | None = None
    tilt: float | None = None

    @property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=self.width_m, height=self.height_m)

    @property
    def system(self) -> RigidBlock | SlidingBlock:
        """The block, or the one that slides: it stands upright, and its friction is below B/H."""
        size, friction = {"width": self.width_m, "height": self.height_m}, self.friction
        if self.tilt or friction is None or not friction < self.width_m / self.height_m:
            return self.block
        return SlidingBlock(**size, friction=friction)

    @property
    def start(self) -> tuple[float, float]:
        """Rotation [rad] and rate [rad/s] from which it starts."""
        return (self.tilt or 0.0) * self.block.alpha, 0.0


class Bad(NamedTuple):
    """A value of a list that cannot be used: its column, what is allowed there, and where."""

    column: str
    allowed: str
    line: int
    value: str


def read_cabinets(path: Path) -> list[Cabinet]:
    """Read a list of blocks: a table with a line of names, separated by commas, semicolons or tabs.

    Raises
    ------
    BadInputError
        One line that names all that is wrong: each line, column and value, and what is allowed.
    """
    try:
        lines = lines_of(path)
        heads, rows = _table(lines)
    except (ValueError, csv.Error) as error:
        raise BadInputError(f"the list is {str(path)!r}; {error}") from error
    cells = [dict(zip(heads, row, strict=False)) for _, row in rows]
    seen: set[str] = set()
    bad: list[Bad] = []
    for (at, row), each in zip(rows, cells, strict=True):
        name = each.get("name", "")
        bad += _problems(at, row, heads, repeated=name in seen)
        seen.add(name)
    if bad:
        raise BadInputError(f"the list is {str(path)!r}; {_said(bad)}")
    return [
        Cabinet(
            name=each["name"],
            width_m=float(each["width"]),
            height_m=float(each["height"]),
            **{name: float(each[name]) for name in ("friction", "tilt") if each.get(name)},
        )
        for each in cells
    ]


def _table(lines: Sequence[str]) -> tuple[list[str], list[tuple[int, list[str]]]]:
    """Return the names of the columns, and the rows that are not empty with their lines."""
    head = next((line for line in lines if line.strip()), "")
    separator = max(SEPARATORS, key=head.count)
    ended = (f"{line}\n" for line in lines)  # a name may hold the end of a line
    reader = csv.reader(ended, delimiter=separator, skipinitialspace=True, strict=True)
    rows = [(reader.line_num, [word.strip() for word in row]) for row in reader if any(row)]
    heads = [name.lower() for name in rows[0][1]] if rows else []
    for name in heads:
        if name not in COLUMNS:
            words = f"{', '.join(NEEDED)}, and may be friction and tilt"
            raise ValueError(f"it has a column {shown(name)}; its columns must be {words}")
        if heads.count(name) > 1:
            raise ValueError(f"it has the column {name} twice; each may be there once")
    if missing := [name for name in NEEDED if name not in heads]:
        words = "its first line must name name, width and height, in metres"
        raise ValueError(f"it has no column {' and '.join(missing)}; {words}")
    if len(rows) < 2:
        raise ValueError("it has no rows; it must have a block a line below the names")
    return heads, rows[1:]


def _problems(at: int, row: list[str], heads: Sequence[str], repeated: bool) -> Iterator[Bad]:
    """Yield what is wrong with a row, and if its name stands in one above."""
    if len(row) != len(heads):
        yield Bad("the number of values", f"{len(heads)}, one a column", at, str(len(row)))
        return
    cells = dict(zip(heads, row, strict=True))
    name = cells["name"]
    if not name or repeated:
        yield Bad("name", "each block's own" if name else "a word", at, name)
    elif len(name) > MOST_LETTERS or UNSEEN.search(name):
        allowed = f"at most {MOST_LETTERS} letters, without control characters"
        yield Bad("name", f"{allowed} (ends of lines, tabs, marks of direction)", at, name)
    sizes = {name: _number(cells[name]) for name in ("width", "height")}
    for name, size in sizes.items():
        if not LEAST_M <= size <= MOST_M:
            meant = f" ({1e-3 * size:g} for {size:g} mm?)" if MOST_M < size < math.inf else ""
            yield Bad(name, f"from {LEAST_M:g} to {MOST_M:g} m{meant}", at, cells[name])
    if cells.get("friction") and not LEAST_FRICTION <= _number(cells["friction"]) < math.inf:
        allowed = f"a finite number of at least {LEAST_FRICTION:g}, or empty"
        yield Bad("friction", allowed, at, cells["friction"])
    if not cells.get("tilt"):
        return
    # where a size is bad, too, it is not known how far the block could lean
    lying = 0.5 * math.pi / (math.atan2(sizes["width"], sizes["height"]) or math.nan)
    if not abs(_number(cells["tilt"])) < (math.inf if math.isnan(lying) else lying):
        most = "" if math.isnan(lying) else f" between -{lying:.6g} and {lying:.6g} α"
        yield Bad("tilt", f"a finite number{most}, or empty", at, cells["tilt"])


def _number(word: str) -> float:
    try:
        return number(word, 0)
    except ValueError:
        return math.nan


def _point(column: str, items: Sequence[Bad]) -> str:
    comma = column != "name" and any("," in item.value for item in items)
    return ", with a decimal point" if comma else ""


def _said(bad: Sequence[Bad]) -> str:
    """Return what is wrong, once for all values of a column of which the same is allowed."""
    groups: dict[tuple[str, str], list[Bad]] = {}
    for item in sorted(bad[:SHOWN], key=lambda item: item.line):
        groups.setdefault((item.column, item.allowed), []).append(item)
    words = [
        f"{', '.join(f'line {item.line}: {column} is {shown(item.value)}' for item in items)}; "
        f"it must be {allowed}{_point(column, items)}"
        for (column, allowed), items in groups.items()
    ]
    more = [f"{len(bad) - SHOWN} more values cannot be used"] if len(bad) > SHOWN else []
    return "; ".join([*words, *more])
