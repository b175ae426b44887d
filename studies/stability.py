"""Stiff and extreme cases: who stays finite, keeps the outcome, the energy and the peak."""

from __future__ import annotations

import enum
import math
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from analytic import conditioning, simulate
from analytic.response import Outcome, Reason, Response
from studies.cases.extreme import Extreme, extremes
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.say import out_of, part
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures.history import SAMPLES, growth
from studies.measures.presets import engine_of, in_order, is_engine, look_of, preset_of
from studies.measures.wrongness import FALL, NO_ANSWER, REST, kind_of
from studies.sources.registry import core_sources, resolve

BAND, WIDE_BAND = 0.01, 0.1
"""Relative error of the peak that is accurate, and that is still a result."""
ENERGY_BAND, SLIP_BAND = 0.01, 0.01
"""Rise of the energy of free rocking over its largest value, and slip over B, that count."""
SMALLEST = 1e-6
"""Peaks below this part of θcr may go unseen."""
RUN_S = 180.0
"""Time limit of a row, and of a run of an engine [s]."""
MOST_STEPS = 5_000_000
"""Steps that a run of an engine may take."""


class Verdict(enum.Enum):
    """How an answer compares with the exact solution."""

    GOOD = "good"
    UNSEEN = "unseen"
    COARSE = "coarse"
    OFF = "off"
    SLIDES = "slides"
    ENERGY = "energy"
    FALL = FALL
    REST = REST
    FAILED = NO_ANSWER
    INVALID = "invalid"


GOOD = [verdict.value for verdict in (Verdict.GOOD, Verdict.UNSEEN, Verdict.INVALID)]
"""Verdicts that are nobody's failure."""
FAILURE = ["case", "source", "verdict", "error", "energy_growth", "slip_widths"]


def jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return a job for each extreme case and each source to which it applies."""
    return [
        _job(case, source) for case in extremes(quick) for source in sources if case.applies(source)
    ]


def _job(case: Extreme, source: str) -> Job:
    times = np.linspace(case.motion.duration, case.duration, SAMPLES)
    asked = Question(system=case.block, motion=case.motion, duration=case.duration, times=times)
    labels = {"group": case.group, "case": case.name}
    return Job(labels=labels, case=asked, source=source, options=case.options(source))


def measure(job: Job) -> Row:
    """Return an answer and the verdict on it."""
    case = next(case for case in extremes(False) if case.name == job.labels["case"])
    limits = {"time_limit_s": RUN_S, "max_steps": MOST_STEPS} if job.asked.engine else {}
    response = ask(replace(job, options={**job.options, **limits}))
    return {**summary(response), **judge(case, job.source, response)}


@cache
def reference(case: Extreme) -> tuple[Response, float]:
    """Return the exact response to a case, and how its peak depends on the amplitude, κ."""
    return simulate(case.block, case.motion), conditioning(case.block, case.motion)[0]


def judge(case: Extreme, source: str, response: Response) -> dict[str, Any]:
    """Return the verdict on a source's response, and what compares it with the exact solution."""
    exact, kappa = reference(case)
    both = exact.outcome is Outcome.ROCKED and not kind_of(response, exact)
    error = response.peak_ratio / exact.peak_ratio - 1.0 if both else math.nan
    grown = growth(case.block, case.motion, response)
    verdict, why = _verdict(case, response, error, grown), invalidity(case, source)
    # a run that leaves the problem is right where the reference does so
    left = response.reason in (Reason.SLID, Reason.THROWN)
    if why and verdict is not Verdict.GOOD and (left or verdict is not Verdict.FAILED):
        verdict = Verdict.INVALID
    return {
        "exact_outcome": exact.outcome.value,
        "exact_peak": exact.peak_ratio,
        "error": error,
        "kappa": kappa,
        "energy_growth": grown,
        "slip_widths": response.slip_m / case.block.width,
        "friction": friction_of(case, source),
        "friction_needed": exact.friction_needed,
        "min_normal": exact.min_normal,
        "invalid": why,
        "verdict": verdict.value,
        "failure": response.reason.name if response.reason else "",
    }


def _verdict(case: Extreme, response: Response, error: float, grown: float) -> Verdict:
    exact, found = reference(case)[0], response.outcome
    wrong = kind_of(response, exact)
    if found is Outcome.AT_REST and 0.0 < exact.peak_ratio < SMALLEST:
        return Verdict.UNSEEN
    if wrong:
        return Verdict(wrong)
    if grown > ENERGY_BAND:
        return Verdict.ENERGY
    if response.slip_m / case.block.width > SLIP_BAND:
        return Verdict.SLIDES
    if math.isnan(error) or abs(error) <= BAND or abs(error) * exact.peak_ratio <= SMALLEST:
        return Verdict.GOOD
    return Verdict.COARSE if abs(error) <= WIDE_BAND else Verdict.OFF


def invalidity(case: Extreme, source: str) -> str:
    """Say why an engine may differ from the exact solution; empty where it, or a model, may not."""
    exact, friction = reference(case)[0], friction_of(case, source)
    if math.isnan(friction):
        return ""
    if exact.min_normal < 0.0:
        return f"the pivot lifts off: N falls to {exact.min_normal:.2g} m g"
    if exact.friction_needed > friction:
        return f"it slides: friction {exact.friction_needed:.3g} needed, {friction:g} there"
    return ""


def friction_of(case: Extreme, source: str) -> float:
    """Return an engine's friction in a case, its own or else the preset's; nan of other sources."""
    asked = resolve(source)
    if asked.kind != "engine":
        return math.nan
    return float(case.options(source).get("friction", asked.used.settings.friction))


def without_result(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of sources that gave no result at all; other failures are answers."""
    answered = {row["source"] for row in rows if row["outcome"] != "failed"}
    return [row for row in rows if row["source"] not in answered]


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the matrix of cases and sources."""
    return {"stability": rows.astype({"impacts": int, "steps": int})}


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
    words = f"Engines predict {share} of the extreme cases {look_of(first['preset']).words}"
    return f"{words}, {best} {look_of(last['preset']).words}." if first != last else f"{words}."


def shown(tables: Tables) -> Tables:
    """Return scores by preset, verdicts and failures."""
    matrix = tables["stability"]
    doubtful = matrix.loc[matrix["verdict"] == Verdict.INVALID.value, ["case", "invalid"]]
    return {
        "Valid cases that engines predict, by preset": scores(matrix),
        "Engines that predict each case": by_case(matrix),
        "Verdicts on the extreme cases": verdicts(matrix),
        "Failures": failures(matrix)[FAILURE],
        "Cases for which the reference does not hold": doubtful.drop_duplicates("case"),
    }


def figures(tables: Tables) -> Figures:
    """Draw the valid cases that engines predict."""
    from studies.drawing.rows import draw_scores

    engines, cases = (scores(tables["stability"], each) for each in ("engine", "case"))
    return {"stability": draw_scores(finding(tables), engines, cases)} if len(engines) else {}


STUDY = Study(
    name="stability",
    question="Which methods stay finite, right and accurate in stiff and extreme cases?",
    help="""Stiff and extreme cases: which methods stay finite and keep outcome and energy.

A failed case is a result: the exit code is 1 only if a source gives no result at all. Takes some
minutes. Writes stability.csv, findings.txt and a picture.""",
    quick="Fewer cases: less than a minute on 2 cores.",
    sources=(
        *("exact", "rk4", "average-acceleration", "dop853", "radau"),
        *core_sources("", "tuned", "default"),
    ),
    needed=without_result,
    captions={
        "stability": "Valid extreme cases that each engine predicts with each preset; below, the "
        "six cases on which presets differ most.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
