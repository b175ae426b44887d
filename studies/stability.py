"""Stiff and extreme cases: who stays finite, keeps the outcome, the energy and the peak."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from analytic.response import Response
from studies.cases.extreme import Extreme, extremes
from studies.kit.jobs import Job, Question, Row, ask, summary, unanswered
from studies.kit.say import out_of, part
from studies.kit.study import Figures, Study, Tables
from studies.measures.history import SAMPLES
from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.verdicts import ACCEPTED, ENERGY_BAND, Verdict, judge, reference
from studies.measures.wrongness import kind_of
from studies.sources.registry import core_sources, resolve

SOLVERS = ("rk4", "average-acceleration", "dop853", "radau")
METHODS = ("exact", *SOLVERS, *core_sources("", "tuned", "default"))
RUN_S = 60.0
"""Time limit of a row, and of a run of an engine [s]."""
MOST_STEPS = {"matrix": 5_000_000, "steps": 500_000}
"""Steps that a run of an engine may take, in each table."""
GOOD = [verdict.value for verdict in ACCEPTED]
FAILURE = ["case", "source", "verdict", "error", "energy_growth", "slip_widths"]
STEPS = ["case", "factor", "source", "outcome", "largest_stable", "message"]
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
        _job(case, source, {}, table="steps", factor=factor)
        for case in (PROBLEMS[1:2] if quick else PROBLEMS)
        for source in sources
        if resolve(source).stepping
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


def measure(job: Job) -> Row:
    """Return the verdict on an answer, or the largest stable step."""
    table, searched = job.labels["table"], job.labels["table"] == "steps"
    cases = PROBLEMS if searched else extremes(False)
    case = next(case for case in cases if case.name == job.labels["case"])
    limits = {"time_limit_s": RUN_S, "max_steps": MOST_STEPS[table]} if job.asked.engine else {}

    def respond(options: Mapping[str, Any]) -> Response:
        return ask(replace(job, options={**options, **limits}))

    if searched and job.lost is not None:
        return unanswered(job.lost.message)
    if searched:
        # a search that ends is an answer, though it be that no step is stable
        largest = largest_step(case, job.source, job.labels["factor"], respond)
        return {"outcome": "searched", "message": "", "largest_stable": largest}
    response = respond(job.options)
    return {**summary(response), **judge(case, job.source, response)}


def largest_step(
    case: Extreme, source: str, factor: float, respond: Callable[[Mapping[str, Any]], Response]
) -> float:
    """Return the largest step with which a source is stable, p dt; nan where there is none.

    With it the outcome is right, and free rocking gains no energy.
    """

    @cache
    def stable(step: float) -> bool:
        response = respond({"step": step})
        found = judge(case, source, response)
        wrong = kind_of(response, reference(case)[0])
        return not wrong and not found["energy_growth"] > ENERGY_BAND

    return largest_good(stable, factor)


def largest_good(good: Callable[[float], bool], factor: float) -> float:
    """Return the largest step up to which all steps tried are good; nan if not even the smallest.

    A step beyond the first bad one that happens to be good does not count.
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


def without_result(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of sources that gave no result at all; other failures are answers."""
    answered = {row["source"] for row in rows if row["outcome"] != "failed"}
    return [row for row in rows if row["source"] not in answered]


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the matrix of cases and sources, and the largest steps."""
    searched = rows["table"] == "steps"
    matrix = rows[~searched].drop(columns=["table", "factor", "largest_stable"], errors="ignore")
    whole = matrix.astype({"impacts": int, "steps": int})
    return {"stability": whole, "steps": rows.loc[searched].reindex(columns=STEPS)}


def scores(matrix: pd.DataFrame, *keys: str) -> pd.DataFrame:
    """Return how many valid cases engines predict, by preset, and by engine or case besides."""
    asked = matrix[matrix["source"].map(is_engine) & (matrix["verdict"] != Verdict.INVALID.value)]
    asked = asked.assign(
        engine=asked["source"].map(engine_of),
        preset=asked["source"].map(preset_of),
        right=asked["verdict"] == Verdict.GOOD.value,
    )
    found = asked.groupby([*keys, "preset"], sort=False).agg(
        engines=("source", "nunique"), right=("right", "sum"), valid=("right", "size")
    )
    return found.loc[in_order(found.index)].reset_index() if not keys else found.reset_index()


def by_case(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return a row for each case: with each preset, how many of the engines predict it."""
    found = scores(matrix, "case")
    words = [f"{right} of {valid}" for right, valid in found[["right", "valid"]].to_numpy()]
    wide = found.assign(words=words).pivot(index="case", columns="preset", values="words")
    wide = wide.reindex(index=found["case"].unique(), columns=in_order(found["preset"]))
    return wide.fillna("-").reset_index()


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
    found = scores(matrix)
    if found.empty:
        right = (matrix["verdict"] == Verdict.GOOD.value).sum()
        return f"Models and solvers predict {out_of(right, len(matrix))} extreme cases."
    first, *_, last = found.to_dict("records") * 2
    share, best = (
        part(line["right"] / line["valid"]) if line["right"] else "none" for line in (first, last)
    )
    words = f"Engines predict {share} of the extreme cases {in_words(first['preset'])}"
    return f"{words}, {best} {in_words(last['preset'])}." if first != last else f"{words}."


def shown(tables: Tables) -> Tables:
    """Return scores by preset, verdicts, failures, and the largest steps."""
    matrix, steps = tables["stability"], tables["steps"]
    doubtful = matrix.loc[matrix["verdict"] == Verdict.INVALID.value, ["case", "invalid"]]
    return {
        "Valid cases that engines predict, by preset": scores(matrix),
        "Engines that predict each case": by_case(matrix),
        "Verdicts on the extreme cases": verdicts(matrix),
        "Failures": failures(matrix)[FAILURE],
        "Cases for which the reference does not hold": doubtful.drop_duplicates("case"),
        "Largest stable steps, p dt": steps[["case", "source", "largest_stable"]],
    }


def figures(tables: Tables) -> Figures:
    """Draw the valid cases that engines predict."""
    from studies.drawing.stability import draw_scores

    engines, cases = (scores(tables["stability"], each) for each in ("engine", "case"))
    return {"stability": draw_scores(finding(tables), engines, cases)} if len(engines) else {}


STUDY = Study(
    name="stability",
    question="Which methods stay finite, right and accurate in stiff and extreme cases?",
    help="""Stiff and extreme cases: who stays finite, keeps the outcome and the energy.

The outcome, the peak and the energy of each method in extreme cases, and the largest stable
steps. Takes some minutes. A failure is an answer: the exit code is 1 only where a source
gives no result at all. Writes stability.csv, steps.csv, findings.txt and a picture.""",
    quick="Fewer cases, and steps to 30 %: less than a minute on 2 cores.",
    sources=METHODS,
    jobs=jobs,
    measure=measure,
    needed=without_result,
    tabulate=tabulate,
    finding=finding,
    shown=shown,
    figures=figures,
    captions={
        "stability": "How many of the valid extreme cases each engine predicts with each preset, "
        "and below the six cases on which the presets differ most.",
    },
)
command = STUDY.command()
