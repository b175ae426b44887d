"""Steady states under sustained harmonic shaking: the exact branches, up and down, and engines."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cache
from typing import Annotated, Literal

import numpy as np
import pandas as pd

from analytic.block import RigidBlock
from analytic.response import Response
from studies.harmonic import STUDY
from studies.harmonic.report import headline, paragraph, pictures, report
from studies.harmonic.sweeps import Shaking, State, sweep
from studies.kit.arguments import BadInputError, Count, Place, Positive, check_sources
from studies.kit.estimates import refuse_days, refuse_excess
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.kit.naming import several_engines
from studies.kit.options import DEFAULT_RUNNING, Running
from studies.kit.plan import Plan, Tables, by_label, carry_out
from studies.kit.posing import posed_block
from studies.measures.orbits import LAST_PERIODS, SAMPLES, orbit_of, sample_times
from studies.sources.groups import core_sources
from studies.sources.registry import resolve

__all__ = ["command", "headline", "paragraph", "pictures", "report"]

Over = Literal["frequency", "amplitude"]
RANGES = {"frequency": (1.0, 8.0), "amplitude": (0.4, 3.0)}
"""Of ω/p, and of a_p over g tan α."""
FIXED = {"frequency": 1.5, "amplitude": 4.0}
"""a_p over g tan α of a sweep over frequency, ω/p of one over amplitude."""
POINTS, QUICK_POINTS = 141, 36
PERIODS, QUICK_PERIODS = 400, 200
ENGINE_POINTS, QUICK_ENGINE_POINTS = 12, 3
ENGINE_PERIODS = 60
"""Forcing periods that an engine runs from the state of the exact orbit."""
PERIOD_S, POINT_BYTES = 3e-5, 2e3
"""About how long a period of a point takes [s], and what a point of both sweeps holds."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Branch:
    """A point of a sweep: where it is, how it was reached, and what the block settled on."""

    direction: str
    x: float
    shaking: Shaking
    state: State


def command(
    *,
    out: Place,
    width: Positive = 0.5,
    height: Positive = 1.5,
    over: Over = "frequency",
    low: Positive | None = None,
    high: Positive | None = None,
    onsets: Positive | None = None,
    omega_over_p: Positive | None = None,
    tilt: float = 0.3,
    points: Count | None = None,
    periods: Count | None = None,
    sources: Annotated[tuple[str, ...], several_engines] = core_sources(),
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
    yes: bool = False,
) -> int:
    """Sweep a sustained harmonic motion up and down, and read the steady states.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
    width
        Width B of the block [m].
    height
        Height H of the block [m].
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
    tilt
        Rotation from which a sweep starts, and starts again where the block overturned, in units
        of α; within 1 of zero.
    points
        Points of a sweep; 141, with --quick 36.
    periods
        Forcing periods at each point before its steady state is read; 400, with --quick 200.
    sources
        Engines that start on the exact orbit at some points.
    quick
        Fewer points, periods and runs of engines.
    yes
        Begin even what takes longer than a day.
    """
    check_sources(sources)
    if not abs(tilt) < 1.0:
        raise BadInputError(f"--tilt is {tilt}; it must lie between -1 and 1")
    for name in sources:
        if resolve(name).kind == "model":
            raise BadInputError(f"--sources names {name}; it must name engines, peers or solvers")
    given = {"frequency": omega_over_p, "amplitude": onsets}[over]
    if given is not None:
        name = {"frequency": "--omega-over-p", "amplitude": "--onsets"}[over]
        raise BadInputError(f"{name} is {given}; it must not be given where it is swept")
    begin, end = low or RANGES[over][0], high or RANGES[over][1]
    if not begin < end:
        raise BadInputError(f"--low is {begin}; it must be less than --high, {end}")
    fixed = (onsets if over == "frequency" else omega_over_p) or FIXED[over]
    block = posed_block(width, height)
    count = points or (QUICK_POINTS if quick else POINTS)
    cycles = periods or (QUICK_PERIODS if quick else PERIODS)
    asked = f"--points is {count} and --periods is {cycles}"
    refuse_excess(asked, count * POINT_BYTES)
    refuse_days(asked, 2.0 * count * cycles * PERIOD_S, yes)

    @cache
    def branches() -> list[Branch]:
        return sweeps(block, over, np.linspace(begin, end, count).tolist(), fixed, tilt, cycles)

    def jobs() -> list[Job]:
        some = chosen(branches(), QUICK_ENGINE_POINTS if quick else ENGINE_POINTS)
        return [engine_job(branch, source) for branch in some for source in sources]

    settings = {
        "block": asdict(block),
        **{"over": over, "low": begin, "high": end, "fixed": fixed, "tilt": tilt},
        **{"points": count, "periods": cycles, "quick": quick},
    }

    def tabulate(rows: Sequence[Row]) -> Tables:
        return {STUDY.name: pd.DataFrame(map(row_of, branches())), **by_label("table")(rows)}

    plan = Plan(
        jobs=jobs,
        settings=settings,
        growing={"source": sources},
        reduce=reduce,
        tabulate=tabulate,
    )
    return carry_out(STUDY, plan, out, running, report)


