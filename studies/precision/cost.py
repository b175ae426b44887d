"""What a scene costs and what leaving things out of it saves: measured by putting them back."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict
from functools import partial
from pathlib import Path
from timeit import repeat
from typing import Any

import numpy as np
import pandas as pd

from analytic import peak_ratios, simulate
from analytic.response import Outcome, Reason, Response
from engines import ENGINES, Scene
from engines.run.drive import build, run
from studies.cases.paper import free_rocking_window, sweep_cases
from studies.drawing.kept import tell
from studies.old.arguments import Out
from studies.old.executors import COMPILING_S
from studies.old.naming import CORE, Engines
from studies.old.options import DEFAULT_RUNNING
from studies.old.plan import Plan, carry_out
from studies.old.pool import Pool
from studies.old.tables import table_in
from studies.measures.costs import STEPPED
from studies.measures.differences import posed_cases
from studies.measures.words import duration, listed
from studies.precision import COST
from studies.precision.repeats import interleaved
from studies.precision.shares import CASE, share_table

BUDGET_S, QUICK_BUDGET_S = 5.0, 0.15
"""Time [s] spent at most on timing one scene, in the mean of an engine's."""

RUNS = 30
"""Of what the exact solution is timed with, of which the shortest counts."""

SCENES = 20
"""Scenes built at once to see what memory one takes."""


def omissions() -> dict[str, dict[str, Any]]:
    """Return the settings of a `Scene` that put back what it leaves out, by the name of that.

    The scene as it is comes first.
    """
    window = free_rocking_window(CASE.block, CASE.motion)
    return {
        "as it is": {},
        "free body instead of planar": {"settings": {"planar": False}},
        "full box instead of corners": {"settings": {"geometry": "box"}},
        "base moving in the world": {"frame": "world"},
        "8/p of free rocking after the pulse": {"duration": window},
        "the same, recorded as a history": {
            "duration": window,
            "times": tuple(np.linspace(0.0, window, 1001)),
        },
        "steps all equal": {"preset": "fixed"},
    }


def command(
    *,
    out: Out,
    engines: Engines = CORE,
    quick: bool = False,
) -> int:
    """Show what a scene costs, and what each thing that it leaves out would cost and change.

    Parameters
    ----------
    engines
        Names of engines, without a preset.
    quick
        Shorter timing: a few seconds.
    """
    made = Plan(settings={"quick": quick}, tabulate=lambda _: measured(engines, quick))
    return carry_out(COST, made, out, DEFAULT_RUNNING, report)


def measured(engines: Sequence[str], quick: bool) -> dict[str, pd.DataFrame]:
    """Measure, and return the three tables."""
    budget_s = QUICK_BUDGET_S if quick else BUDGET_S
    return {
        "shares": share_table(engines, budget_s),
        "scenes": scene_table(engines, budget_s),
        "reference": reference_table(),
    }


def scene_table(engines: Sequence[str], budget_s: float) -> pd.DataFrame:
    """Return a row for each engine and omission: time, steps, set-up, memory, what it changes.

    The scenes of an engine are timed in turn, so that their times can be held against each other.
    """
    exact = simulate(CASE.block, CASE.motion).peak_ratio
    scenes = omissions()
    rows = []
    for engine in engines:
        actions = [partial(put_back, engine, settings) for settings in scenes.values()]
        for (name, settings), found in zip(
            scenes.items(), interleaved(actions, budget_s), strict=True
        ):
            failed = found.outcome is Outcome.FAILED
            memory = (scene_memory, engine, settings)
            rows.append(
                {
                    "engine": engine,
                    "scene": name,
                    "outcome": found.outcome.value,
                    "wall_s": found.wall_s,
                    "runs": found.runs,
                    "steps": found.steps,
                    "step_s": found.wall_s / max(found.steps, 1),
                    "setup_s": found.setup_s,
                    "memory_kib": math.nan if failed else in_a_new_process(*memory),
                    "error": found.peak_ratio / exact - 1.0,
                    "message": found.message,
                }
            )
    return pd.DataFrame(rows)


