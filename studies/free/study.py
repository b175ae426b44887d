"""Free rocking: the period and the decay of each source against the closed forms."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from analytic import RigidBlock, Still
from analytic.criteria import quarter_period
from studies.drawing.kept import tell
from studies.free import STUDY
from studies.free.errors import IMPACTS, SWINGS, reduce, swing_times
from studies.kit.arguments import Out
from studies.kit.jobs import Job
from studies.kit.naming import Sources
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, carry_out
from studies.measures.words import part
from studies.sources.registry import core_sources, resolve

ASPECTS = (1.5, 2.0, 3.0, 4.0, 6.0, 10.0)
TILTS = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Rotations over alpha from which the blocks are released."""
QUICK_ASPECTS, QUICK_TILTS = (2.0, 4.0), (0.3, 0.9)
DEFAULT_SOURCES = ("exact", "housner", "modified", "rk4", *core_sources())
SAMPLES = 6000


def command(
    *,
    out: Out,
    quick: bool = False,
    sources: Sources = DEFAULT_SOURCES,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Hold free rocking of each source against the closed forms of its model.

    Parameters
    ----------
    quick
        Two aspect ratios and two tilts.
    """
    return carry_out(STUDY, plan(sources, quick), out, running, report)


def plan(sources: Sequence[str], quick: bool) -> Plan:
    """Return the plan that releases blocks of some shapes and tilts, for each source."""
    return Plan(
        jobs=[
            released(aspect, tilt, source)
            for aspect in (QUICK_ASPECTS if quick else ASPECTS)
            for tilt in (QUICK_TILTS if quick else TILTS)
            for source in sources
        ],
        settings={"quick": quick},
        growing={"source": sources},
        reduce=reduce,
    )


def released(aspect: float, tilt: float, source: str) -> Job:
    """Return the job of a block that is released from `tilt` alpha.

    It is sampled until the swings that are compared have ended, for they are shorter than the first
    by what each impact takes; half a fall more is for a source that is late.
    """
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    theta, model = tilt * block.alpha, resolve(source).model
    fall = quarter_period(block, theta, model)
    sampled = (1.5 + 2.0 * SWINGS) * fall
    return Job(
        labels={"aspect": aspect, "tilt": tilt},
        block=block,
        motion=Still(),
        source=source,
        duration=max(sampled, 1.5 * fall + sum(swing_times(block, theta, model))),
        times=np.linspace(0.0, sampled, SAMPLES),
        options={"start": (theta, 0.0)},
    )


def report(folder: Path) -> str:
    """Reduce and draw a folder's free.csv; write and return the text."""
    rows = STUDY.read(folder, "free")
    tables = {
        f"Largest relative error of the time between impacts and of the next rotation, and drift "
        f"over up to {IMPACTS} impacts [1/p]": errors(rows, ["source", "tilt"]).reset_index()
    }
    return tell(STUDY, folder, tables)


def errors(rows: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Return the largest errors of each group of rows."""
    sizes = rows.assign(drift_p=rows["drift_p"].abs())
    return sizes.groupby(by, sort=False)[["period_error", "decay_error", "drift_p"]].max()


def finding(folder: Path) -> str:
    """Say to what each source follows the closed forms of its model, at worst."""
    worst = errors(STUDY.read(folder, "free"), ["source"])[["period_error", "decay_error"]].max(
        axis=1
    )
    words = [f"{name} {part(value)}" for name, value in worst.items()]
    return f"Free rocking follows the closed forms, at worst to: {', '.join(words)}."
