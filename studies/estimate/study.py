"""Random cases, each at a step and at half of it: what the difference says of the error."""

from __future__ import annotations

from dataclasses import asdict, replace
from pathlib import Path
from typing import Annotated

import pandas as pd

from studies.cases.drawn import Drawn
from studies.drawing.kept import Pictures, tell
from studies.estimate import STUDY
from studies.estimate.calibration import CALIBRATE, beside_errors, both_sets, factors
from studies.kit.arguments import BadInputError, Count, Place, check_sources, one_of
from studies.kit.jobs import Job
from studies.kit.naming import sources_option
from studies.kit.options import (
    DEFAULT_RUNNING,
    NOT_YOURS,
    OWN_EFFORT,
    EffortOptions,
    Running,
    Yours,
    refuse_two_steps,
)
from studies.kit.plan import Plan, carry_out
from studies.kit.tables import write_table
from studies.measures.halving import BOUNDED, MOST_TRUSTED, NO_BOUND, halved
from studies.measures.words import alike, listed, out_of, part
from studies.sources.groups import core_sources
from studies.sources.registry import Effort


def command(
    *,
    out: Place,
    cases: Count = 300,
    tests: Count = 100,
    seed: Count = 1,
    scene: Annotated[Drawn, one_of(Drawn)] = "block",
    sources: Annotated[tuple[str, ...], sources_option()] = core_sources("", "fixed", "naive"),
    effort: EffortOptions = OWN_EFFORT,
    yours: Yours = NOT_YOURS,
    running: Running = DEFAULT_RUNNING,
    yes: bool = False,
) -> int:
    """Hold the difference of every run from that at half its step against the true error.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
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
    yes
        Begin even what takes longer than a day.
    """
    check_sources(sources)
    # at a step and at half of it, which takes twice as long
    everyone = ("exact", *3 * sources)
    asked = f"--cases is {cases}, --tests {tests}"
    running.refuse_too_much(asked, cases + tests, everyone, yes=yes, effort=effort)
    refuse_two_steps(effort.step, yours)
    own = {name: value for name, value in asdict(yours).items() if value is not None}
    own |= {} if scene == "block" else {"scene": scene}
    plan = Plan(
        jobs=pairs(cases, tests, seed, sources, effort, yours, scene=scene),
        settings={"seed": seed, "tests": tests, **asdict(effort), **own},
        growing={"case": range(max(cases, tests)), "source": sources},
    )
    return carry_out(STUDY, plan, out, running, report)


def pairs(
    cases: int,
    tests: int,
    seed: int,
    sources: tuple[str, ...],
    effort: Effort = OWN_EFFORT,
    yours: Yours = NOT_YOURS,
    *,
    scene: Drawn = "block",
) -> list[Job]:
    """Return two jobs for each case and source, the second at half the step.

    Raises
    ------
    BadInputError
        If a source has no step that could be halved.
    """
    jobs = []
    for use, case in both_sets(cases, tests, seed, scene):
        own = yours.options(sources, case.block)
        for source in sources:
            labels = {"set": use, **asdict(case), "half": 0}
            job = Job(
                labels=labels,
                block=case.block,
                motion=case.motion,
                source=source,
                options={**effort.options(source), **own[source]},
            )
            finer = halved(job)
            if finer is None:
                words = "it must be an engine with steps that can be halved"
                raise BadInputError(f"--sources is {source!r}; {words}")
            jobs += [job, replace(finer, labels={**labels, "half": 1})]
    return jobs


def report(folder: Path) -> str:
    """Hold a folder's estimates against the errors; write two tables, return the text."""
    rows = pd.read_csv(folder / "estimate.csv", dtype={"message": str})
    lines = beside_errors(rows)
    table = factors(lines)
    for name, kept in (("estimates", lines), ("factors", table)):
        write_table(folder / f"{name}.csv", kept)
    title = "Estimates, errors, and the factors between them"
    return tell(folder, pictures(folder), first_claim(table), {title: table})


def headline(folder: Path) -> str:
    """Say whose estimates bound the error, and whose give no bound."""
    return first_claim(pd.read_csv(folder / "factors.csv"))


def pictures(folder: Path) -> Pictures:
    """Draw the errors of the cases that calibrate, from a folder's estimates.csv alone."""
    from studies.estimate.figure import draw_estimates

    lines = pd.read_csv(folder / "estimates.csv")
    return {"estimate": draw_estimates(lines[lines["set"] == CALIBRATE])}


def first_claim(table: pd.DataFrame) -> str:
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
