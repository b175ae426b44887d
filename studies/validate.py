"""Random cases that no setting was tuned on: as they are, or also at half the step."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from itertools import islice
from typing import Annotated

import numpy as np
import pandas as pd

from analytic import Outcome, simulate
from engines.declaration import AT_REST
from studies.cases.drawn import Drawn, RandomCase, draw
from studies.cases.refusal import BadInputError
from studies.kit.arguments import Count, EffortOptions, one_of
from studies.kit.jobs import Job, Question, Row
from studies.kit.say import out_of, part
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures import differences
from studies.measures.differences import WELL_CONDITIONED, sensitivity_of, with_reference
from studies.measures.halving import BOUNDED, MOST_TRUSTED, USES, estimate_of, factors, halved
from studies.measures.presets import titled
from studies.measures.wrongness import KINDS
from studies.sources.registry import core_sources

CASES, TESTS = {False: (500, 100), True: (300, 20)}, (100, 10)
"""Random cases, in full and quickly: without --halves and with it, and of those that test."""


@dataclass(frozen=True, kw_only=True)
class Options(EffortOptions):
    """Which random cases, and whether at half the step, too."""

    halves: bool = False
    """Run every engine at half its step, too, and find the factor with which the difference of the
    two peaks bounds the error."""
    cases: Count | None = None
    """Number of random cases; by default 500, with --halves 300."""
    seed: Count = 1
    """Seed of the random numbers, a positive whole number; another one draws other cases."""
    scene: Annotated[Drawn, one_of(Drawn)] = "block"
    """block: one block that rocks. frame: a beam on 2 to 5 columns."""


def jobs(sources: Sequence[str], quick: bool, options: Options) -> list[Job]:
    """Return the jobs in the order of the table: case by case, source by source."""
    cases = options.cases or CASES[options.halves][quick]
    options.refuse_idle(sources)
    own = {source: options.options(source) for source in sources}
    if options.halves:
        return _with_halves(own, cases, TESTS[quick], options)
    return [
        _job({"seed": options.seed}, case, source, settings)
        for case in islice(draw(options.seed, options.scene), cases)
        for source, settings in own.items()
    ]


def _job(labels: Row, case: RandomCase, source: str, settings: Row) -> Job:
    posed = Question(system=case.block, motion=case.motion)
    return Job(labels={**labels, **asdict(case)}, case=posed, source=source, options=settings)


def _with_halves(own: Mapping[str, Row], cases: int, tests: int, options: Options) -> list[Job]:
    found = []
    for number, (use, count) in enumerate(zip(USES, (tests, cases), strict=True)):
        drawn = draw(options.seed + number, options.scene)
        rocked = (it for it in drawn if simulate(it.block, it.motion).outcome is Outcome.ROCKED)
        for place, case in enumerate(islice(rocked, count)):
            for source, settings in own.items():
                job = _job({"set": use}, replace(case, case=place), source, settings)
                if (finer := halved(job)) is None:
                    words = "with --halves it must be an engine with steps that can be halved"
                    raise BadInputError(f"--sources is {source!r}; {words}")
                pair = enumerate((job, finer))
                found += [replace(each, labels={**job.labels, "half": half}) for half, each in pair]
    return found


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return errors, or factors."""
    if "half" in rows:
        lines = beside_errors(rows)
        return {"estimate": rows, "estimates": lines, "factors": factors(lines)}
    return {"errors": with_reference(rows.drop(columns="seed"))}


