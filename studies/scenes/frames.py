"""Columns that carry a beam: cases, usual ones and extreme ones, and the tables of them."""

from __future__ import annotations

import itertools
from collections.abc import Iterator, Sequence
from typing import Any, TypeAlias

import pandas as pd

from analytic import RockingFrame
from analytic.motion import SinePulse
from studies.kit.jobs import Job
from studies.measures.wrongness import counted, kinds_of, outcomes_of
from studies.scenes.places import PULSES, steps

LOADS, COLUMNS = (0.5, 2.0, 4.0), (2, 3)

EXTREMES = ((2, 1e-3), (2, 0.1), (2, 10.0), (2, 1e3), (5, 2.0))
"""Columns and load of frames that are told by themselves, under the first pulse."""

PHASES = 4
"""Where in a step an impact falls costs per mille: so many runs at steps that differ by a hair."""

REFINED = (4.0, 2.0, 0.5)
"""Steps over an engine's own at which `ASKED_AGAIN` is asked again, under the first pulse."""

ASKED_AGAIN = (2, 2.0)

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
    frame = RockingFrame(width=0.5, height=1.5, columns=columns, load=load)
    motion = SinePulse.in_g(pulse[0], omega=pulse[1], half_cycles=2)
    labels = {"scene": "frame", "columns": columns, "load": load}
    shaken = {"amplitude_g": pulse[0], "omega": pulse[1]}
    said = {**labels, **shaken, "refined": refined, "extreme": extreme}
    for source in sources:
        for phase, options in enumerate(steps(source, frame, motion, phases)):
            if options or refined == 1.0:
                yield Job(
                    labels={**said, "phase": phase},
                    block=frame,
                    motion=motion,
                    source=source,
                    options={name: refined * step for name, step in options.items()},
                )


Parts: TypeAlias = "Sequence[tuple[str, pd.DataFrame]]"
"""The rows of each source, of what it can hold."""


def frame_summary(parts: Parts) -> pd.DataFrame:
    """Return for each source how many of its usual frames are wrong, and how far off the others."""
    lines = []
    for source, part in parts:
        rows = part[(part["refined"] == 1.0) & ~part["extreme"].astype(bool)]
        seen = {name: rows[name].max() for name in SEEN}
        beyond = {"beyond_2_percent": int((rows["error"].abs() > 0.02).sum())}
        cost = {"ms_a_frame": 1e3 * rows["wall_s"].mean()}
        lines.append({"source": source, **_line(rows), **beyond, **seen, **cost})
    return pd.DataFrame(lines)


def frame_extremes(parts: Parts) -> pd.DataFrame:
    """Return for each source and extreme frame how far off it is."""
    lines = []
    for source, part in parts:
        extreme = part[part["extreme"].astype(bool)]
        for (columns, load), rows in extreme.groupby(["columns", "load"], sort=False):
            kinds = pd.Series(kinds_of(rows["outcome"], outcomes_of(rows["exact"])))
            posed = {"source": source, "columns": columns, "load": load, "frames": len(rows)}
            size = rows["error"].abs()
            found = {"median_error": size.median(), "largest_error": size.max()}
            lines.append({**posed, **counted(kinds), **found, "parting": rows["parting"].max()})
    return pd.DataFrame(lines)


def frame_steps(parts: Parts) -> pd.DataFrame:
    """Return for each source and step, over its own, how far off the one asked again is."""
    again = dict(zip(("columns", "load", "amplitude_g"), (*ASKED_AGAIN, PULSES[0][0]), strict=True))
    lines = []
    for source, part in parts:
        case = part[list(again)].eq(list(again.values())).all(axis=1)
        for refined, rows in part[case].groupby("refined"):
            cost = {"us_a_step": 1e6 * rows["wall_s"].sum() / max(int(rows["steps"].sum()), 1)}
            lines.append({"source": source, "refined": refined, **_line(rows), **cost})
    return pd.DataFrame(lines)


def _line(rows: pd.DataFrame) -> dict[str, Any]:
    size = rows["error"].abs()
    return {
        "frames": len(rows),
        "wrong": int((~rows["right"].astype(bool)).sum()),
        "median_error": size.median(),
        "largest_error": size.max(),
    }
