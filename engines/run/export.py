"""A scene written out for somebody who has an engine's library alone.

What is written is what was called: an adapter builds its scene once more with a library whose calls
are noted, names what was made, and adds the lines that take a step and read the pose::

    notes = Notes()
    world = PymunkWorld(scene, settings, dt_s, notes.of(imported("pymunk"), "pymunk"))
    notes.name(space=world.space, floor=world.base)
    notes.name_bodies(world.bodies)
    return Script(imports=("import pymunk",), build=notes.lines(), ...)

A call is written down where it changes something (it returns nothing) or makes an object, whose
name is that of the function until the adapter gives it another; an object that is used once, in the
next call, stands there. A call that returns numbers, words or an array is a question, and is not
written down, but for ``create...``, ``add...`` and ``load...``, whose number stands for what they
made. `constant` is a number that a script writes as a formula.
"""

import itertools
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from enum import Enum
from inspect import isfunction
from textwrap import wrap
from typing import Any

import numpy as np

PLAIN = (bool, int, float, str, type(None))
MAKING = re.compile("(create|add|load)_?")
"""How functions begin whose number stands for what they made."""

TOKEN = re.compile("\x02(\\d+)\x03")
"""What stands for the name of an object until the lines are written."""

LAST = re.compile("^[A-Z].*(?=[A-Z][a-z])")
"""All but the last word of the name of a class."""

NUMBERED = re.compile(r"_\d+\b")
WIDTH = 99


@dataclass(slots=True)
class _Made:
    """An object that a call made, and whether it is used as an argument `alone`, without a part."""

    function: str
    line: int
    name: str = ""
    uses: list[int] = field(default_factory=list)
    alone: bool = True


class Notes:
    """What is done to a library, as lines of Python, without some arguments by keyword."""

    def __init__(self, without: Sequence[str] = ()) -> None:
        self._without = without
        self._lines: list[tuple[str, Sequence[int]]] = []
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
                found = TOKEN.fullmatch(str(it.noted_name))
                if found is None:
                    raise TypeError(f"{it.noted_name} was not made by a call")
                self._made[int(found[1])].name = name if number == 1 else f"{name}_{number}"

    def name_bodies(self, bodies: Sequence[Any]) -> None:
        """Give bodies names, of a block or of columns and a beam, and list them as `bodies`."""
        *below, top = bodies
        self.name(**({"column": below, "beam": top} if below else {"block": top}))
        self.listed(bodies=bodies)

    def listed(self, **made: Sequence[Any]) -> None:
        """Note lines by which what was made is in a list of a name."""
        for name, objects in made.items():
            self.write(f"{name} = {self.said(list(objects))}")

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
        names = self._names(inside)

        def said(found: re.Match[str]) -> str:
            number = int(found[1])
            if number in inside:
                return TOKEN.sub(said, self._lines[self._made[number].line][0])
            return names[number]

        return [
            " = ".join(filter(None, (", ".join(names[it] for it in made), TOKEN.sub(said, call))))
            for call, made in self._lines
            if not inside.intersection(made)
        ]

    def _inside(self) -> set[int]:
        """Return the numbers of objects that stand where they are used, without a name."""
        inside, gone = set[int](), set[int]()
        for number, made in reversed([*enumerate(self._made)]):
            once = len(made.uses) == 1 and len(self._lines[made.line][1]) == 1
            between = range(made.line + 1, made.uses[0]) if once else ()
            if once and made.alone and not made.name and gone.issuperset(between):
                inside.add(number)
                gone.add(made.line)
        return inside

    def _names(self, inside: set[int]) -> list[str]:
        """Return the names of objects: given ones, or their function's; none where none is used."""
        taken, names = {made.name for made in self._made}, []
        for number, made in enumerate(self._made):
            usual = MAKING.sub("", made.function, count=1) or made.function
            free = (f"{usual}_{n}" if n > 1 else usual for n in itertools.count(1))
            needed = number not in inside and (made.uses or len(self._lines[made.line][1]) > 1)
            own = next(name for name in free if name not in taken) if needed else ""
            names.append(made.name or own)
            taken.add(names[-1])
        return names

    def said(self, value: Any, *, alone: bool = True) -> str:
        """Return a value as Python; TypeError unless it is plain or was made by what is noted."""
        if isinstance(value, Noted | Constant):
            text = str(value.noted_name)
            for found in TOKEN.finditer(text):
                made = self._made[int(found[1])]
                made.uses.append(len(self._lines))
                made.alone = made.alone and alone
            return text
        if isinstance(value, list):
            return f"[{', '.join(map(self.said, value))}]"
        if isinstance(value, tuple):
            return f"({', '.join(map(self.said, value))}{',' * (len(value) == 1)})"
        if isinstance(value, float):
            return re.sub("(inf|nan)", r"math.\1", repr(float(value)))
        if isinstance(value, PLAIN):
            return repr(value)
        if isfunction(value):
            return value.__name__  # an adapter's own, which its script defines
        raise TypeError(f"{value!r} is no value that can be written down")

    def write(self, line: str, made: Sequence[int] = ()) -> None:
        """Note a line, and the numbers of what it made."""
        self._lines.append((line, made))

    def called(self, function: "Noted", given: Sequence[Any], named: Mapping[str, Any]) -> Any:
        """Call a function, note it, and return what it returns, noted."""
        it = bare(function)(*map(bare, given), **{key: bare(one) for key, one in named.items()})
        *_, owner, name = "", *str(function.noted_name).split(".")
        name = owner if name == "copy" or name.startswith("from_") else name
        kind = LAST.sub("", name).lower()  # sphere of CollisionShapeSphere
        if isinstance(it, np.ndarray) or (isinstance(it, PLAIN[:-1]) and not MAKING.match(name)):
            return it
        shown = [
            f"{key}={self.said(one)}" for key, one in named.items() if key not in self._without
        ]
        arguments = ", ".join([*map(self.said, given), *shown])
        call = f"{self.said(function)}({arguments})"
        known = self._known.get(id(it))
        if it is None or known:
            self._lines += [] if known and name.lower().startswith("get") else [(call, ())]
            return known
        several = type(it) in (list, tuple)
        first = len(self._made)
        made = [self._object(each, kind) for each in (it if several else [it])]
        self.write(call, range(first, len(self._made)))
        return type(it)(made) if several else made[0]

    def _object(self, it: Any, function: str) -> Any:
        name = f"\x02{len(self._made)}\x03"
        self._made.append(_Made(function, len(self._lines)))
        if isinstance(it, PLAIN):
            return constant(it, name)
        self._known[id(it)] = noted = Noted(self, it, name)
        return noted

    def got(self, it: Any, text: str) -> Any:
        """Note how an object was got, and return it noted."""
        made = self._object(it, "body")
        self.write(text, [len(self._made) - 1])
        return made

    def found(self, it: Any, name: str) -> Any:
        """Return a part of something noted: a plain value as it is, or named where it is fixed."""
        if isinstance(it, PLAIN) and not isinstance(it, Enum):
            fixed = name.rpartition(".")[2].isupper() and type(it) in (int, float, str)
            return constant(it, name) if fixed else it
        if type(it) in (list, tuple):
            return type(it)(self.found(each, f"{name}[{n}]") for n, each in enumerate(it))
        return self._known.get(id(it)) or Noted(self, it, name)