def beside_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Return the rows at the whole step, each with its estimate, and with the error over that."""
    whole = with_reference(rows[rows["half"] == 0]).reset_index(drop=True)
    finer = rows[rows["half"] == 1].to_dict("records")
    pairs = zip(whole.to_dict("records"), finer, strict=True)
    whole["estimate"] = [estimate_of(*pair) for pair in pairs]
    errors = whole["error"].abs()
    over = (errors / whole["estimate"]).where(errors > 1e-9, 0.0)
    return whole.assign(over=over.where(errors.notna() & whole["estimate"].notna()))


def finding(tables: Tables) -> str:
    """Say what the sources predict, or what bounds their errors."""
    if "factors" in tables:
        high = tables["factors"]["factor_95_high"]
        if np.isinf(high).all():
            return f"Too few random cases for a factor that bounds {part(BOUNDED)} of the errors."
        good = high[high <= MOST_TRUSTED]
        most = MOST_TRUSTED if good.empty else good.max()
        return (
            f"Halve the step, and multiply the change by {most:.2g}: this bounds {part(BOUNDED)} "
            f"of the errors of {out_of(len(good), len(high))} presets."
        )
    errors = tables["errors"]
    # a base at rest may put an engine to sleep, which gravity that turns does not wake
    told = errors["source"].ne("exact") & ~errors["source"].str.endswith(AT_REST)
    errors = errors[told] if told.any() else errors
    calm = errors["error"].abs().where(sensitivity_of(errors) < WELL_CONDITIONED)
    lines = errors.assign(wrong=~errors["agrees"], calm=calm).groupby("source", sort=False)
    order = lines.agg({"wrong": "sum", "calm": "max", "case": "size"})
    order = order.sort_values(["wrong", "calm"], kind="stable").reset_index()
    (best, wrong, peaks, cases), (worst, missed, off, _) = order.iloc[[0, -1]].to_numpy()
    within = "" if math.isnan(peaks) else f", and well-conditioned peaks within {part(peaks)}"
    loses = f"{missed} outcome{'s' if missed > 1 else ''}" if missed else f"peaks by {part(off)}"
    other = f"; {titled(worst)} misses {loses}" if len(order) > 1 else ""
    right = out_of(cases - wrong, cases)
    return f"{titled(best)} predicts the outcome of {right} random cases{within}{other}."


def shown(tables: Tables) -> Tables:
    """Return the lines of each source."""
    if "factors" in tables:
        return {"Estimates, errors, and the factors between them": tables["factors"]}
    errors, s = tables["errors"], sensitivity_of(tables["errors"])
    calm = f" where a peak moves by S < {WELL_CONDITIONED:g} % for 1 % of pulse or impacts"
    every = errors.assign(figure="all")
    groups = {"": every, calm: every[s < WELL_CONDITIONED]}
    found = {cases: differences.summarize(rows) for cases, rows in groups.items()}
    sizes = ["median_error", "p90_error", "max_error", "median_difference", "max_difference"]
    parts = {"Outcomes{}": ["cases", "agree", *KINDS], "Errors{}, differences over θcr": sizes}
    return {
        title.format(cases): lines.reindex(columns=["source", *names])
        for title, names in parts.items()
        for cases, lines in found.items()
    }


def figures(tables: Tables) -> Figures:
    """Draw the errors in bands of the sensitivity; there is no figure of factors."""
    from studies.drawing.rows import draw_conditioning

    return {"validate": draw_conditioning(tables["errors"])} if "errors" in tables else {}


STUDY = Study(
    name="validate",
    question="Do sources predict random cases, on which no setting was tuned?",
    help="""Random blocks (H/B 1.2 to 12, B 0.02 to 10 m) under pulses of 1.02 to 4 times the onset.

Writes errors.csv: outcomes, quantiles of the error, condition numbers, and the sensitivity of each
peak to errors of 1e-6 to 1e-3. With --halves, in another folder, it estimates each error from the
same engine at half the step, and writes estimate.csv, estimates.csv and factors.csv.""",
    sources=core_sources(),
    options=Options,
    quick="100 random cases; with --halves 20, and 10 to test the factors.",
    captions={
        "validate": "Errors of random cases in bands of the sensitivity S: for each engine the "
        "median, the middle half and the extremes.",
    },
    **stages(jobs, tabulate, finding, shown, figures),
)
command = STUDY.command()
