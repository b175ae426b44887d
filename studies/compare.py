"""One block, one pulse, record or release, every named source side by side."""

import json as json_text
import math
from collections.abc import Callable, Sequence
from pathlib import Path
from statistics import median
from typing import Any

import numpy as np
import pandas as pd

from analytic import Outcome, Record, Response, RigidBlock, RockingFrame, SlidingBlock
from analytic.motion import BothWays, Motion, SinePulse, Still
from analytic.start import strongest
from engines.scene import System
from studies.cases.paper import PULSES
from studies.kit import arguments
from studies.kit.jobs import Job, Question, Row
from studies.kit.run import Place, exit_code, here, place_of, run, with_response
from studies.kit.say import aligned, duration, number
from studies.kit.scene_options import Excitation, Height, Standing, Width, baseline_note, window_of
from studies.measures.differences import conditioning_of_one
from studies.measures.halving import ELSEWHERE, estimate_of, halved, published_trust
from studies.sources.registry import core_sources

OF_THE_CASE = ("kappa", "sensitivity", "min_normal", "friction_needed")
SHOWN = (
    *("source", "outcome", "slips", "peak_ratio", "error", "estimate", "bound", "impacts"),
    *("impact_error", "floor_lag_m", "lift_m", "parting", "tilt", "drift_m", "steps", "wall_s"),
)
"""Columns of the table, as in JSON, where a source has them."""
DEFAULT_SOURCES = ("exact", "housner", "modified", *core_sources())


def command(
    *,
    width: Width | None = None,
    height: Height | None = None,
    excitation: Excitation = Excitation(),  # noqa: B008
    standing: Standing = Standing(),  # noqa: B008
    sources: arguments.Sources = DEFAULT_SOURCES,
    duration: arguments.Positive | None = None,
    effort: arguments.EffortOptions = arguments.EffortOptions(),  # noqa: B008
    yours: arguments.Yours = arguments.Yours(),  # noqa: B008
    estimate: bool = False,
    plot: arguments.Place | None = None,
    json: bool = False,
    computing: arguments.Computing = arguments.Computing(),  # noqa: B008
) -> int:
    """Compare sources on one block and one pulse or record.

    For each source it prints the outcome, the peak rotation over θcr = atan(B/H) and its relative
    error, the impacts, the largest error of the first five impact times (times p), the steps and
    the run time. All sources observe the same window of time. For the exact solution it prints κ,
    the sensitivity, the friction it needs and its least normal force over the weight: if this is
    negative the block lifts off, and an engine rightly differs.

    Parameters
    ----------
    duration
        Observe until this time [s], at least the end of the motion; by default until 8/p after
        it.
    estimate
        Also run every engine at half the step, and print the relative difference of the two peaks,
        and a bound on the error: that difference times the factor that bounds 95 % of the errors on
        random cases, if there is one (`rocking validate --halves`).
    plot
        Draw all time histories into this file (.png, .pdf or .svg).
    json
        Print one JSON object per line for each source, instead of the table.
    """
    if standing.scene == "slide":
        arguments.refuse_given({"plot": plot}, "only where something rocks")
    arguments.refuse_both(dt=yours.dt, p_dt=effort.p_dt)
    effort.refuse_idle(sources)
    words = "a block requires its full width and height [m]"
    width, height = arguments.required(words, width=width, height=height)
    if plot is not None:
        arguments.check_file("--plot", plot, ".png", ".pdf", ".svg")
    system = standing.system(width, height, yours.friction)
    motion, start = excitation.pose(system)
    nonlinear = standing.scene == "slide" or isinstance(motion, BothWays)
    if nonlinear and sources == DEFAULT_SOURCES:
        sources = ("exact", *core_sources())
    window = window_of(system, motion, duration, p_dt=effort.p_dt, dt=yours.dt)
    times = np.linspace(0.0, window, 1501) if plot else None
    case = Question(system=system, motion=motion, start=start, duration=window, times=times)
    place = place_of(computing, at_once=True)
    rows = compare(case, sources, yours, effort, place=place, estimate=estimate)
    parts = (motion.level, motion.upward) if isinstance(motion, BothWays) else (motion,)
    notes = [baseline_note(it, excitation.baseline) for it in parts if isinstance(it, Record)]
    note = "; ".join(filter(None, notes))
    if json:
        for record in records(rows, note):
            finite = {
                name: None if isinstance(value, float) and not math.isfinite(value) else value
                for name, value in record.items()
            }
            print(json_text.dumps(finite, allow_nan=False))
    else:
        print(table_text(case, records(rows), note))
    if plot:
        draw(case, rows, plot)
    return exit_code(rows)


