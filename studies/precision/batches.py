"""What batches are worth: the same scenes at once and one by one, in CPU time, memory and rows."""

from __future__ import annotations

import math
import resource
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import replace
from functools import partial
from typing import Any

import pandas as pd

from analytic.response import Response
from engines import ENGINES, Scene
from engines.declaration import BatchEngine
from engines.run.batch import alike, run_together
from engines.run.drive import run
from studies.cases.paper import sweep_cases
from studies.kit.executors import COMPILING_S
from studies.kit.pool import Pool
from studies.precision.repeats import interleaved

WORLDS, QUICK_WORLDS = 48, 4
"""Cases of the paper's figure 6 that are run, in equal distances."""

AT_ONCE, ONE_BY_ONE = "at once", "one by one"


def batch_table(engines: Sequence[str], quick: bool, budget_s: float) -> pd.DataFrame:
    """Return what it is worth to run many scenes at once, for each preset with which an engine can.

    Times are CPU times of all threads of a process, the best of several in turn, but for the first
    ones, in which all is loaded or compiled; memory is what a batch adds to the most that such a
    process has held before.

    Parameters
    ----------
    engines : sequence of str
        Their names, without a preset.
    quick : bool
        QUICK_WORLDS scenes instead of WORLDS.
    budget_s : float
        Time [s] after which a preset is not timed again.

    Returns
    -------
    DataFrame
        Two rows for each preset, taken AT_ONCE and ONE_BY_ONE: engine, preset, taken, driver,
        worlds, batches, world_steps and runs; cpu_s [s] of one step of one scene, first_s [s] until
        each was answered once, added_kib [KiB] for each scene; other_outcomes and largest_change
        (of a peak, relative) from one by one. No row of a preset that runs its scenes alone.

    Raises
    ------
    studies.kit.pool.TaskError, studies.kit.pool.OvertimeError
        If a process fails, or takes longer than engines may to compile themselves.
    """
    rows = []
    with Pool(1) as pool:
        for name in engines:
            for preset in (use.name for use in ENGINES[name].presets):
                asked = (name, preset, QUICK_WORLDS if quick else WORLDS, budget_s)
                rows += pool.schedule(measured, asked, COMPILING_S).result()
    return pd.DataFrame(rows)


def measured(name: str, preset: str, count: int, budget_s: float) -> list[dict[str, Any]]:
    """Return the rows of a preset; none where its scenes are run alone."""
    cases = [*sweep_cases([6])]
    chosen = cases[:: len(cases) // count][:count]
    scenes = [Scene(system=case.block, motion=case.motion, preset=preset) for case in chosen]
    if not isinstance(ENGINES[name], BatchEngine) or alike(ENGINES[name], scenes[0]) is None:
        return []
    groups: dict[Any, list[Scene]] = {}
    for scene in scenes:
        groups.setdefault(alike(ENGINES[name], scene), []).append(scene)
    started = time.perf_counter()
    run(name, scenes[0])  # what has to be loaded or compiled is so now
    run_together(name, scenes[:1])
    before = _most_kib()
    together = _together(name, groups.values())
    grown, first_s = _most_kib() - before, time.perf_counter() - started
    alone = [run(name, scene) for group in groups.values() for scene in group]
    actions = (
        partial(_together, name, groups.values()),
        lambda: [run(name, scene) for scene in scenes],
    )
    timed = interleaved([partial(_clocked, action) for action in actions], 0.5 * budget_s)
    steps = sum(response.steps for response in alone)
    return [
        {
            "engine": name,
            "preset": preset,
            "taken": way,
            "worlds": len(scenes),
            "batches": len(groups) if way is AT_ONCE else 0,
            "world_steps": steps,
            "runs": best.runs,
            "cpu_s": best.wall_s / steps,
            "first_s": first_s if way is AT_ONCE else math.nan,
            "added_kib": grown / len(scenes) if way is AT_ONCE else math.nan,
            "other_outcomes": sum(
                a.outcome is not b.outcome for a, b in zip(found, alone, strict=True)
            ),
            "largest_change": max(_changes(found, alone), default=math.nan),
        }
        for way, found, best in zip((AT_ONCE, ONE_BY_ONE), (together, alone), timed, strict=True)
    ]


def _together(name: str, groups: Iterable[Sequence[Scene]]) -> list[Response]:
    return [response for group in groups for response in run_together(name, group)]


def _clocked(action: Callable[[], Sequence[Response]]) -> Response:
    """Return a response whose run time is the CPU time [s] that all of them took."""
    began = time.process_time()
    first = action()[0]
    return replace(first, wall_s=time.process_time() - began)


def _changes(found: Sequence[Response], others: Sequence[Response]) -> Iterator[float]:
    """Yield by which part each peak differs where both are one."""
    for a, b in zip(found, others, strict=True):
        if math.isfinite(a.peak_ratio) and math.isfinite(b.peak_ratio) and b.peak_ratio:
            yield abs(a.peak_ratio / b.peak_ratio - 1.0)


def _most_kib() -> float:
    """Return the most memory [KiB] that this process has held."""
    unit = 1024.0 if sys.platform == "darwin" else 1.0
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / unit
