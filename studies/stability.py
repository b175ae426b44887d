"""Stiff and extreme cases: who stays finite, keeps the outcome, the energy and the peak."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace
from functools import cache, partial
from time import perf_counter
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd

from analytic.response import Reason, Response
from engines.declaration import Stepping
from studies.cases.extreme import Extreme, contact_settings, extremes, takes_spring
from studies.kit.jobs import Job, Question, Row, ask, summary, unanswered
from studies.kit.options import Running
from studies.kit.say import out_of, part
from studies.kit.study import Study, Tables
from studies.measures.energy import SAMPLES
from studies.measures.presets import in_order, in_words, is_engine, preset_of
from studies.measures.verdicts import ACCEPTED, ENERGY_BAND, Verdict, invalidity, judge
from studies.sources.registry import core_sources, resolve

if TYPE_CHECKING:
    from matplotlib.figure import Figure

SOLVERS = ("rk4", "average-acceleration", "dop853", "radau")
METHODS = ("exact", *SOLVERS, *core_sources("", "fixed", "naive"))
LIMIT_S, TRIED_S, ANSWER_S, RUN_S = 600.0, 540.0, 54.0, 60.0
"""Time limit of a row [s], when no further setting is tried, and what an answer and a run with
another setting may take, which the limits in steps keep far from that."""
ANSWER_STEPS, REMEDY_STEPS, SEARCH_STEPS = 5_000_000, 2_000_000, 500_000
"""Steps that an answer, a remedy and a run of a search may take."""
NOTHING = "none of those tried"
GOOD = [verdict.value for verdict in ACCEPTED]
LARGEST = ["largest_stable", "largest_accurate", "stable_over_contact", "accurate_over_contact"]
STEPS = ["case", "contact_s", "factor", "source", "outcome", *LARGEST, "runs", "invalid", "message"]
START, SMALLEST_STEP, LARGEST_STEP = 0.01, 1e-4, 1.0
"""p dt from which a search sets out, and between which it searches."""
FACTOR, QUICK_FACTOR = 1.05, 1.3
"""Factor within which a largest step is found."""
PROBLEMS = (
    Extreme(name="peak before an impact", group="steps", half_cycles=1, onsets=1.5),
    Extreme(name="peak after an impact", group="steps"),
    Extreme(name="slender, H/B 50", group="steps", aspect=50.0),
    Extreme(name="squat, H/B 1", group="steps", aspect=1.0),
    Extreme(name="1 cm high", group="steps", width_m=0.01 / 3.0),
    Extreme(name="20 half-cycles", group="steps", half_cycles=20, omega_over_p=4.0, onsets=1.5),
)


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return a job for each extreme case and source, and a search for each source that steps."""
    factor = QUICK_FACTOR if quick else FACTOR
    steps = [
        _job(case, source, {}, table="steps", contact_s=contact_s, factor=factor)
        for case in (PROBLEMS[1:2] if quick else PROBLEMS)
        for source in sources
        for contact_s in contact_times(case, source)
    ]
    return [*matrix_jobs(sources, quick), *steps]


