"""Random cases, each at a step and at half of it: what the difference says of the error."""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import asdict, replace
from itertools import islice
from pathlib import Path
from typing import Annotated

import pandas as pd

from analytic import simulate
from analytic.response import Outcome
from studies.cases.drawn import Drawn, RandomCase, draw
from studies.drawing.kept import tell
from studies.estimate import STUDY
from studies.old.arguments import BadInputError, Count, Out, Yes, one_of, refuse_both
from studies.old.jobs import Job
from studies.old.naming import Sources
from studies.old.options import (
    DEFAULT_RUNNING,
    NOT_YOURS,
    OWN_EFFORT,
    EffortOptions,
    Running,
    Yours,
)
from studies.old.plan import Plan, carry_out
from studies.old.tables import write_table
from studies.measures.differences import with_reference, with_reference_of_frames
from studies.measures.halving import BOUNDED, MOST_TRUSTED, NO_BOUND, estimates_of, halved
from studies.measures.words import alike, listed, out_of, part
from studies.measures.wrongness import FALL, REST, wrong_in
from studies.sources.registry import core_sources

DEFAULT_SOURCES = core_sources("", "fixed", "naive")


def command(
    *,
    out: Out,
    cases: Count = 300,
    tests: Count = 100,
    seed: Count = 1,
    scene: Annotated[Drawn, one_of(Drawn)] = "block",
    sources: Sources = DEFAULT_SOURCES,
    effort: EffortOptions = OWN_EFFORT,
    yours: Yours = NOT_YOURS,
    running: Running = DEFAULT_RUNNING,
    yes: Yes = False,
) -> int:
    """Hold the difference of every run from that at half its step against the true error.

    Parameters
    ----------
    cases
        Number of random cases that calibrate: from them come the factors.
    tests
        Number of other random cases, on which the factors are tried.
    seed
        Seed of the random numbers of the cases that test, a positive whole number; those that
        calibrate are drawn with the next one.
    scene
        block: one block that rocks. frame: a beam on 2 to 5 columns.
    sources
        Engines, as they are declared; those that choose their own steps have none to halve.
    """
    # at a step and at half of it, which takes twice as long
    everyone = ("exact", *3 * sources)
    asked = f"--cases is {cases}, --tests {tests}"
    running.refuse_too_much(asked, cases + tests, everyone, yes=yes, effort=effort)
    refuse_both(dt=yours.dt, step=effort.step)
    effort.refuse_idle(sources)
    own = {name: value for name, value in asdict(yours).items() if value is not None}
    own |= {} if scene == "block" else {"scene": scene}
    jobs = []
    for use, case in both_sets(cases, tests, seed, scene):
        options = yours.options(sources, case.block)
        for source in sources:
            job = Job(
                labels={"set": use, **asdict(case), "half": 0},
                block=case.block,
                motion=case.motion,
                source=source,
                options={**effort.options(source), **options[source]},
            )
            finer = halved(job)
            if finer is None:
                words = "it must be an engine with steps that can be halved"
                raise BadInputError(f"--sources is {source!r}; {words}")
            jobs += [job, replace(finer, labels={**job.labels, "half": 1})]
    plan = Plan(
        jobs=jobs,
        settings={"seed": seed, "tests": tests, **asdict(effort), **own},
        growing={"case": range(max(cases, tests)), "source": sources},
    )
    return carry_out(STUDY, plan, out, running, report)


def report(folder: Path) -> str:
    """Hold a folder's estimates against the errors; write two tables, return the text."""
    rows = pd.read_csv(folder / "estimate.csv", dtype={"message": str})
    lines = beside_errors(rows)
    table = factors(lines)
    for name, kept in (("estimates", lines), ("factors", table)):
        write_table(folder / f"{name}.csv", kept)
    title = "Estimates, errors, and the factors between them"
    return tell(STUDY, folder, {title: table})


def finding(table: pd.DataFrame) -> str:
    """Say whose estimates bound the error, how many on other cases, and whose give no bound."""
    bound = table["factor_95_high"] <= MOST_TRUSTED
    good, blind = table[bound], table[~bound]
    claim, said = "The difference from half the step", []
    if not good.empty:
        ends = [f"{end(good['factor_95_high']):.2g}" for end in (min, max)]
        tried = out_of(int(good["bounded"].sum()), int(good["tested"].sum()))
        said += [
            f", times {alike(ends, 'to')}, bounds {part(BOUNDED)} of the "
            f"errors with {out_of(len(good), len(table))} presets ({tried} on other cases)"
        ]
    if not blind.empty:
        said += [f"{' it' if said else ''} gives {NO_BOUND} with {listed(list(blind['source']))}"]
    return f"{claim}{';'.join(said)}."


