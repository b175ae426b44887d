"""Whether an installation works: a line for each thing that a run depends on."""

import os
import platform
import shutil
from collections.abc import Iterator
from itertools import chain
from pathlib import Path
from typing import NamedTuple

from analytic import simulate
from analytic.kernels.compiled import SOURCES
from analytic.kernels.kept import kept_in
from analytic.response import Response
from engines import ENGINES, installed_engines
from engines.declaration import UNTUNED
from engines.parts.compiled import PACKAGE
from studies.cases.paper import HISTORIES
from studies.old.arguments import TimeLimit
from studies.old.jobs import Job
from studies.old.options import Computing
from studies.old.provenance import (
    NUMERICAL_PACKAGES,
    project_version,
    usable_cores,
    version_of,
)
from studies.old.refusing import brief
from studies.measures.differences import scientific
from studies.measures.verdicts import relative_error
from studies.sources.registry import Source

ASKED = HISTORIES[5][1]
"""What each engine is asked: figure 5-b of the paper."""
LOOSE, EQUAL, LANDING = 0.3, 2e-2, 1e-4
"""Relative error of its peak that a preset should keep: as documented, at equal steps, by steps
of other lengths."""
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS")
LEAST_BYTES = 5e8
"""Free space that the results of most studies fit into."""


class Line(NamedTuple):
    """What was looked at and found, and, where that fails, what to do."""

    found: str
    remedy: str = ""


def command(*, time_limit: TimeLimit = 600.0) -> int:
    """Look at this installation.

    Parameters
    ----------
    time_limit
        Wall-clock time [s] that an engine may take; some compile themselves when first used.
    """
    failed = False
    for line in chain(surroundings(), answers(time_limit)):
        print(f"FAIL  {line.found}; {line.remedy}" if line.remedy else f"ok    {line.found}")
        failed |= bool(line.remedy)
    return int(failed)


def surroundings() -> Iterator[Line]:
    """Look at versions, the folder of compiled functions, cores, threads and disk."""
    yield Line(
        f"rocking {project_version()}, Python {platform.python_version()}, {platform.platform()}"
    )
    yield Line(", ".join(f"{name} {version_of(name)}" for name in NUMERICAL_PACKAGES))
    folders = [kept_in(sources) for sources in (SOURCES, PACKAGE)]
    if None in folders:
        remedy = "set NUMBA_CACHE_DIR to a folder that can be written"
        yield Line("compiled functions are kept nowhere, and compiled in every process", remedy)
    else:
        yield Line(f"compiled functions are kept in {folders[0]}")
    threads = [f"{name} {os.environ.get(name, 'not set')}" for name in THREADS]
    yield Line(f"{usable_cores()} of {os.cpu_count()} cores; {', '.join(threads)}")
    free = shutil.disk_usage(Path.cwd()).free
    remedy = "" if free >= LEAST_BYTES else "free some, or write elsewhere with --out"
    yield Line(f"{1e-9 * free:.1f} GB free in this folder", remedy)


def answers(time_limit_s: float) -> Iterator[Line]:
    """Ask every engine that is here about one block, and name those that are not."""
    here = installed_engines()
    jobs = [Job(labels={}, block=ASKED.block, motion=ASKED.motion, source=name) for name in here]
    found = dict(Computing(time_limit=time_limit_s).executor(at_once=True)(jobs))
    yield from (judged(job.asked, found[number]) for number, job in enumerate(jobs))
    others = [f"{name} (pip install '{ENGINES[name].install}')" for name in ENGINES.keys() - here]
    if others:
        yield Line(f"not installed, which is no fault: {', '.join(sorted(others))}")


def judged(source: Source, response: Response) -> Line:
    """Hold an engine's answer against the exact solution, by what its best preset should keep."""
    engine, exact = source.declared, simulate(ASKED.block, ASKED.motion)
    error, keeps = abs(relative_error(response, exact)), should_keep(source)
    versions = ", ".join(f"{name} {version_of(name)}" for name in engine.packages)
    asked = f"{engine.name}:{source.preset}{versions and f' ({versions})'}"
    if error <= keeps:
        return Line(f"{asked}: peak to {scientific(error)} of the exact one, {keeps:g} allowed")
    both = [f"{it.outcome.value}, peak {it.peak_ratio:.4g}" for it in (response, exact)]
    answer = brief(response.message) or "; the exact solution: ".join(both)
    remedy = f"pip install --force-reinstall '{engine.install}', then report it"
    return Line(f"{asked}: {answer}", remedy)


def should_keep(source: Source) -> float:
    """Return the relative error of its peak that an engine's preset should keep."""
    if source.lands:
        return max(LANDING, source.declared.nuisance_sensitivity)
    return LOOSE if source.preset in UNTUNED else EQUAL
