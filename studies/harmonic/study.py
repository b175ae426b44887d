"""Steady states under sustained harmonic shaking: every attractor that is found, and engines."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, replace
from functools import cache
from pathlib import Path
from typing import Any, Literal, TypeAlias

import numpy as np
import pandas as pd

from analytic.response import Outcome, Response
from studies.drawing.kept import tell
from studies.harmonic import STUDY
from studies.harmonic.attractors import Attractor, Shaking, attractors
from studies.kit import provenance
from studies.kit.arguments import BadInputError, Count, Out, Positive, Yes, refuse_given
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.kit.naming import CORE, EngineSources
from studies.kit.options import DEFAULT_RUNNING, Running, refuse_days, refuse_excess
from studies.kit.plan import Plan, Tables, by_label, carry_out
from studies.kit.standing import Height, Width, posed_block
from studies.kit.tables import table_in
from studies.measures.orbits import LAST_PERIODS, SAMPLES, orbit_of, sample_times
from studies.measures.words import out_of
from studies.sources.registry import resolve

__all__ = ["command", "finding", "report"]

Over = Literal["frequency", "amplitude"]
SWEPT = {"frequency": "omega_over_p", "amplitude": "onsets"}
"""What of a motion is swept."""
RANGES = {"frequency": (1.0, 8.0), "amplitude": (0.4, 3.0)}
"""Of ω/p, and of a_p over g tan α."""
FIXED = {"frequency": 1.5, "amplitude": 4.0}
"""a_p over g tan α of a sweep over frequency, ω/p of one over amplitude."""
POINTS, QUICK_POINTS = 141, 36
STARTS, QUICK_STARTS = 11, 5
PERIODS, QUICK_PERIODS = 200, 100
ENGINE_POINTS, QUICK_ENGINE_POINTS = 12, 3
ENGINE_PERIODS = 60
"""Forcing periods that an engine runs from the state of the exact orbit."""
FOLLOWED = 4
"""About how many orbits are followed to a point."""
PERIOD_S, POINT_BYTES = 3e-5, 2e3
"""About how long a period of a start takes [s], and what a point holds."""


Branch: TypeAlias = "tuple[Shaking, Attractor]"
"""A point of what is swept, and what some of the starts settled on there."""


def command(
    *,
    out: Out,
    width: Width = 0.5,
    height: Height = 1.5,
    over: Over = "frequency",
    low: Positive | None = None,
    high: Positive | None = None,
    onsets: Positive | None = None,
    omega_over_p: Positive | None = None,
    points: Count | None = None,
    starts: Count | None = None,
    periods: Count | None = None,
    sources: EngineSources = CORE,
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
    yes: Yes = False,
) -> int:
    """Shake a block harmonically from many starts, and read the steady states.

    Parameters
    ----------
    over
        What is swept: the frequency of the motion, or its amplitude.
    low
        Where the sweep begins: ω/p [-], 1 by default, or the amplitude over g tan α [-], 0.4.
    high
        Where it ends: 8, or 3, by default.
    onsets
        Amplitude over g tan α [-] of a sweep over frequency; 1.5 by default.
    omega_over_p
        Frequency ω/p [-] of a sweep over amplitude; 4 by default.
    points
        Points over the range; 141, with --quick 36.
    starts
        At each point so many rotations by as many rates, each from -0.9 to 0.9 of α and α p, where
        the shaking begins at its crest; 11 (121 starts), with --quick 5 (25).
    periods
        Forcing periods from each start before its steady state is read; 200, with --quick 100. What
        does not repeat by then goes on for longer.
    sources
        Engines that start on the exact orbit at some points.
    quick
        Fewer points, periods and runs of engines.
    """
    for name in sources:
        if resolve(name).kind == "model":
            raise BadInputError(f"--sources names {name}; it must name engines, peers or solvers")
    swept = {"omega-over-p": omega_over_p} if over == "frequency" else {"onsets": onsets}
    refuse_given(swept, "only where it is not swept")
    begin, end = low or RANGES[over][0], high or RANGES[over][1]
    if not begin < end:
        raise BadInputError(f"--low is {begin}; it must be less than --high, {end}")
    fixed = (onsets if over == "frequency" else omega_over_p) or FIXED[over]
    block = posed_block(width, height)
    count = points or (QUICK_POINTS if quick else POINTS)
    cycles = periods or (QUICK_PERIODS if quick else PERIODS)
    each = starts or (QUICK_STARTS if quick else STARTS)
    asked = f"--points is {count}, --starts is {each} and --periods is {cycles}"
    refuse_excess(asked, count * POINT_BYTES)
    refuse_days(asked, count * (each**2 + FOLLOWED) * cycles * PERIOD_S, yes)

    held = Shaking(block=block, onsets=fixed, omega_over_p=fixed)
    grid = np.linspace(begin, end, count).tolist()
    shaken = [replace(held, **{SWEPT[over]: x}) for x in grid]

    @cache
    def branches() -> list[Branch]:
        living = zip(shaken, attractors(shaken, each, cycles), strict=True)
        return [(shaking, attractor) for shaking, here in living for attractor in here]

    def jobs() -> list[Job]:
        some = chosen(branches(), QUICK_ENGINE_POINTS if quick else ENGINE_POINTS)
        return [engine_job(branch, over, source) for branch in some for source in sources]

    def tabulate(rows: Sequence[Row]) -> Tables:
        table = pd.DataFrame([row_of(branch, over, each**2) for branch in branches()])
        return {STUDY.name: table, **by_label("table")(rows)}

    plan = Plan(
        jobs=jobs,
        settings={
            "block": asdict(block),
            **{"over": over, "low": begin, "high": end, "fixed": fixed},
            **{"points": count, "starts": each, "periods": cycles, "quick": quick},
        },
        growing={"source": sources},
        reduce=reduce,
        tabulate=tabulate,
    )
    return carry_out(STUDY, plan, out, running, report)


def row_of(branch: Branch, over: Over, starts: int) -> Row:
    """Return a branch as a row of harmonic.csv, of so many starts in all."""
    shaking, found = branch
    return {
        "x": getattr(shaking, SWEPT[over]),
        "onsets": shaking.onsets,
        "omega_over_p": shaking.omega_over_p,
        "outcome": found.outcome,
        "larger_ratio": found.right / shaking.block.alpha,
        "smaller_ratio": found.left / shaking.block.alpha,
        "period": found.period,
        "impacts": found.impacts,
        "starts": found.starts,
        "start_share": found.starts / starts,
    }


def chosen(branches: list[Branch], count: int) -> list[Branch]:
    """Return some of the orbits that repeat, evenly, those of each period in turn."""
    settled = [branch for branch in branches if branch[1].period and branch[1].right > 0.0]
    settled.sort(key=lambda branch: branch[1].period)
    places = np.linspace(0, len(settled) - 1, min(count, len(settled)))
    return [settled[round(place)] for place in places.tolist()]


def engine_job(branch: Branch, over: Over, source: str) -> Job:
    """Return the job of a source that starts on the exact orbit of a point."""
    shaking, exact = branch
    motion = shaking.motion(ENGINE_PERIODS)
    return Job(
        labels={
            "table": "engines",
            "x": getattr(shaking, SWEPT[over]),
            "larger_exact": exact.right / shaking.block.alpha,
            "smaller_exact": exact.left / shaking.block.alpha,
            "period_exact": exact.period,
        },
        block=shaking.block,
        motion=motion,
        source=source,
        duration=motion.duration,
        times=sample_times(motion),
        options={"start": exact.end},
    )


def reduce(job: Job, response: Response) -> Row:
    """Return the columns that follow an engine's labels: the orbit that it is on at the end."""
    row: Row = {"outcome": response.outcome.value, "larger_ratio": np.nan, "smaller_ratio": np.nan}
    history, alpha = response.history, job.block.alpha
    if history is not None and history.time.size == LAST_PERIODS * SAMPLES + 1:
        orbit = orbit_of(job.block, job.motion, response)  # type: ignore[arg-type]
        row |= {"larger_ratio": orbit.right / alpha, "smaller_ratio": orbit.left / alpha}
    return {**row, "steps": response.steps, "message": response.message}