CALIBRATE, TEST = "calibrate", "test"
"""What a case is for: to find the factors, or to hold them against errors that they never saw."""

RESOLVED = 1e-9
"""Errors below are as good as none: no estimate has to bound them."""

CONFIDENCE = 0.95
"""Of the interval of a factor."""


def both_sets(
    cases: int, tests: int, seed: int, scene: Drawn = "block"
) -> Iterator[tuple[str, RandomCase]]:
    """Yield so many cases that test and so many that calibrate, each with what it is for.

    Those that test are drawn with the seed, those that calibrate with the next one; kept are cases
    in which the exact solution rocks and survives.
    """
    for use, first, count in ((TEST, seed, tests), (CALIBRATE, seed + 1, cases)):
        kept = (
            drawn
            for drawn in draw(first, scene)
            if simulate(drawn.block, drawn.motion).outcome is Outcome.ROCKED
        )
        for number, drawn in enumerate(islice(kept, count)):
            yield use, replace(drawn, case=number)


def beside_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each case and source: its estimate beside its error.

    Parameters
    ----------
    rows : DataFrame
        The columns of estimate.csv, half being 1 for the runs at half the step.

    Returns
    -------
    DataFrame
        The rows at the whole step with the columns of `with_reference`, estimate, and over: the
        error over the estimate, 0 where there is no error to speak of; nan unless both rocked.
    """
    held = with_reference_of_frames if "load" in rows else with_reference
    whole = held(rows[rows["half"] == 0]).reset_index(drop=True)
    whole["estimate"] = math.nan
    for _, mine in whole.groupby("set"):
        finer = rows[(rows["half"] == 1) & (rows["set"] == mine["set"].iloc[0])]
        whole.loc[mine.index, "estimate"] = estimates_of(mine, finer)
    errors = whole["error"].abs()
    over = (errors / whole["estimate"]).where(errors > RESOLVED, 0.0)
    return whole.assign(over=over.where(errors.notna() & whole["estimate"].notna()))


def factors(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: by how much its estimates are to be multiplied.

    Parameters
    ----------
    lines : DataFrame
        From `beside_errors`.

    Returns
    -------
    DataFrame
        The columns of factors.csv; those from cases to told are of the cases that calibrate.
    """
    table = []
    for source, rows in lines.groupby("source", sort=False):
        found = _found(rows[rows["set"] == CALIBRATE])
        other = rows.loc[rows["set"] == TEST, "over"].dropna()
        bounded = int((other <= found["factor_95_high"]).sum())
        table.append({"source": source, **found, "tested": len(other), "bounded": bounded})
    return pd.DataFrame(table)


def _found(rows: pd.DataFrame) -> dict[str, float]:
    """Return what one source's cases that calibrate tell."""
    over = rows["over"].dropna()
    kept = rows.loc[over.index]
    wrong = rows[wrong_in(rows).isin((FALL, REST))]
    low, high = interval(over, BOUNDED)
    return {
        "cases": len(rows),
        "survivors": len(kept),
        "median_estimate": kept["estimate"].median(),
        "median_error": kept["error"].abs().median(),
        "factor_50": _quantile(over, 0.5),
        "factor_95": _quantile(over, BOUNDED),
        "factor_95_low": low,
        "factor_95_high": high,
        "factor_all": _quantile(over, 1.0),
        "within_3": (over <= 3.0).mean(),
        "within_10": (over <= 10.0).mean(),
        "wrong": len(wrong),
        "told": int((wrong["estimate"] == math.inf).sum()),
    }


def interval(values: pd.Series[float], level: float) -> tuple[float, float]:
    """Return the ends of the interval that holds a quantile with `CONFIDENCE`, whatever is drawn.

    How many of n values are below the quantile is binomial, so that its ends are values themselves
    (Conover, "Practical Nonparametric Statistics", 1999, section 3.2); the upper is inf where the
    values are too few for one.
    """
    from scipy.stats import binom

    ordered = values.sort_values(ignore_index=True)
    if ordered.empty:
        return 0.0, math.inf
    below = binom(len(ordered), level)
    first = max(int(below.ppf(0.5 * (1.0 - CONFIDENCE))) - 1, 0)
    last = int(below.ppf(0.5 * (1.0 + CONFIDENCE)))
    return float(ordered[first]), float(ordered[last]) if last < len(ordered) else math.inf


def _quantile(values: pd.Series[float], level: float) -> float:
    """Return the smallest value that so much of all are not above; nan without any."""
    ordered = values.sort_values(ignore_index=True)
    if ordered.empty:
        return math.nan
    return float(ordered[max(math.ceil(level * len(ordered)) - 1, 0)])
