"""A scene written out for somebody who has an engine's library alone.

What is written is what was called: an adapter builds its scene once more with a library whose calls
are noted, so that a script cannot say anything else than a run does. Its function then names what
was made, and adds the lines that take a step and read the pose::

    def script(scene, settings, dt_s):
        notes = Notes()
        world = PymunkWorld(scene, settings, dt_s, notes.of(imported("pymunk"), "pymunk"))
        notes.name(space=world.space, floor=world.base)
        notes.name_bodies(scene, world.bodies)
        return Script(
            imports=("import pymunk",),
            settings=(f"space.step({dt_s!r})", *notes.quoted("iterations", ".friction")),
            build=notes.lines(),
            step=("space.gravity = pull_x, pull_z", "space.step(DT)"),
            pose=("theta, rate = -bodies[number].angle, -bodies[number].angular_velocity",),
            place="bodies[0].position.x",
            moment=world.moment,
        )

A call is written down where it changes something (it returns nothing) or makes an object, whose
name is that of the function until the adapter gives it another; an object that is used once, in the
next call, stands there. A call that returns numbers or words is a question, and is not written
down, but for ``create...``, ``add...`` and ``load...``, whose number stands for what they made.
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from textwrap import wrap
from typing import Any

import numpy as np

from engines.scene import Scene
from engines.world import Script

PLAIN = (bool, int, float, str, bytes, type(None))
MAKES = ("create", "add", "load")
"""How functions begin whose number stands for what they made."""

TOKEN = re.compile("\x02(\\d+)\x03")
"""What stands for the name of a noted object until the lines are written."""

NUMBERED = re.compile(r"_\d+\b")
WIDTH = 99


@dataclass(slots=True)
class _Made:
    """An object that a call made: in which line, by which function, and where it is used."""

    line: int
    function: str
    uses: list[int] = field(default_factory=list)
    name: str = ""


class Notes:
    """What is done to a library, as lines of Python.

    Parameters
    ----------
    without : sequence of str, optional
        Arguments by keyword that are not written down.
    """

    def __init__(self, without: Sequence[str] = ()) -> None:
        self._without = without
        self._lines: list[str] = []
        self._made: list[_Made] = []
        self._known: dict[int, Noted] = {}

    def of(self, it: Any, name: str) -> Any:
        """Return a library, or a part of one, of which all is noted that is done to it."""
        return Noted(self, it, name)

    def name(self, **made: Any) -> None:
        """Give what was made names: one object, or several, which are numbered from 2 on."""
        for name, objects in made.items():
            each = objects if isinstance(objects, list | tuple) else [objects]
            for number, it in enumerate(each, 1):
                self._made[_number(it)].name = name if number == 1 else f"{name}_{number}"

    def name_bodies(self, scene: Scene, bodies: Sequence[Any]) -> None:
        """Give bodies names, of a block or of columns and a beam, and list them as `bodies`."""
        *below, top = bodies
        self.name(**({"column": below, "beam": top} if below else {"block": top}))
        self.listed(bodies=bodies)

    def listed(self, **made: Sequence[Any]) -> None:
        """Note lines by which what was made is in a list of a name."""
        for name, objects in made.items():
            self._lines.append(f"{name} = {self.said(list(objects))}")

    def lines(self) -> tuple[str, ...]:
        """Return the lines, as wide as those of this project at most."""
        return tuple(part for line in self._whole() for part in broken(line))

    def quoted(self, *words: str) -> tuple[str, ...]:
        """Return the lines in which one of some words stands, of those that are alike the first."""
        found: dict[str, str] = {}
        for line in self._whole():
            if any(word in line for word in words):
                found.setdefault(NUMBERED.sub("", line), line)
        return tuple(part for line in found.values() for part in broken(line))

    def _whole(self) -> list[str]:
        """Return the lines, long ones unbroken."""
        inside = self._inside()
        counts: Counter[str] = Counter(each.name for each in self._made if each.name)
        names: dict[int, str] = {}
        for number, each in enumerate(self._made):
            counts[each.function] += not each.name and number not in inside
            count = counts[each.function]
            usual = each.function if count == 1 else f"{each.function}_{count}"
            names[number] = each.name or usual

        def said(found: re.Match[str]) -> str:
            number = int(found[1])
            if number not in inside:
                return names[number]
            call = self._lines[self._made[number].line].partition(" = ")[2]
            return TOKEN.sub(said, call)

        gone = {self._made[number].line for number in inside}
        return [TOKEN.sub(said, line) for n, line in enumerate(self._lines) if n not in gone]

    def said(self, value: Any) -> str:
        """Return a value as Python; TypeError unless it is plain or was made by what is noted."""
        if isinstance(value, Noted | Constant):
            text = str(value.noted_name)
            for found in TOKEN.finditer(text):
                self._made[int(found[1])].uses.append(len(self._lines))
            return text
        if isinstance(value, np.ndarray):
            return f"np.array({self.said(value.tolist())})"
        if isinstance(value, np.generic):
            value = value.item()
        if isinstance(value, float):
            return re.sub(r"(inf|nan)", r"math.\1", repr(float(value)))
        if isinstance(value, PLAIN):
            return repr(value)
        if isinstance(value, dict):
            return f"{{{', '.join(f'{key!r}: {self.said(it)}' for key, it in value.items())}}}"
        if isinstance(value, list):
            return f"[{', '.join(map(self.said, value))}]"
        if isinstance(value, tuple):
            return f"({', '.join(map(self.said, value))}{',' * (len(value) == 1)})"
        if isinstance(value, slice):
            return ":".join("" if it is None else self.said(it) for it in (value.start, value.stop))
        if callable(value) and type(value).__name__ == "function":
            return str(value.__name__)  # an adapter's own, which its script defines
        raise TypeError(f"{value!r} is no value that can be written down")

    def write(self, line: str) -> None:
        """Note a line."""
        self._lines.append(line)

    def called(self, function: "Noted", given: Sequence[Any], named: Mapping[str, Any]) -> Any:
        """Call a function, note it, and return what it returns, noted."""
        it = bare(function)(*map(bare, given), **{key: bare(one) for key, one in named.items()})
        kind = str(function.noted_name).rpartition(".")[2]
        plain = it is not None and isinstance(it, PLAIN) and not kind.startswith(MAKES)
        if plain or isinstance(it, np.ndarray):
            return it
        shown = [
            f"{key}={self.said(one)}" for key, one in named.items() if key not in self._without
        ]
        call = f"{self.said(function)}({', '.join([*map(self.said, given), *shown])})"
        if it is None or id(it) in self._known:
            self._lines.append(call)
            return self._known.get(id(it))
        several = list(it) if type(it) in (list, tuple) else [it]
        made = [self._object(each, kind) for each in several]
        self._lines.append(f"{', '.join(str(each.noted_name) for each in made)} = {call}")
        return type(it)(made) if type(it) in (list, tuple) else made[0]

    def found(self, it: Any, name: str) -> Any:
        """Return a part of something noted: a plain value as it is, or named where it is fixed."""
        if isinstance(it, PLAIN):
            return constant(it, name) if name.rpartition(".")[2].isupper() else it
        if type(it) in (list, tuple):
            return type(it)(self.found(each, f"{name}[{n}]") for n, each in enumerate(it))
        return self._known.get(id(it)) or Noted(self, it, name)

    def _object(self, it: Any, function: str) -> Any:
        name = f"\x02{len(self._made)}\x03"
        self._made.append(_Made(len(self._lines), function.lower()))
        if isinstance(it, PLAIN):
            return constant(it, name)
        self._known[id(it)] = noted = Noted(self, it, name)
        return noted

    def _inside(self) -> set[int]:
        """Return the numbers of objects that stand where they are used, without a name."""
        inside, gone = set[int](), set[int]()
        for number in reversed(range(len(self._made))):
            each = self._made[number]
            alone = sum(other.line == each.line for other in self._made[number - 1 : number + 2])
            if each.name or len(each.uses) != 1 or alone > 1:
                continue
            if gone.issuperset(range(each.line + 1, each.uses[0])):
                inside.add(number)
                gone.add(each.line)
        return inside


class Noted:
    """An object of a library; what is done to it is done, and noted under its name."""

    def __init__(self, notes: Notes, it: Any, name: str) -> None:
        for key, value in (("notes", notes), ("it", it), ("name", name)):
            object.__setattr__(self, f"noted_{key}", value)

    noted_notes: Notes
    noted_it: Any
    noted_name: str

    def __getattr__(self, name: str) -> Any:
        return self.noted_notes.found(getattr(self.noted_it, name), f"{self.noted_name}.{name}")

    def __setattr__(self, name: str, value: Any) -> None:
        text = self.noted_notes.said(self)
        self.noted_notes.write(f"{text}.{name} = {self.noted_notes.said(value)}")
        setattr(self.noted_it, name, bare(value))

    def __getitem__(self, key: Any) -> Any:
        text = f"{self.noted_name}[{self.noted_notes.said(key)}]"
        return self.noted_notes.found(self.noted_it[key], text)

    def __setitem__(self, key: Any, value: Any) -> None:
        text = f"{self.noted_notes.said(self)}[{self.noted_notes.said(key)}]"
        self.noted_notes.write(f"{text} = {self.noted_notes.said(value)}")
        self.noted_it[key] = bare(value)

    def __iter__(self) -> Iterator[Any]:
        return (self[number] for number in range(len(self.noted_it)))

    def __array__(self, *asked: Any, **named: Any) -> Any:
        return np.asarray(self.noted_it, *asked, **named)

    def __call__(self, *given: Any, **named: Any) -> Any:
        return self.noted_notes.called(self, given, named)


class Constant:
    """A number or word that a script writes as a name, or as a formula; see `constant`."""

    noted_name: str


def constant(value: Any, name: str) -> Any:
    """Return a plain value, which is written down as `name`."""
    if isinstance(value, bool | bytes | None):
        return value
    kind = type("Constant", (type(value), Constant), {"noted_name": name})
    return kind(value)


def bare(value: Any) -> Any:
    """Return what a library is given for what was noted."""
    if isinstance(value, Noted):
        return value.noted_it
    if isinstance(value, Constant):
        return type(value).__mro__[1](value)
    if type(value) in (list, tuple):
        return type(value)(map(bare, value))
    if type(value) is dict:
        return {key: bare(it) for key, it in value.items()}
    return value


def scaled(name: str, unit: float) -> str:
    """Return a length of a script in units of which there are so many in a metre."""
    return name if unit == 1.0 else f"{name} * {unit!r}"


def broken(line: str) -> list[str]:
    """Return a line as several where it is too long, each break after a comma."""
    text = re.sub(r"(?<!,) ", "\x04", line)
    parts = wrap(
        text, WIDTH, subsequent_indent=" " * 4, break_long_words=False, break_on_hyphens=False
    )
    return [part.replace("\x04", " ") for part in parts]


def _number(it: Any) -> int:
    """Return the number of a noted object that a call made."""
    found = TOKEN.fullmatch(str(getattr(it, "noted_name", "")))
    if found is None:
        raise TypeError(f"{it!r} was not made by a call that is noted")
    return int(found[1])


__all__ = ["Notes", "Script", "constant", "scaled"]