def matrix_jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return a job for each extreme case and each source to which it applies."""
    return [
        _job(case, source, case.options(source), table="matrix", group=case.group)
        for case in extremes(quick)
        for source in sources
        if case.applies(source)
    ]


def _job(case: Extreme, source: str, options: Mapping[str, Any], **labels: Any) -> Job:
    times = np.linspace(case.motion.duration, case.duration, SAMPLES)
    asked = Question(system=case.block, motion=case.motion, duration=case.duration, times=times)
    return Job(labels={**labels, "case": case.name}, case=asked, source=source, options=options)


def contact_times(case: Extreme, source: str) -> tuple[float, ...]:
    """Return the contact times [s] to try a source that steps with, nan for one without its own."""
    asked = resolve(source)
    if not asked.stepping:
        return ()
    if source.endswith(":fixed") and takes_spring(asked):
        return (math.nan, 0.01 / case.block.p)  # a contact that does not follow the step, too
    return (asked.used.contact_s if asked.engine else math.nan,)


def measure(job: Job) -> Row:
    """Return the verdict on an answer and the first setting that mends it, or the largest steps."""
    until, label, lost = perf_counter() + TRIED_S, job.labels, job.lost
    searched = label["table"] == "steps"
    cases = PROBLEMS if searched else extremes(False)
    case = next(case for case in cases if case.name == label["case"])

    def tried(
        source: str, options: Mapping[str, Any], steps: int, most_s: float = RUN_S
    ) -> Response:
        left = min(most_s, until - perf_counter())
        if left <= 0.0:
            return Response.failure("no time was left to try it", reason=Reason.UNDECIDED)
        limits = {"time_limit_s": left, "max_steps": steps} if resolve(source).engine else {}
        return ask(replace(job, source=source, options={**options, **limits}))

    if searched and lost is not None:
        return unanswered(lost.message)
    if searched:
        step = partial(tried, job.source, steps=SEARCH_STEPS)
        return largest_steps(case, job.source, label["contact_s"], label["factor"], step)
    response = tried(job.source, job.options, ANSWER_STEPS, ANSWER_S)
    found = judge(case, job.source, response)
    wrong = found["verdict"] not in GOOD and lost is None
    mending = (
        words
        for words, source, options in (remedies(case, job.source) if wrong else ())
        if judge(case, source, tried(source, options, REMEDY_STEPS))["verdict"] in GOOD
    )
    return {**summary(response), **found, "remedy": next(mending, NOTHING if wrong else "")}


def largest_steps(
    case: Extreme,
    source: str,
    contact_s: float,
    factor: float,
    ask: Callable[[Mapping[str, Any]], Response],
) -> Row:
    """Return the largest step of a source that is stable, and that is accurate, p dt.

    Stable is one with which it gives a finite answer of the right outcome whose free rocking gains
    no energy, accurate one with which the verdict is good as well. Both are nan where there is
    none; message is that of the response with the largest accurate step, or else with START.
    """
    contact = contact_s * case.block.p

    @cache
    def run(step: float) -> tuple[Response, Row]:
        options: Row = {"step": step}
        # nan where the contact follows the step, as it does where it takes a spring
        if not math.isnan(contact) and takes_spring(resolve(source)):
            options["settings"] = contact_settings(source, contact, step)
        response = ask(options)
        return response, judge(case, source, response)

    def stable(step: float) -> bool:
        response, found = run(step)
        right = response.outcome.value == found["exact_outcome"]
        return right and not found["energy_growth"] > ENERGY_BAND

    def accurate(step: float) -> bool:
        return stable(step) and run(step)[1]["verdict"] == Verdict.GOOD.value

    most = [largest_good(good, factor) for good in (stable, accurate)]
    runs = run.cache_info().currsize
    best, _ = run(START if math.isnan(most[1]) else most[1])
    return {
        # a search that ends is an answer, though it be that no step is stable
        "outcome": "searched",
        **dict(zip(LARGEST, (*most, *(step / contact for step in most)), strict=True)),
        **{"runs": runs, "invalid": invalidity(case, source), "message": best.message},
    }


def largest_good(good: Callable[[float], bool], factor: float) -> float:
    """Return the largest step up to which all steps tried are good; nan if not even the smallest.

    From START to finer steps until one is good, to coarser ones until one is not, and between the
    two. A step beyond the first bad one that happens to be good does not count.
    """
    low = START
    while not good(low):
        low *= 0.25
        if low < SMALLEST_STEP:
            return math.nan
    high = low
    while good(high):
        low = high
        if high >= LARGEST_STEP:
            return LARGEST_STEP
        high = min(2.0 * high, LARGEST_STEP)
    while high > factor * low:
        middle = math.sqrt(low * high)
        low, high = (middle, high) if good(middle) else (low, middle)
    return low


def remedies(case: Extreme, source: str) -> Iterator[tuple[str, str, Row]]:
    """Yield settings to try: in words, the source and its options, which are not the case's."""
    asked, options = resolve(source), case.options(source)
    if asked.kind == "solver":
        for step in (1e-3, 1e-4):
            words = f"p dt {step:g}, events to 1e-13"
            yield words, source, {"step": step, "event_tolerance": 1e-13}
    if asked.kind == "peer":
        yield "rtol 1e-12", source, {"rtol": 1e-12}
    if not asked.engine:
        return
    engine, preset = asked.declared, asked.used
    tuned = preset is not engine.presets[0]
    plain = {name: value for name, value in options.items() if name != "settings"}
    better = {name: value for name, value in plain.items() if name != "step"}
    if tuned and engine.remedy:
        words = ", ".join(f"{name} {value:g}" for name, value in engine.remedy.items())
        settings = {**options.get("settings", {}), **engine.remedy}
        yield words, source, {**options, "settings": settings}
    if case.contact is not None:
        yield "the preset's own contact", source, plain
    if case.step_s is not None:
        yield "the preset's own step", source, better
    elif tuned:
        step = 1e-4 if preset.stepping is Stepping.FIXED else 5e-4
        yield f"p dt {step:g}", source, {**options, "step": step}
    for other in engine.presets[1:] if preset is not engine.best else ():
        if other is not preset or better != options:
            yield f"preset {other.name}", f"{engine.name}:{other.name}", better