def put_back(engine: str, settings: Mapping[str, Any]) -> Response:
    """Run a scene with what it leaves out; an engine that has no such thing fails."""
    preset, own = settings.get("preset"), settings.get("settings", {})
    if preset not in (None, *(use.name for use in ENGINES[engine].presets)):
        missing = f"preset {preset!r}"
    elif not ENGINES[engine].preset(preset).takes(**own):
        missing = f"setting of {', '.join(own)} to put back"
    else:
        return run(engine, Scene(system=CASE.block, motion=CASE.motion, **settings))
    words = f"not available: {engine} has no {missing}"
    return Response.failure(words, reason=Reason.UNAVAILABLE)


def in_a_new_process(function: Callable[..., float], *arguments: Any) -> float:
    """Call a function in a process of its own, whose memory nothing has used before."""
    with Pool(1) as pool:
        return float(pool.schedule(function, arguments, COMPILING_S).result())


def scene_memory(engine: str, settings: Mapping[str, Any]) -> float:
    """Return the memory [KiB] that a built scene takes, nan where the system does not tell."""
    scene = Scene(system=CASE.block, motion=CASE.motion, **settings)
    status = Path("/proc/self/statm")
    if not status.exists():
        return math.nan
    worlds = [build(ENGINES[engine], scene)]
    before = _resident(status)
    worlds += [build(ENGINES[engine], scene) for _ in range(SCENES)]
    grown = _resident(status) - before
    for world in worlds:
        world.close()
    return max(grown, 0.0) / SCENES


def _resident(status: Path) -> float:
    return int(status.read_text().split()[1]) * 4.0


def reference_table() -> pd.DataFrame:
    """Return what the exact solution leaves out: time of one response or of the whole sweep."""
    block, motion = CASE.block, CASE.motion
    window = free_rocking_window(block, motion)
    watched = partial(simulate, block, motion, duration=window)
    times = np.linspace(0.0, window, 1001)
    cases = [case for case in sweep_cases([6, 7, 8, 9]) if case.width_m == 0.5]
    alike = posed_cases(pd.DataFrame([asdict(case) for case in cases]))
    actions: dict[str, Callable[[], object]] = {
        "one response, to its peak": partial(simulate, block, motion),
        "8/p of free rocking after the pulse": watched,
        "the same, recorded as a history": partial(watched, times=times),
        "480 cases of the sweep": partial(peak_ratios, *alike),
        "960 cases, half of them copies by similarity": partial(peak_ratios, *np.tile(alike, 2)),
        "480 cases, one by one in Python": lambda: [
            simulate(case.block, case.motion) for case in cases
        ],
    }
    return pd.DataFrame(
        {"scene": name, "wall_s": min(repeat(action, number=1, repeat=RUNS))}
        for name, action in actions.items()
    )


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return them as text."""
    shares, scenes, reference = (
        table_in(folder, name) for name in ("shares", "scenes", "reference")
    )
    as_it_is = scenes.groupby("engine")["wall_s"].transform("first")
    tables = {
        "Time of a step, and over the engine's own part of it": (
            shares.assign(over_engine=shares["step_s"] / shares["engine_s"])
        ),
        "What a scene leaves out, put back one at a time; cost: time over the scene as it is": (
            scenes.assign(cost=scenes["wall_s"] / as_it_is).drop(columns="message")
        ),
        "What an engine cannot put back": (
            scenes.loc[scenes["message"] != "", ["engine", "scene", "message"]]
        ),
        "What the exact solution leaves out": reference,
    }
    return tell(COST, folder, tables)


def finding(shares: pd.DataFrame) -> str:
    """Say how long a step takes with each engine, and how much of that is the engine's own."""
    known = shares.dropna(subset=["step_s"])
    steps = [f"{_step(line)} with {line['engine']}" for _, line in known.iterrows()]
    return f"A step takes {listed(steps)}. {STEPPED}"


def _step(line: pd.Series[Any]) -> str:
    own = line["engine_s"]
    part = "" if math.isnan(own) else f" (the engine's own {duration(own)})"
    return f"{duration(line['step_s'])}{part}"