def sweeps(
    block: RigidBlock, over: Over, grid: list[float], fixed: float, tilt: float, periods: int
) -> list[Branch]:
    """Return the points of a sweep up and one down."""
    start = (tilt * block.alpha, 0.0)
    branches = []
    for direction, ordered in (("up", grid), ("down", grid[::-1])):
        posed = [
            Shaking(block=block, onsets=fixed, omega_over_p=x)
            if over == "frequency"
            else Shaking(block=block, onsets=x, omega_over_p=fixed)
            for x in ordered
        ]
        branches += [
            Branch(direction=direction, x=x, shaking=shaking, state=state)
            for x, (shaking, state) in zip(ordered, sweep(posed, start, periods), strict=True)
        ]
    return branches


def row_of(branch: Branch) -> Row:
    """Return a branch as a row of harmonic.csv."""
    alpha = branch.shaking.block.alpha
    return {
        "direction": branch.direction,
        "x": branch.x,
        "onsets": branch.shaking.onsets,
        "omega_over_p": branch.shaking.omega_over_p,
        "outcome": branch.state.outcome,
        "larger_ratio": branch.state.right / alpha,
        "smaller_ratio": branch.state.left / alpha,
        "period": branch.state.period,
        "impacts": branch.state.impacts,
    }


def chosen(branches: list[Branch], count: int) -> list[Branch]:
    """Return some of the points, evenly, at which the exact response repeats."""
    settled = [branch for branch in branches if branch.state.period and branch.state.right > 0.0]
    places = np.linspace(0, len(settled) - 1, min(count, len(settled)))
    return [settled[round(place)] for place in places.tolist()]


def engine_job(branch: Branch, source: str) -> Job:
    """Return the job of a source that starts on the exact orbit of a point."""
    motion = branch.shaking.motion(ENGINE_PERIODS)
    return Job(
        labels={
            "table": "engines",
            "direction": branch.direction,
            "x": branch.x,
            "larger_exact": branch.state.right / branch.shaking.block.alpha,
            "smaller_exact": branch.state.left / branch.shaking.block.alpha,
            "period_exact": branch.state.period,
        },
        block=branch.shaking.block,
        motion=motion,
        source=source,
        duration=motion.duration,
        times=sample_times(motion),
        options={"start": branch.state.start},
    )


def reduce(job: Job, response: Response) -> Row:
    """Return the columns that follow an engine's labels: the orbit that it is on at the end."""
    row: Row = {"outcome": response.outcome.value, "larger_ratio": np.nan, "smaller_ratio": np.nan}
    history, alpha = response.history, job.block.alpha
    if history is not None and history.time.size == LAST_PERIODS * SAMPLES + 1:
        orbit = orbit_of(job.block, job.motion, response)  # type: ignore[arg-type]
        row |= {"larger_ratio": orbit.right / alpha, "smaller_ratio": orbit.left / alpha}
    return {**row, "steps": response.steps, "message": response.message}