def draw(case: Question, rows: Sequence[Row], path: Path) -> None:
    """Draw the histories of the rows over each other; nothing where no row has one."""
    from studies.drawing.figures import draw_histories
    from studies.kit.pictures import save
    from studies.measures.history import samples

    system, motion = case.system, case.motion
    labels = {
        **{"panel": "", "pulse": motion_name(motion)},
        **{"width_m": system.width, "height_m": system.height},
        "amplitude_g": strongest(motion) / system.gravity,
    }
    parts = [
        samples(row["response"], system, motion, {**labels, "source": row["source"]})
        for row in rows
        if row["response"].history is not None
    ]
    if parts:
        save(draw_histories(pd.concat(parts), "The same block, the same motion of the base"), path)


def table_text(case: Question, records: Sequence[Row], note: str = "") -> str:
    """Return the case, a note on its motion, and its records; angles over alpha."""
    (theta, rate), system = case.start, case.system
    words = f"θ = {theta / system.alpha:.6g} α, θ' = {rate / (system.alpha * system.p):.6g} αp"
    facts = [f"{name} {number(records[0][name])}" for name in OF_THE_CASE]
    return "\n".join(
        [
            _standing(system),
            *_ground(case),
            *[f"base    {note}"] * bool(note),
            *[f"start   {words}"] * (case.start != (0.0, 0.0)),
            *[f"exact   {', '.join(facts)}"] * (not isinstance(system, SlidingBlock)),
            "",
            _table(records, system),
            *(f"{each['source']}: {each['message']}" for each in records if each["message"]),
        ]
    )


def _table(records: Sequence[Row], system: System) -> str:
    """Return a line for each source, of the columns in which one has a number or a word."""
    words: dict[str, Callable[[Any], str]] = {"wall_s": duration, "slips": _slips}
    words["peak_ratio"] = "{:.6f}".format

    def cell(name: str, value: Any) -> str:
        return words.get(name, number)(value) if known(value) else "-"

    def known(value: Any) -> bool:
        return value is not None and value == value

    names = [name for name in SHOWN if any(known(record.get(name)) for record in records)]
    if isinstance(system, SlidingBlock):
        names.remove("peak_ratio")
    rows = [[cell(name, record.get(name)) for name in names] for record in records]
    return aligned([names, *rows], [name not in ("source", "outcome", "slips") for name in names])


def _standing(system: System) -> str:
    sizes = f"B = {system.width:g} m, H = {system.height:g} m"
    if isinstance(system, SlidingBlock):
        return f"slide   {sizes}, friction {system.friction:g}"
    numbers = f"α = θcr = {system.alpha:.5g} rad, p = {system.p:.5g} rad/s"
    if isinstance(system, RockingFrame):
        return f"frame   {system.columns} columns of {sizes}, load {system.load:g}: {numbers}"
    return f"block   {sizes}: {numbers}"


def _ground(case: Question) -> list[str]:
    motion, g = case.motion, case.system.gravity
    level = motion.level if isinstance(motion, BothWays) else motion
    upward = [f"upward  {_moving(motion.upward, g)}"] if isinstance(motion, BothWays) else []
    return [f"ground  {_moving(level, g)}; observed for {case.duration:.4g} s", *upward]


def _moving(motion: Motion, gravity: float) -> str:
    name = motion_name(motion)
    if isinstance(motion, Still):
        return name
    if isinstance(motion, SinePulse):
        phase = f", phase {motion.phase:g} rad" if motion.phase else ""
        details = f"{motion.omega:g} rad/s{phase}"
    else:
        times = np.array(motion.breakpoints)
        speed = float(np.abs(motion.velocity(times)).max())
        step = motion.duration / (times.size - 1)
        details = f"{speed:.3g} m/s, {times.size} samples every {step:.4g} s"
    peak = strongest(motion) / gravity
    return f"{name}, {peak:.6g} g, {details}, {motion.duration:.4g} s"


def motion_name(motion: Motion) -> str:
    """Return what a motion of the base is called."""
    if not isinstance(motion, SinePulse):
        return "at rest" if isinstance(motion, Still) else "record"
    names = {number: f"{name} pulse" for name, number in PULSES.items()}
    return names.get(motion.half_cycles, f"{motion.half_cycles} half cycles")


def _slips(slips: Sequence[float]) -> str:
    first = " ".join(f"{slip:+.6f}" for slip in slips[:4])
    return f"{first} … {len(slips) - 4} more" if len(slips) > 4 else first


