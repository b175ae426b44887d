"""A script says what was called: run alone, it builds what the noted calls built."""

import math
from types import SimpleNamespace

import pytest

from engines.run.export import Notes, constant


class Body:
    def __init__(self, mass, *, shape=None):
        self.mass, self.shape = mass, shape

    def weigh(self):
        return self.mass


class Space:
    BOUNCY = 3

    def __init__(self):
        self.own = Body(math.inf)

    def put(self, body):
        self.last = body

    def create_part(self, body, sizes):
        body.parts = sizes
        return len(sizes)

    def pair(self):
        return Body(1.0), Body(2.0)


LIBRARY = SimpleNamespace(Space=Space, Body=Body, LARGE=1e3)


def build(library):
    space = library.Space()
    space.friction = constant(math.sqrt(0.3), "math.sqrt(0.3)")
    block = library.Body(2.0, shape=library.Body(library.LARGE))
    block.place = (block.weigh(), math.inf)
    space.own.mass = library.Space.BOUNCY
    space.put(block)
    number = space.create_part(block, sizes=[1, 2.0])
    left, right = space.pair()
    left.part = (number,)
    return space, block, [left, right]


def test_a_script_builds_what_was_built_and_reads_as_if_written_by_hand():
    notes = Notes()
    space, block, pair = build(notes.of(LIBRARY, "library"))
    notes.name(space=space, box=pair)
    notes.name_bodies([block])
    assert notes.lines() == (
        "space = library.Space()",
        "space.friction = math.sqrt(0.3)",
        "block = library.Body(2.0, shape=library.Body(library.LARGE))",
        "block.place = (2.0, math.inf)",
        "space.own.mass = library.Space.BOUNCY",
        "space.put(block)",
        "part = space.create_part(block, sizes=[1, 2.0])",
        "box, box_2 = space.pair()",
        "box.part = (part,)",
        "bodies = [block]",
    )
    assert notes.quoted("place", "friction") == (notes.lines()[1], notes.lines()[3])
    known = {"library": LIBRARY, "math": math}
    exec("\n".join(notes.lines()), known)
    space, block, (left, _) = build(LIBRARY)
    assert (known["space"].own.mass, known["space"].friction) == (3, space.friction)
    assert (known["block"].place, known["block"].shape.mass) == (block.place, 1e3)
    assert (known["box"].part, known["block"].parts) == (left.part, block.parts)


def test_what_no_call_made_cannot_be_written_down():
    notes = Notes()
    space = notes.of(LIBRARY, "library").Space()
    with pytest.raises(TypeError, match="no value that can be written down"):
        space.put(Body(1.0))
    with pytest.raises(TypeError, match="was not made by a call"):
        notes.name(own=space.own)
