"""The frames, the slides and the floors that every engine is asked about."""

import itertools
import math
from collections.abc import Iterator, Sequence
from dataclasses import fields
from typing import Any

import numpy as np

from analytic import Delayed, RigidBlock, SlidingBlock, Still
from analytic.block import GRAVITY
from analytic.motion import Motion, SinePulse
from analytic.record import Record
from engines.layouts import System
from engines.parts.factors import DEFAULT
from studies.old.jobs import Job
from studies.scenes.frames import frames
from studies.scenes.places import PULSES
from studies.sources.registry import resolve

FRICTIONS = (0.1, 0.2, 0.3)
RIDE = SinePulse(amplitude=1.0, omega=2.0 * math.pi, half_cycles=4)
"""Of a floor, which a block with a friction of 1 rides over 0.32 m."""

RESTS_S = (0.0, 1.0)
"""For how long all is at rest before a floor moves [s]."""

HELD_S = 2.0
"""How long a base is accelerated by less than what friction holds [s]."""


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return the job of every case and source: of frames first.

    Parameters
    ----------
    sources : sequence of str
        exact, and names of engines; each scene leaves out those that are not asked about it.
    quick : bool
        Fewer cases of all scenes but the floors.

    Returns
    -------
    list of Job
        Its label scene is a key of `studies.scenes.KINDS`.

    Raises
    ------
    BadInputError
        If a source is neither exact nor an engine: other sources know no slides.
    """
    beyond = [*slides(sources, quick), *floors(sources), *blocks(sources, quick)]
    return [*frames(sources, quick), *beyond]


def slides(sources: Sequence[str], quick: bool) -> Iterator[Job]:
    """Yield the jobs of blocks that slide; steps that land on impacts are not asked."""
    sine = SinePulse.in_g(0.4, omega=2.0 * math.pi, half_cycles=2)
    posed: list[tuple[str, System, Motion, dict[str, Any]]] = [
        (f"sine, friction {friction:g}", flat(friction), sine, {})
        for friction in (FRICTIONS[1:2] if quick else FRICTIONS)
    ]
    cube = SlidingBlock(width=1.0, height=1.0, friction=0.5)
    posed.append(("launched at 6 m/s, friction 0.5", cube, Still(), {"start": (0.0, 6.0)}))
    posed.append(("held at 0.9 of friction 0.2", flat(0.2), held(0.2), {}))
    for name, box, motion, options in posed:
        for source in sources:
            if not resolve(source).lands:
                labels = {"scene": "slide", "case": name}
                yield Job(labels=labels, block=box, motion=motion, source=source, options=options)


def floors(sources: Sequence[str]) -> Iterator[Job]:
    """Yield the jobs of a block on a floor that moves, as documented but in every way there is."""
    for source in sources:
        asked = resolve(source)
        if asked.engine and asked.preset == DEFAULT and asked.used.frame == "world":
            for floor, rest_s in itertools.product(ways(asked.used.settings), RESTS_S):
                yield Job(
                    labels={"scene": "floor", "floor": floor, "rest_s": rest_s},
                    block=flat(1.0),
                    motion=Delayed(RIDE, rest_s) if rest_s else RIDE,
                    source=source,
                    options={"settings": {"floor": floor}},
                )


def blocks(sources: Sequence[str], quick: bool) -> Iterator[Job]:
    """Yield the jobs of a block that rocks on a floor which engines move as documented."""
    block = RigidBlock(width=0.5, height=1.5)
    for (amplitude_g, omega), half_cycles in itertools.product(PULSES[: 1 if quick else 3], (1, 2)):
        labels = {"scene": "block", "amplitude_g": amplitude_g, "omega": omega}
        pulse = SinePulse.in_g(amplitude_g, omega=omega, half_cycles=half_cycles)
        for source in sources:
            asked = resolve(source)
            if asked.engine and asked.used.frame == "world":
                said = {**labels, "half_cycles": half_cycles}
                yield Job(labels=said, block=block, motion=pulse, source=source)


def ways(settings: Any) -> tuple[str, ...]:
    """Return in which ways an engine's floor can be moved."""
    known = {item.name: item.metadata["allowed"] for item in fields(settings) if item.metadata}
    return tuple(known["floor"].names)


def flat(friction: float) -> SlidingBlock:
    """Return a block of 1 x 0.5 m."""
    return SlidingBlock(width=1.0, height=0.5, friction=friction)


def held(friction: float) -> Record:
    """Return a base that is accelerated at 0.9 of what friction holds."""
    return Record(dt=HELD_S, samples=np.full(2, 0.9 * friction * GRAVITY))
