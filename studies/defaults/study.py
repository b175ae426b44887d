"""Engines as documented, asked over the plane of pulses, of blocks that similarity makes alike."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import Annotated, Literal

import numpy as np
import pandas as pd

from analytic.motion import Delayed
from studies.cases.paper import PULSES
from studies.defaults import STUDY
from studies.defaults.claims import (
    CLOSE,
    first_claim,
    posed,
    rest_claim,
    rests,
    shares,
    similarity,
    with_verdicts,
)
from studies.drawing.kept import Pictures, tell
from studies.kit.arguments import Out, check_sources
from studies.kit.jobs import Job
from studies.kit.naming import several_sources
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, carry_out
from studies.kit.tables import write_table
from studies.sources.groups import core_sources
from studies.sources.registry import resolve

ASPECTS, WIDTHS_M = (2.0, 3.0, 4.0), (0.5, 2.0)
RATIOS = tuple((0.5 * np.arange(1, 17)).tolist())
"""ω/p."""
ONSETS = tuple((1.0 + 0.6 * (np.arange(15) + 0.5)).tolist())
"""Amplitudes over g tan α."""
REST_S = 1.0
"""For how long all is at rest before every other pulse [s], in which an engine may fall asleep."""

QUICK_ASPECTS, QUICK_PULSES, QUICK_EVERY = (3.0,), ("full-sine",), 3
DEFAULT_SOURCES = ("exact", *core_sources("naive"))


def command(
    *,
    out: Out,
    sources: Annotated[tuple[str, ...], several_sources] = DEFAULT_SOURCES,
    frame: Literal["base", "world"] | None = None,
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Ask engines as documented over frequency and amplitude of a pulse, and two sizes of a block.

    A case that fails is an answer, which the maps show: the exit code is 1 only where an engine
    has no result at all.

    Parameters
    ----------
    sources
        Who is asked; the exact solution always is.
    frame
        base: the motion of the base is a body force; world: the engines move the base. By default
        as an engine's documentation does it.
    quick
        Full sines at H/B 3 alone, and every third frequency and amplitude.
    """
    check_sources(sources)
    return carry_out(STUDY, plan(sources, frame, quick), out, running, report)


def plan(sources: Sequence[str], frame: str | None, quick: bool) -> Plan:
    """Return the plan that puts the pulses to some sources, and to the exact solution."""
    asked = tuple(dict.fromkeys(("exact", *sources)))
    return Plan(
        jobs=grid_jobs(asked, frame, quick),
        settings={"frame": frame, "quick": quick},
        growing={"source": asked},
        needed=lambda rows: [row for row in rows if row["source"] == "exact"],
    )


def grid_jobs(sources: Sequence[str], frame: str | None, quick: bool) -> list[Job]:
    """Return a job for each pulse, block and source."""
    every = QUICK_EVERY if quick else 1
    cases = product(
        QUICK_PULSES if quick else PULSES,
        QUICK_ASPECTS if quick else ASPECTS,
        WIDTHS_M,
        ONSETS[::every],
        RATIOS[::every],
    )
    jobs = []
    for pulse, aspect, width_m, onsets, ratio in cases:
        block, motion = posed(pulse, aspect, width_m, onsets, ratio)
        labels = {
            "pulse": pulse,
            "aspect": aspect,
            "width_m": width_m,
            "amplitude_g": onsets * math.tan(block.alpha),
            "onsets": onsets,
            "omega_over_p": ratio,
            "rest_s": rest_s_of(onsets, ratio),
        }
        shaken = Delayed(motion, REST_S) if labels["rest_s"] else motion
        for source in sources:
            options = {"frame": frame} if frame and resolve(source).engine else {}
            jobs.append(
                Job(labels=labels, block=block, motion=shaken, source=source, options=options)
            )
    return jobs


def rest_s_of(onsets: float, ratio: float) -> float:
    """Return for how long all is at rest before a pulse [s]: every other one of a map begins so."""
    odd = (ONSETS.index(onsets) + RATIOS.index(ratio)) % 2
    return REST_S * odd


def report(folder: Path) -> str:
    """Reduce and draw a folder's defaults.csv; return the findings as text."""
    rows = read(folder)
    parts, rested = shares(rows), rests(rows)
    write_table(folder / "parts.csv", parts)
    write_table(folder / "rests.csv", rested)
    tables = {
        "Pulses by the width of the block": parts,
        "Pulses by the rest before them": rested,
        f"Part of the pulses in which two widths differ in outcome or by {CLOSE:g}": similarity(
            rows
        ),
    }
    return tell(folder, pictures(folder), headline(folder), tables)


def read(folder: Path) -> pd.DataFrame:
    """Read a defaults.csv back, with a verdict on every row."""
    rows = pd.read_csv(folder / "defaults.csv", dtype={"message": str})
    return with_verdicts(rows.fillna({"message": ""}))


def headline(folder: Path) -> str:
    """Say what part of the pulses each engine gets right, and who loses by a rest."""
    told = (
        first_claim(pd.read_csv(folder / "parts.csv")),
        rest_claim(pd.read_csv(folder / "rests.csv")),
    )
    return " ".join(filter(None, told))


def pictures(folder: Path) -> Pictures:
    """Draw the maps of the smallest and of the largest block from a folder's defaults.csv."""
    from studies.defaults.figure import draw_maps

    rows = read(folder)
    widths = {"small": rows["width_m"].min(), "large": rows["width_m"].max()}
    return {name: draw_maps(rows[rows["width_m"] == width]) for name, width in widths.items()}
