"""The releases of each engine, one after the other: how far off, and what changed."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import Annotated

import pandas as pd
from tqdm import tqdm

from engines import installed_engines
from studies.drawing.kept import Pictures, tell
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
from studies.kit.tables import read_table, write_table
from studies.measures.words import listed, out_of
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
from studies.versions.tables import CHANGED, answered, changes_table, is_changed, releases_table


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


SHOWN = [
    *("engine", "release", "source", "set", "cases", "failed", "right"),
    *("median_error", "p90_error", "max_error", "moved", "turned", "message"),
]


def report(folder: Path) -> str:
    """Write what changed beside a folder's releases.csv, draw both; return them as text."""
    lines = read(folder, "releases")
    write_table(folder / "changes.csv", changes_table(lines))
    other = lines["moved"].isna() | is_changed(lines)
    tables = {
        f"Answers that moved by more than {CHANGED:g}, or turned into another outcome": (
            read(folder, "changes")
        ),
        "Errors of the peak, relative, over cases that both survive, of the first release and of "
        "those that do not answer as the one before": lines.loc[other, SHOWN],
    }
    return tell(folder, pictures(folder), headline(folder), tables)


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back, with empty words as such."""
    words = ("release", "before", "source", "set", "note", "link")
    return read_table(folder / f"{name}.csv", *words)


def headline(folder: Path) -> str:
    """Say between how many releases of each engine the answers changed."""
    return first_claim(read(folder, "releases"), read(folder, "changes"))


def first_claim(lines: pd.DataFrame, changes: pd.DataFrame) -> str:
    """Say between which releases of which engines an answer moved, and between which none did."""
    moved, still = [], []
    for engine, mine in answered(lines).groupby("engine", sort=False):
        releases = mine["release"].unique()
        times = len(changes[changes["engine"] == engine])
        name = f"{engine} ({releases[0]} to {releases[-1]}"
        if times:
            moved.append(f"{name}, at {out_of(times, len(releases) - 1)} steps)")
        elif len(releases) > 1:
            still.append(f"{name})")
    if not (moved or still):
        return "Of each engine one release was asked."
    bound, words = f"by more than {CHANGED:g}", []
    if still:
        words.append(f"no answer moves {bound} in {listed(still)}")
    if moved:
        words.append(f"{'some do' if still else f'answers move {bound}'} in {listed(moved)}")
    return f"From one release to the next {'; '.join(words)}."


def pictures(folder: Path) -> Pictures:
    """Draw errors by release from a folder's releases.csv and changes.csv alone."""
    from studies.versions.figure import draw_versions

    return {"versions": draw_versions(read(folder, "releases"), read(folder, "changes"))}
