"""The releases of each engine, one after the other: how far off, and what changed."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from typing import Annotated

import pandas as pd
from tqdm import tqdm

from engines import installed_engines
from studies.kit.arguments import (
    BadInputError,
    Count,
    Place,
    Positive,
    check_engines,
    refuse_repeats,
    several,
    several_or_none,
)
from studies.kit.journal import Row
from studies.kit.options import Running
from studies.kit.plan import Plan, Tables, carry_out
from studies.versions import STUDY
from studies.versions.cases import jobs_of
from studies.versions.releases import (
    INSTALLED,
    Asked,
    Release,
    ask,
    check_releases,
    chosen,
    installed,
)
from studies.versions.report import headline, pictures, report
from studies.versions.tables import releases_table

__all__ = ["command", "headline", "pictures", "report"]


def command(
    *,
    out: Place,
    engines: Annotated[tuple[str, ...] | None, several_or_none] = None,
    releases: Annotated[tuple[str, ...], several] = (INSTALLED,),
    quick: bool = False,
    environments: Place | None = None,
    jobs: Count | None = None,
    time_limit: Positive = 60.0,
) -> int:
    """Ask the releases of each engine the same cases, each in an environment of its own.

    The release that is installed is always among them. The others are fetched. Without a network
    those of which there is an environment can still be named.

    Parameters
    ----------
    out
        Folder for the results, with one inside for each release; made if there is none.
    engines
        Names of engines, without a preset; by default all that are installed.
    releases
        "installed", by default; "minor": the last one of each minor number; "all"; or some by name,
        as in mujoco==3.2.7.
    quick
        A tenth of the cases.
    environments
        Folder for the environments, 2 to 300 MB each; by default one inside the results'.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which a case is given up.
    """
    engines = installed_engines() if engines is None else engines
    check_engines(engines)
    if missing := [name for name in engines if name not in installed_engines()]:
        raise BadInputError(f"--engines is {missing[0]!r}; it must be installed")
    refuse_repeats("--releases", releases)
    check_releases(releases, engines)
    running = Running(jobs=jobs, time_limit=time_limit)
    if releases == (INSTALLED,):
        return carry_out(STUDY, plan_here(engines, quick), out, running, report)
    limits = ("--time-limit", repr(time_limit), *(("--jobs", str(jobs)) if jobs else ()))
    options = (*limits, *(("--quick",) if quick else ()))
    environments = environments or out / "environments"
    found = {engine: chosen(engine, releases) for engine in engines}
    wanted = [release for some, _ in found.values() for release in some]

    def tabulate(_: object) -> Tables:
        each = tqdm(wanted, disable=None, unit="release")
        return {"releases": releases_table([ask(one, out, environments, options) for one in each])}

    growing = {"engine": engines, "release": releases}
    plan = Plan(settings={"quick": quick}, growing=growing, tabulate=tabulate)
    code = carry_out(STUDY, plan, out, running, report)
    unlisted = [problem for _, problem in found.values() if problem]
    for problem in unlisted:
        print(f"{problem}; the releases that were not named are missing", file=sys.stderr)
    return 1 if unlisted else code


def plan_here(engines: Sequence[str], quick: bool) -> Plan:
    """Return the plan that asks the releases that are installed, in this Python."""
    here = [installed(engine) for engine in engines]
    jobs = [job for release in here for job in jobs_of(release, quick)]
    return Plan(
        jobs=jobs,
        settings={"quick": quick},
        growing={"engine": engines},
        tabulate=partial(_tables_here, here),
        needed=lambda _: (),
    )


def _tables_here(here: Sequence[Release], rows: Sequence[Row]) -> Tables:
    answers = pd.DataFrame(rows)
    asked = [Asked(release, answers[answers["engine"] == release.engine]) for release in here]
    return {"answers": answers, "releases": releases_table(asked)}