NOUNS = {"frequency": "At {} frequencies", "amplitude": "At {} amplitudes"}
KIND, SPANNED = ["outcome", "period", "impacts"], ["x", "larger_ratio", "start_share"]
"""Columns that tell attractors apart, and those that change along one."""


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return the text."""
    table, asked = table_in(folder, "harmonic"), settings_of(folder)
    side = asked["starts"]
    tables = {
        f"Abscissae: all, those with several steady states, with one longer than a forcing period, "
        f"from which some of {side} rotations by {side} rates overturn and others do not, and all "
        "do": pd.DataFrame([counts(table)]),
        "Attractors of the exact solution, run by run (mirror images are one, and so are all that "
        "do not repeat, period 0; without a start: found by following the orbit from the next "
        "point)": branches(table),
        "Engines after some time on the exact orbit, difference of its larger rotation": (
            engine_errors(table_in(folder, "engines"))
        ),
    }
    return tell(STUDY, folder, tables)


def settings_of(folder: Path) -> dict[str, Any]:
    """Return what a folder's sweep was asked for, from its provenance."""
    return dict(provenance.record_of(folder)["settings"])


def branches(table: pd.DataFrame) -> pd.DataFrame:
    """Return each kind of attractor with its sizes and shares of the starts.

    A line for every run of neighbouring abscissae; all orbits that do not repeat are of one kind.
    """
    known = table.assign(
        impacts=table["impacts"].where(table["period"] > 0, 0),
        place=table["x"].rank(method="dense"),
    ).sort_values("x", kind="stable")
    run = known.groupby(KIND)["place"].transform(lambda place: (place.diff() > 1).cumsum())
    found = known.groupby([*KIND, run], sort=False)[SPANNED].agg(["min", "max"])
    found.columns = found.columns.map("_".join)
    return found.reset_index(KIND)


def counts(table: pd.DataFrame) -> dict[str, int]:
    """Count abscissae: of several steady states, of a longer period, of some and all overturned."""
    steady = table["outcome"].isin([Outcome.ROCKED.value, Outcome.AT_REST.value])
    states = steady.groupby(table["x"]).sum()
    fallen = (table["outcome"] == Outcome.OVERTURNED.value).groupby(table["x"]).any()
    return {
        "all": len(states),
        "several": int((states > 1).sum()),
        "longer": table.loc[table["period"] > 1, "x"].nunique(),
        "both": int((fallen & (states > 0)).sum()),
        "fallen": int((fallen & (states == 0)).sum()),
    }


def engine_errors(engines: pd.DataFrame) -> pd.DataFrame:
    """Return how far each engine is from the exact orbit on which it started."""
    if engines.empty:
        return engines
    error = (engines["larger_ratio"] / engines["larger_exact"] - 1.0).abs()
    by = error.groupby(engines["source"], sort=False)
    return by.agg(orbits="size", kept="count", median_error="median", max_error="max").reset_index()


def finding(folder: Path) -> str:
    """Say at how many abscissae several steady states live, and where the start decides a fall."""
    found = counts(table_in(folder, "harmonic"))
    several, both = (out_of(found[name], found["all"]) for name in ("several", "both"))
    return (
        f"{NOUNS[settings_of(folder)['over']].format(several)} a block has more than one steady "
        f"state, and at {both} its start decides whether it overturns."
    )
