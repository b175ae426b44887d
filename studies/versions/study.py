"""The releases of each engine, one after the other: how far off, and what changed."""

from __future__ import annotations

import math
import sys
from collections.abc import Iterable, Sequence
from functools import partial
from itertools import islice
from pathlib import Path
from typing import Annotated, Any

import pandas as pd
from tqdm import tqdm

from analytic.block import Rocker
from analytic.motion import Motion
from engines import ENGINES, installed_engines
from studies.cases.drawn import RandomCase, draw
from studies.cases.paper import Case, sweep_cases
from studies.drawing.kept import tell
from studies.kit.arguments import (
    BadInputError,
    Count,
    Place,
    Positive,
    refuse_repeats,
    several,
)
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.kit.naming import Engines
from studies.kit.options import Running
from studies.kit.plan import Plan, Tables, carry_out
from studies.kit.tables import write_table
from studies.measures.words import listed, out_of
from studies.versions import STUDY
from studies.versions.releases import (
    INSTALLED,
    Asked,
    Release,
    ask,
    check_releases,
    chosen,
    installed,
)
from studies.versions.tables import (
    CHANGED,
    RELEASES,
    answered,
    changes_table,
    is_changed,
    releases_table,
)

FIGURE, SEED = 8, 1
"""Figure of the paper whose cases are asked, and the seed of the random ones."""

RANDOM = 50
"""Random cases, the first ones of `rocking validate`."""

STEP = 1e-3
"""p dt of presets with equal steps of their own choice: finer ones see no more of a change."""

EVERY = 10
"""One in so many cases is asked where it is to be quick."""


def jobs_of(release: Release, quick: bool) -> list[Job]:
    """Return the jobs that put every case to every preset of the release that is installed."""
    return [
        Job(
            labels={"engine": release.engine, "release": release.version, **labels},
            block=block,
            motion=motion,
            source=f"{release.engine}:{preset.name}",
            options={} if math.isnan(preset.step) else {"step": STEP},
        )
        for labels, block, motion in posed(quick)
        for preset in ENGINES[release.engine].presets
    ]


def posed(quick: bool) -> list[tuple[dict[str, Any], Rocker, Motion]]:
    """Return labels, block and motion of every case: those of the figure, then random ones."""
    asked: dict[str, Iterable[Case | RandomCase]] = {
        f"figure {FIGURE}": sweep_cases([FIGURE]),
        "random": islice(draw(SEED), RANDOM),
    }
    every = EVERY if quick else 1
    return [
        (
            {
                "set": name,
                "case": number,
                "aspect": float(case.aspect),
                "width_m": case.width_m,
                "half_cycles": case.motion.half_cycles,
                "amplitude_g": case.amplitude_g,
                "omega_over_p": case.omega_over_p,
            },
            case.block,
            case.motion,
        )
        for name, cases in asked.items()
        for number, case in islice(enumerate(cases), 0, None, every)
    ]


def command(
    *,
    out: Place,
    engines: Engines | None = None,
    releases: Annotated[tuple[str, ...], several] = (INSTALLED,),
    quick: bool = False,
    jobs: Count | None = None,
    time_limit: Positive = 60.0,
) -> int:
    """Ask the releases of each engine the same cases, each in an environment of its own.

    Parameters
    ----------
    out
        Folder for the results, with one inside for each release; made if there is none.
    engines
        Names of engines, without a preset, of those that are installed.
    releases
        "installed", by default; "minor": the last one of each minor number; "all"; or some by name,
        as in mujoco==3.2.7.
    quick
        A tenth of the cases.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which a case is given up.
    """
    engines = installed_engines() if engines is None else engines
    if missing := [name for name in engines if name not in installed_engines()]:
        raise BadInputError(f"--engines is {missing[0]!r}; it must be installed")
    refuse_repeats("--releases", releases)
    check_releases(releases, engines)
    running = Running(jobs=jobs, time_limit=time_limit)
    if releases == (INSTALLED,):
        return carry_out(STUDY, plan_here(engines, quick), out, running, report)
    limits = ("--time-limit", repr(time_limit), *(("--jobs", str(jobs)) if jobs else ()))
    options = (*limits, *(("--quick",) if quick else ()))
    found = {engine: chosen(engine, releases) for engine in engines}
    wanted = [release for some, _ in found.values() for release in some]

    def tabulate(_: object) -> Tables:
        each = tqdm(wanted, disable=None, unit="release")
        asked = [ask(one, out, options) for one in each]
        return {"releases": releases_table([it for it in asked if it.has_wheel or is_named(it)])}

    def is_named(it: Asked) -> bool:
        return f"{it.release.engine}=={it.release.version}" in releases

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


SHOWN = [name for name in RELEASES if name != "moved_cases"]


def report(folder: Path) -> str:
    """Write what changed beside a folder's releases.csv, draw both; return them as text."""
    lines = STUDY.read(folder, "releases")
    write_table(folder / "changes.csv", changes_table(lines))
    other = lines["moved"].isna() | is_changed(lines)
    tables = {
        f"Answers that moved by more than {CHANGED:g}, or turned into another outcome": (
            STUDY.read(folder, "changes")
        ),
        "Errors of the peak, relative, over cases that both survive, of the first release and of "
        "those that do not answer as the one before": lines.loc[other, SHOWN],
    }
    return tell(STUDY, folder, tables)


def finding(lines: pd.DataFrame, changes: pd.DataFrame) -> str:
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