def compare(
    case: Question,
    sources: Sequence[str],
    yours: arguments.Yours,
    effort: arguments.EffortOptions,
    *,
    place: Place = here,
    estimate: bool = False,
) -> list[Row]:
    """Ask every source, and the exact solution besides; return a row for each."""
    own = yours.options(sources, case.system)
    jobs = [
        Job(labels={}, case=case, source=name, options=effort.options(name) | own.get(name, {}))
        for name in dict.fromkeys(["exact", *sources])
    ]
    finer = [half for job in jobs if (half := halved(job)) is not None] if estimate else []
    every = run([*jobs, *finer], with_response, place)
    rows = {row["source"]: row for row in every[: len(jobs)]}
    halves = {row["source"]: row for row in every[len(jobs) :]}
    exact: Response = rows["exact"]["response"]
    known = {"kappa": math.nan, "sensitivity": math.nan}
    if not isinstance(case.system, SlidingBlock):
        known = conditioning_of_one(case.system, case.motion, case.start, exact)
    for name, row in rows.items():
        row |= {**_beside(row["response"], exact, case.system.p), **known, "exact": exact}
        if estimate:
            own_steps = effort == arguments.EffortOptions() and yours.dt is None
            row |= _estimated(row, halves.get(name), case.system, own_steps)
    if yours.friction is not None and yours.friction < exact.friction_needed:
        slides = f"slides: needs {exact.friction_needed:.3g}, has {yours.friction:.3g}"
        rows["exact"]["message"] = "; ".join(filter(None, (rows["exact"]["message"], slides)))
    return [rows[name] for name in sources]


def _beside(response: Response, exact: Response, p: float) -> dict[str, float]:
    error = late = math.nan
    if exact.slips:
        error = _apart(response.slips, exact.slips, math.nan)
    elif exact.outcome is Outcome.ROCKED and math.isfinite(response.peak_ratio):
        error = response.peak_ratio / exact.peak_ratio - 1.0
    ratios = [impact.ratio for impact in response.impacts if impact.velocity_before]
    wanted = [impact.time for impact in exact.impacts[:5]]
    found = [impact.time for impact in response.impacts[: len(wanted)]]
    if wanted and len(found) == len(wanted):
        late = max(abs(one - other) for one, other in zip(found, wanted, strict=True))
    ratio = median(ratios) if ratios else math.nan
    return {"error": error, "velocity_ratio": ratio, "impact_error": late * p}


def _apart(slips: Sequence[float], right: Sequence[float], otherwise: float) -> float:
    """Return the largest error of a slip over the largest; `otherwise` where one is missing."""
    if len(slips) != len(right):
        return otherwise
    pairs = zip(slips, right, strict=True)
    return max(abs(one - other) for one, other in pairs) / max(map(abs, right))


def _estimated(row: Row, finer: Row | None, system: System, own_steps: bool) -> Row:
    """Return the estimate of a row's error and what bounds it, or why there is no bound."""
    if finer is None:
        return {"estimate": math.nan, "bound": math.nan}
    found, trust = estimate_of(row, finer), published_trust(row["source"])
    if row["outcome"] == finer["outcome"] == Outcome.SLID.value:
        found = _apart(row["response"].slips, finer["response"].slips, math.inf)
    if found == math.inf:
        why = f"at half the step: {finer['outcome']}"
    elif not isinstance(system, RigidBlock):
        slides = isinstance(system, SlidingBlock)
        why = "the factor is of a peak" if slides else "the factor was found on blocks"
    else:
        why = "no random cases tell its factor" if trust is None else trust.warning()
    bound = math.nan if why or trust is None else trust.factor * found
    elsewhere = "" if why or own_steps else ELSEWHERE
    message = "; ".join(filter(None, (row["message"], why, elsewhere)))
    return {"estimate": found, "bound": bound, "message": message}


def records(rows: Sequence[Row], note: str = "") -> list[dict[str, Any]]:
    """Return what a reader gets of each row, by name: numbers may be inf or nan."""
    found: list[dict[str, Any]] = []
    for row in rows:
        exact, response = row["exact"], row["response"]
        item = {name: value for name, value in row.items() if name not in ("exact", "response")}
        item["message"] = "; ".join(filter(None, (item["message"], note)))
        item |= {"min_normal": exact.min_normal, "friction_needed": exact.friction_needed}
        item |= {"slips": list(response.slips)} if response.slips else {}
        known = not math.isnan(exact.min_normal)
        item["valid"] = exact.min_normal >= 0.0 if known else None
        found.append({**item, **response.observables})
    return found
