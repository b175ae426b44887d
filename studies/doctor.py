"""Whether an installation works: a line for each thing that a run depends on."""

import os
import platform
import shutil
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

from analytic import simulate
from analytic.kernels.forms import SOURCES
from analytic.kernels.kept import kept_in
from engines import ENGINES, installed_engines
from engines.declaration import Precision
from engines.run.look import PACKAGE
from studies.cases.paper import HISTORIES
from studies.kit import arguments, identity, run, store
from studies.kit.jobs import Job, Question, Row, answer
from studies.kit.say import part
from studies.sources.registry import Source

CASE = HISTORIES[5][1]
"""What each engine is asked: figure 5-b of the paper."""
LANDING, OTHER = 1e-4, 6e-3
"""Relative error of its peak that an engine keeps, landing in double precision or otherwise."""
LEAST_BYTES = 5e8
"""Free space that the results of most studies fit into."""


def command(*, time_limit: arguments.TimeLimit = 600.0) -> int:
    """Check this installation, in ten lines to paste into a report.

    It prints versions, the cache of compiled functions, cores and disk, and simulates one block in
    each installed engine, in a separate process. If something fails, the exit code is 1, and its
    line says what to do.

    Parameters
    ----------
    time_limit
        Wall-clock time [s] for each engine; some compile themselves at the first use.
    """
    remedies = []
    for found, remedy in chain(surroundings(), engines(time_limit)):
        print(f"FAIL  {found}; {remedy}" if remedy else f"ok    {found}", flush=True)
        remedies.append(remedy)
    return int(any(remedies))


def surroundings() -> Iterator[tuple[str, str]]:
    """Yield versions, folder, cores and disk, each with what to do where it does not suffice."""
    python = f"Python {platform.python_version()}, {platform.platform()}"
    yield f"rocking {store.project_version()}, {python}", ""
    yield ", ".join(f"{name} {identity.version_of(name)}" for name in identity.COMPUTING), ""
    places = [kept_in(sources) for sources in (SOURCES, PACKAGE)]
    remedy = "set NUMBA_CACHE_DIR to a folder that can be written" if None in places else ""
    yield f"compiled functions are kept in {places[0] or 'no folder'}", remedy
    free = shutil.disk_usage(Path.cwd()).free
    remedy = "" if free >= LEAST_BYTES else "free some, or write elsewhere with --out"
    cores = f"{store.usable_cores()} of {os.cpu_count()} cores"
    yield f"{cores}, {1e-9 * free:.1f} GB free here", remedy


def engines(time_limit_s: float) -> Iterator[tuple[str, str]]:
    """Ask every engine that is here about one block, and name those that are not."""
    case, here = Question(system=CASE.block, motion=CASE.motion), installed_engines()
    jobs = [Job(labels={}, case=case, source=name) for name in here]
    rows = run.local(jobs, answer, store.usable_cores(), time_limit_s, at_once=True)
    yield from (compare(jobs[number].asked, row) for number, row in rows)
    if absent := sorted(ENGINES.keys() - here):
        names = [f"{name} (pip install '{ENGINES[name].install}')" for name in absent]
        yield f"not installed, which is no fault: {', '.join(names)}", ""


def compare(source: Source, row: Row) -> tuple[str, str]:
    """Compare an engine's row with the exact solution, and with what it should keep."""
    engine, exact = source.declared, simulate(CASE.block, CASE.motion)
    keeps = LANDING if source.lands and engine.precision is Precision.DOUBLE else OTHER
    versions = ", ".join(f"{name} {identity.version_of(name)}" for name in engine.packages)
    asked = f"{engine.name}:{source.preset}{versions and f' ({versions})'}"
    error = abs(row["peak_ratio"] / exact.peak_ratio - 1.0)
    if row["outcome"] == exact.outcome.value and error <= keeps:
        return f"{asked}: relative error of the peak {part(error)}, {part(keeps)} allowed", ""
    found = f"{row['outcome']}, peak {row['peak_ratio']:.4g}; exactly {exact.peak_ratio:.4g}"
    remedy = f"pip install --force-reinstall '{engine.install}', then report it"
    return f"{asked}: {row['message'] or found}", remedy
