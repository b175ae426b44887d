"""Cases per second of a map: every model, and general-purpose integrators on the same cases."""

from __future__ import annotations

import math
import resource
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import product
from pathlib import Path
from typing import NamedTuple, TypeVar

import numpy as np
import pandas as pd

from analytic.maps import FAILED
from analytic.models import MODELS
from analytic.motion import FloatArray
from analytic.response import Outcome
from studies.cases.paper import PULSES
from studies.cases.window import Window
from studies.drawing.kept import tell
from studies.kit import provenance
from studies.kit.arguments import BadInputError, Count, Out
from studies.kit.options import DEFAULT_RUNNING
from studies.kit.plan import Plan, carry_out
from studies.throughput import STUDY

CASES, QUICK_CASES = 1_000_000, 40_000
PEER_CASES, QUICK_PEER_CASES = 900, 100
MOST_THREADS = 1024
PEAKS = "exact, peaks too"
RUNS = 3
"""The shortest of so many is reported of the models; peers take too long for more than one."""


def command(*, out: Out, quick: bool = False, threads: Count | None = None) -> int:
    """Report how many cases of an overturning map are solved in a second.

    Parameters
    ----------
    quick
        Fewer cases: a few seconds.
    threads
        By default the number of cores.
    """
    if threads is not None and threads > MOST_THREADS:
        raise BadInputError(f"--threads is {threads}; it must be at most {MOST_THREADS}")
    used = threads or provenance.usable_cores()
    made = Plan(settings={"quick": quick}, tabulate=lambda _: {STUDY.name: measured(quick, used)})
    return carry_out(STUDY, made, out, DEFAULT_RUNNING, report)


def measured(quick: bool, threads: int) -> pd.DataFrame:
    """Time every solver on both pulses; return a row for each."""
    count, peers = (QUICK_CASES, QUICK_PEER_CASES) if quick else (CASES, PEER_CASES)
    return pd.concat([timings(Window(pulse=pulse), count, peers, threads) for pulse in PULSES])


def points(window: Window, count: int) -> tuple[FloatArray, FloatArray]:
    """Return the abscissae and amplitudes of a square grid of about `count` points, flat."""
    side = math.isqrt(count)
    x, onsets = np.meshgrid(window.centres(side), window.amplitudes(side))
    return x.ravel(), onsets.ravel()


COLUMNS = (
    *("pulse", "source", "threads", "cases", "seconds", "cases_a_second"),
    *("us_a_case_and_core", "busy", "steps", "wrong", "times_exact"),
)
"""Of throughput.csv."""


def timings(window: Window, count: int, peers: int, threads: int) -> pd.DataFrame:
    """Return a row for each model, on all threads and on one, and for each peer."""
    x, onsets = points(window, count)
    rows: list[Timing] = []
    for used in dict.fromkeys((threads, 1)):
        peaks, spent = timed(partial(window.peaks, x, onsets, used))
        rows.append((PEAKS, used, len(x), *spent, math.nan, int(np.isnan(peaks).sum())))
    for model, used in product(MODELS, dict.fromkeys((threads, 1))):
        found, spent = timed(partial(window.modes, x, onsets, model, used))
        failed = int((found.mode == FAILED).sum())
        rows.append((model, used, len(x), *spent, float(found.steps.mean()), failed))
    for name, ask in peer_solvers().items():
        rows += _peer_rows(window, name, ask, peers)
    names = ["source", "threads", "cases", "seconds", "busy", "steps", "wrong"]
    table = pd.DataFrame(rows, columns=names)
    core_s = table["seconds"] * table["threads"]
    us = 1e6 * core_s / table["cases"]
    alone = us[(table["source"] == "exact") & (table["threads"] == 1)].iloc[0]
    return table.assign(
        pulse=window.pulse,
        cases_a_second=table["cases"] / table["seconds"],
        us_a_case_and_core=us,
        busy=table["busy"] / core_s,
        times_exact=us / alone,
    )[[*COLUMNS]]


Timing = tuple[str, int, int, float, float, float, int]
"""Source, threads, cases, both times [s] of `Spent`, steps and wrong outcomes."""


class Spent(NamedTuple):
    """Time that a call took, and that it kept all cores busy together [s]."""

    wall_s: float
    busy_s: float


Found = TypeVar("Found")


def timed(solve: Callable[[], Found], runs: int = RUNS) -> tuple[Found, Spent]:
    """Return what a call finds and the shortest of some run times, the first, warming, apart."""
    found, times = solve(), []
    for _ in range(runs):
        began, busy = time.perf_counter(), time.process_time()
        solve()
        times.append(Spent(time.perf_counter() - began, time.process_time() - busy))
    return found, min(times)


Overturns = Callable[[Window, FloatArray, FloatArray], Sequence[bool]]
"""Says of each point of a map whether the block overturns."""


def peer_solvers() -> dict[str, Overturns]:
    """Return the general-purpose integrators that are installed."""
    solvers: dict[str, Overturns] = {"dop853 (SciPy)": by_scipy}
    try:
        from studies.throughput.heyoka_peer import HeyokaBatch, HeyokaSolver
    except ImportError:
        return solvers
    batch = HeyokaBatch()
    return {**solvers, "heyoka.py": HeyokaSolver(), f"heyoka.py, {batch.lanes} at once": batch}


def by_scipy(window: Window, x: FloatArray, onsets: FloatArray) -> list[bool]:
    """Ask SciPy's DOP853 with its events, at a relative tolerance of 1e-9."""
    from studies.sources.registry import resolve

    source, points = resolve("dop853"), zip(x.tolist(), onsets.tolist(), strict=True)
    responses = [source.call(*window.case(*point)) for point in points]
    return [response.outcome is Outcome.OVERTURNED for response in responses]


def _peer_rows(window: Window, name: str, ask: Overturns, count: int) -> Iterator[Timing]:
    """Yield a peer's row, and another of its integrator alone where that is known."""
    x, onsets = points(window, count)
    before = _integrating_s(ask)
    found, spent = timed(partial(ask, window, x, onsets), runs=1)
    alone = (_integrating_s(ask) - before) / 2
    wrong = int((np.array(found) != (window.modes(x, onsets).mode >= 0)).sum())
    yield name, 1, len(x), *spent, math.nan, wrong
    if not math.isnan(alone):
        yield f"{name}, its integrator alone", 1, len(x), alone, alone, math.nan, wrong


def _integrating_s(ask: Overturns) -> float:
    """Return the time [s] that a peer has spent in its integrator so far; nan if unknown."""
    return float(getattr(ask, "integrating_s", math.nan))


def report(folder: Path) -> str:
    """Write and return the table for a reader, and the memory that the run took."""
    table = pd.read_csv(folder / "throughput.csv")
    rate = table.loc[table["source"] == "exact", "cases_a_second"].max()
    # kilobytes on Linux, bytes on macOS
    unit = 1024.0**2 if sys.platform == "darwin" else 1024.0
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit
    finding = (
        f"The exact model decides up to {rate:,.0f} cases of an overturning map in a second. "
        f"Peak memory of this process: {peak:.0f} MiB."
    )
    title = (
        "Outcomes of overturning maps; times_exact is per case and core, over exact on one thread, "
        "steps are Taylor steps of exact and evaluations of the linear closed forms, busy is the "
        "part of their time that the cores of all threads worked"
    )
    return tell(STUDY, folder, {title: table}, finding)
