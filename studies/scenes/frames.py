"""Columns that carry a beam: the cases, usual ones and extreme ones."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence

from analytic import RockingFrame
from analytic.motion import SinePulse
from studies.old.jobs import Job
from studies.scenes.places import PULSES, placed

LOADS, COLUMNS = (0.5, 2.0, 4.0), (2, 3)

EXTREMES = ((2, 1e-3), (2, 0.1), (2, 10.0), (2, 1e3), (5, 2.0))
"""Columns and load of frames that are told by themselves, under the first pulse."""

PHASES = 4
"""Where in a step an impact falls costs per mille: so many runs at steps that differ by a hair."""

REFINED = (4.0, 2.0, 0.5)
"""Steps over an engine's own at which `ASKED_AGAIN` is asked again, under the first pulse."""

ASKED_AGAIN = (2, 2.0)

AGAIN = {"columns": 2, "load": 2.0, "amplitude_g": PULSES[0][0]}
"""The case that is asked in several steps, by its labels."""

SEEN = ("parting", "tilt", "drift_m")
"""Observables of a frame that are told."""


def usual(sources: Sequence[str], quick: bool) -> Iterator[Job]:
    """Yield the jobs of the usual frames under pulses; of one where it has to be quick."""
    cases = itertools.product(LOADS, COLUMNS, PULSES)
    for load, columns, pulse in [(*ASKED_AGAIN[::-1], PULSES[0])] if quick else cases:
        yield from _jobs(columns, load, pulse, sources, 2 if quick else PHASES)


def frames(sources: Sequence[str], quick: bool) -> Iterator[Job]:
    """Yield the jobs of all frames: beside the usual ones the extreme, and one in other steps.

    Parameters
    ----------
    sources : sequence of str
        Names that `studies.sources.registry.resolve` knows.
    quick : bool
        One usual frame alone.

    Yields
    ------
    Job
        Its labels are scene, columns, load, amplitude_g, omega, refined (step over the engine's
        own), extreme and phase (which of the steps that are tried).
    """
    yield from usual(sources, quick)
    for columns, load in () if quick else EXTREMES:
        yield from _jobs(columns, load, PULSES[0], sources, PHASES, extreme=True)
    for refined in () if quick else REFINED:
        yield from _jobs(*ASKED_AGAIN, PULSES[0], sources, PHASES, refined=refined)


def _jobs(
    columns: int,
    load: float,
    pulse: tuple[float, float],
    sources: Sequence[str],
    phases: int,
    *,
    refined: float = 1.0,
    extreme: bool = False,
) -> Iterator[Job]:
    posed = {"columns": columns, "load": load, "amplitude_g": pulse[0], "omega": pulse[1]}
    for source in sources:
        job = Job(
            labels={"scene": "frame", **posed, "refined": refined, "extreme": extreme},
            block=RockingFrame(width=0.5, height=1.5, columns=columns, load=load),
            motion=SinePulse.in_g(pulse[0], omega=pulse[1], half_cycles=2),
            source=source,
        )
        yield from placed(job, phases, refined)