def without_result(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of sources that gave no result at all; other failures are answers."""
    answered = {row["source"] for row in rows if row["outcome"] != "failed"}
    return [row for row in rows if row["source"] not in answered]


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the matrix of cases and sources, and the largest steps."""
    searched = rows["table"] == "steps"
    own = ["table", "contact_s", "factor", "runs", *LARGEST]
    matrix = rows[~searched].drop(columns=own, errors="ignore")
    return {
        "stability": matrix.astype({"impacts": int, "steps": int}),
        "steps": rows.loc[searched].reindex(columns=STEPS).astype({"runs": int}),
    }


def by_preset(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return for each preset how many engines have it, and how many valid cases they predict."""
    valid = matrix["verdict"] != Verdict.INVALID.value
    asked = matrix[matrix["source"].map(is_engine) & valid]
    asked = asked.assign(right=asked["verdict"] == Verdict.GOOD.value)
    found = asked.groupby(asked["source"].map(preset_of)).agg(
        engines=("source", "nunique"), right=("right", "sum"), valid=("right", "size")
    )
    return found.loc[in_order(found.index)].rename_axis("preset").reset_index()


def verdicts(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return how often each source met each verdict."""
    counts = pd.crosstab(matrix["source"], matrix["verdict"])
    columns = [verdict.value for verdict in Verdict if verdict.value in counts]
    return counts.loc[list(matrix["source"].unique()), columns].reset_index()


def failures(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is a failure of their source."""
    return matrix[~matrix["verdict"].isin(GOOD)]


def finding(tables: Tables) -> str:
    """Say which part of the valid cases engines predict, with their first preset and their last."""
    matrix = tables["stability"]
    found = by_preset(matrix)
    if found.empty:
        right = (matrix["verdict"] == Verdict.GOOD.value).sum()
        return f"Models and solvers predict {out_of(right, len(matrix))} extreme cases."
    first, *_, last = found.to_dict("records") * 2
    share, best = (
        part(line["right"] / line["valid"]) if line["right"] else "none" for line in (first, last)
    )
    words = f"Engines predict {share} of the extreme cases {in_words(first['preset'])}"
    return f"{words}, {best} {in_words(last['preset'])}." if first != last else f"{words}."


def shown(tables: Tables) -> Mapping[str, pd.DataFrame]:
    """Return scores by preset, verdicts, failures and what mends them, and the largest steps."""
    matrix, steps = tables["stability"], tables["steps"]
    wrong = failures(matrix)
    unbounded = [reason.name for reason in (Reason.DIVERGED, Reason.THROWN, Reason.FAULT)]
    wrong = wrong.assign(
        unbounded=wrong["failure"].isin(unbounded), mended=~wrong["remedy"].isin(["", NOTHING])
    )
    kinds = wrong.groupby("verdict", sort=False)[["unbounded", "mended"]].agg("sum")
    kinds.insert(0, "failures", wrong["verdict"].value_counts())
    doubtful = matrix.loc[matrix["verdict"] == Verdict.INVALID.value, ["case", "invalid"]]
    return {
        "Valid cases that engines predict, by preset": by_preset(matrix),
        "Verdicts on the extreme cases": verdicts(matrix),
        "Failures, those without a bound, and those mended by another setting": kinds.reset_index(),
        "Failures, and what mends each": wrong[["case", "source", "reason", "remedy"]],
        "Cases for which the reference does not hold": doubtful.drop_duplicates("case"),
        "Largest steps, p dt, and over the contact's time": (
            steps[["case", "source", "contact_s", *LARGEST]]
        ),
    }


def figures(tables: Tables) -> Mapping[str, Figure]:
    """Draw the matrix of cases and methods."""
    from studies.drawing.stability import draw_matrix

    return {"stability": draw_matrix(tables["stability"], finding(tables))}


STUDY = Study(
    name="stability",
    question="Which methods stay finite, right and accurate in stiff and extreme cases?",
    help="""Stiff and extreme cases: who stays finite, keeps the outcome and the energy.

The outcome, the peak and the energy of each method in extreme cases, the setting that mends a
failure, and the largest stable and accurate steps. Takes some minutes. A failure is an answer: the
exit code is 1 only where a source gives no result at all. With less than the default --time-limit
a case may be given up while settings are tried. Writes stability.csv, steps.csv, findings.txt and a
picture.""",
    quick="Fewer cases, and steps to 30 %: less than a minute on 2 cores.",
    sources=METHODS,
    jobs=jobs,
    measure=measure,
    needed=without_result,
    tabulate=tabulate,
    finding=finding,
    shown=shown,
    figures=figures,
    running=Running(time_limit=LIMIT_S),
    captions={
        "stability": "Extreme cases as rows, methods as columns: the symbol says whether the "
        "outcome is right or how it is wrong, and whether peak and energy are.",
    },
)
command = STUDY.command()
