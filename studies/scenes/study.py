"""A frame, a slide and a moving floor, and their exact solutions."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from analytic import simulate
from analytic.response import Outcome, Response
from engines.run.drive import LAG
from studies.drawing.kept import tell
from studies.old.arguments import Out
from studies.old.jobs import Job, summary
from studies.old.journal import Row
from studies.old.naming import Sources
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.plan import Plan, carry_out
from studies.measures.presets import engine_of, preset_of
from studies.measures.words import listed
from studies.scenes import KINDS, STUDY
from studies.scenes.cases import jobs
from studies.scenes.frames import SEEN
from studies.scenes.own_floor import exact_on_its_floor
from studies.scenes.summaries import tabulate
from studies.scenes.told import SCENES, by_scene, ends, floor_sentence, found_in, shown
from studies.sources.registry import core_sources

__all__ = ["command", "finding", "report", "shown"]

DEFAULT_SOURCES = core_sources("naive", "fixed", "landing")
SEEN_OF_A_SLIDE = ("place_m", "lift_m", "turn_rad")


def command(
    *,
    out: Out,
    quick: bool = False,
    sources: Sources = DEFAULT_SOURCES,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Hold a frame, a slide and a moving floor against their exact solutions.

    Parameters
    ----------
    quick
        One frame, one slide, and two places of the steps.
    sources
        Who is asked; steps that land on impacts are asked about frames alone, and how a floor is
        moved of engines as they are documented.
    """
    plan = Plan(
        jobs=lambda: jobs(sources, quick),
        settings={"quick": quick},
        growing={"source": sources},
        reduce=reduce,
        tabulate=tabulate,
        needed=needed,
    )
    return carry_out(STUDY, plan, out, running, report)


def reduce(job: Job, response: Response) -> Row:
    """Return the summary, and how far the response is from the exact one of its scene.

    Parameters
    ----------
    job : Job
        Of `studies.scenes.cases.jobs`.
    response : Response

    Returns
    -------
    dict
        The columns of `summary` and reason, then those of the scene's table; errors of peaks are
        relative, those of slips and places in metres, and nan where there is none.
    """
    row = {**summary(job, response), "reason": response.reason.name if response.reason else ""}
    exact = simulate(job.block, job.motion, start=job.options.get("start", (0.0, 0.0)))
    seen = response.observables
    if job.labels["scene"] == "frame":
        row |= {"exact": exact.peak_ratio, "right": response.outcome is exact.outcome}
        return {**row, "error": _off(response, exact), **_of(seen, SEEN)}
    if job.labels["scene"] == "floor":
        travel = float(job.motion.displacement(job.motion.duration))
        place = float(seen.get("place_m", math.nan))
        return {**row, "carried": 1.0 + place / travel, LAG: float(seen.get(LAG, math.nan))}
    if job.labels["scene"] == "block":
        own = exact_on_its_floor(*_named(job.source), job.block, job.motion)
        found = {"exact": exact.peak_ratio, "own_exact": own.peak_ratio}
        errors = {"error": _off(response, exact), "own_error": _off(response, own)}
        return {**row, **found, **errors, LAG: float(seen.get(LAG, math.nan))}
    return {**row, "slips": len(response.slips), "exact_slips": len(exact.slips),
            "slip_error_m": _slip_error(response, exact), **_of(seen, SEEN_OF_A_SLIDE)}  # fmt: skip


def _named(source: str) -> tuple[str, str]:
    return engine_of(source), preset_of(source)


def _off(response: Response, exact: Response) -> float:
    """Return the relative error of a peak where both rock; nan elsewhere."""
    both = response.outcome is Outcome.ROCKED is exact.outcome
    return response.peak_ratio / exact.peak_ratio - 1.0 if both else math.nan


def _of(seen: Any, names: Sequence[str]) -> Row:
    return {name: float(seen.get(name, math.nan)) for name in names}


def _slip_error(response: Response, exact: Response) -> float:
    """Return the largest error of a slip [m]; of a block that is held, how far it crept.

    Where there are more slips than there should be, the longest count; nan where there are fewer.
    """
    if response.outcome is Outcome.FAILED or len(response.slips) < len(exact.slips):
        return math.nan
    if not exact.slips:
        return abs(float(response.observables.get("place_m", math.nan)))
    least = sorted(map(abs, response.slips))[-len(exact.slips)]
    longest = [slip for slip in response.slips if abs(slip) >= least]
    return max(abs(one - other) for one, other in zip(longest, exact.slips, strict=True))


def needed(rows: Sequence[Row]) -> Sequence[Row]:
    """Return the rows whose failure is the study's: not of what an engine is not built for."""
    return [row for row in rows if row["reason"] != "UNAVAILABLE"]


TABLES = tuple(f"{kind}-summary" for kind in KINDS)


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return what they show."""
    tables = {name: found_in(folder / f"{name}.csv") for name in TABLES}
    return tell(STUDY, folder, tables | shown(folder))


def finding(folder: Path) -> str:
    """Say how far off each scene is as documented and at best, and what floors carry."""
    said = [f"{SCENES[name].title} {ends(name, lines)}" for name, lines in by_scene(folder).items()]
    floors = floor_sentence(found_in(folder / "floor-summary.csv"))
    if not said:
        return floors or "No engine that was asked is built for these scenes."
    words = f"Off by up to, as documented → with each engine's best preset: {listed(said)}."
    return " ".join(filter(None, (words, floors)))