class Noted:
    """An object of a library; what is done to it is done, and noted under its name."""

    noted_notes: Notes
    noted_it: Any
    noted_name: str

    def __init__(self, notes: Notes, it: Any, name: str) -> None:
        for key, value in (("notes", notes), ("it", it), ("name", name)):
            object.__setattr__(self, f"noted_{key}", value)

    def __getattr__(self, name: str) -> Any:
        return self.noted_notes.found(getattr(self.noted_it, name), f"{self.noted_name}.{name}")

    def __setattr__(self, name: str, value: Any) -> None:
        notes = self.noted_notes
        notes.write(f"{notes.said(self, alone=False)}.{name} = {notes.said(value)}")
        setattr(self.noted_it, name, bare(value))

    def __getitem__(self, key: Any) -> Any:
        notes = self.noted_notes
        found, text = self.noted_it[bare(key)], f"{self.noted_name}[{notes.said(key)}]"
        # what a call returned leads to an object like one that a call made
        return notes.got(found, text) if isinstance(key, Noted) else notes.found(found, text)

    def __call__(self, *given: Any, **named: Any) -> Any:
        """Call it, and note that it was called."""
        return self.noted_notes.called(self, given, named)


class Constant:
    """A number or word that a script writes as a name, or as a formula; see `constant`."""

    noted_name: str


def constant(value: Any, name: str) -> Any:
    """Return a number or a word that is written down as `name`."""
    return type("Constant", (type(value), Constant), {"noted_name": name})(value)


def bare(value: Any) -> Any:
    """Return what a library is given for what was noted."""
    if isinstance(value, Noted):
        return value.noted_it
    if isinstance(value, Constant):
        return type(value).__mro__[1](value)
    if type(value) in (list, tuple):
        return type(value)(map(bare, value))
    return value


def scaled(name: str, unit: float) -> str:
    """Return a length of a script in units of which there are so many in a metre."""
    return name if unit == 1.0 else f"{name} * {unit!r}"


def broken(line: str) -> list[str]:
    """Return a line as several where it is too long, each break after a comma of a call."""
    names, equals, call = line.partition(" = ")
    if "(" in names:  # no assignment
        names, equals, call = "", "", line
    text = f"{names}{equals}".replace(" ", "\x04") + re.sub(r"(?<!,) ", "\x04", call)
    parts = wrap(
        text, WIDTH, subsequent_indent=" " * 4, break_long_words=False, break_on_hyphens=False
    )
    return [part.replace("\x04", " ") for part in parts]
