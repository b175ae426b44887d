"""What a scene costs and what leaving things out of it saves: measured by putting them back."""

import contextlib
import functools
import importlib
import math
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from functools import partial
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic import peak_ratios, simulate
from analytic.block import RigidBlock
from analytic.motion import SinePulse
from analytic.response import Response
from engines import ENGINES, Scene, run
from engines.drive import build
from engines.world import World
from studies.cases.paper import HISTORIES, free_rocking_window, sweep_cases
from studies.kit import provenance
from studies.kit.arguments import Place
from studies.kit.runner import own_folder
from studies.kit.signals import left_to_this_process
from studies.precision import COST
from studies.precision.cost_report import headline, paragraph, pictures, report

__all__ = ["command", "headline", "paragraph", "pictures", "report"]


BUDGET_S, QUICK_BUDGET_S = 1.0, 0.15
"""Time [s] spent on timing one scene."""

SCENES = 20
"""Scenes built at once to see what memory one takes."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Omission:
    """Something that is left out by default, and the settings of a `Scene` that put it back."""

    name: str
    put_back: dict[str, Any] = field(default_factory=dict)


def omissions(block: RigidBlock, motion: SinePulse) -> list[Omission]:
    """Return what a scene leaves out, the scene as it is first."""
    window = free_rocking_window(block, motion)
    return [
        Omission(name="as it is"),
        Omission(name="free body instead of planar", put_back={"settings": {"planar": False}}),
        Omission(name="full box instead of corners", put_back={"settings": {"geometry": "box"}}),
        Omission(name="base moving in the world", put_back={"frame": "world"}),
        Omission(name="8/p of free rocking after the pulse", put_back={"duration": window}),
        Omission(
            name="the same, recorded as a history",
            put_back={"duration": window, "times": tuple(np.linspace(0.0, window, 1001))},
        ),
        Omission(name="steps all equal", put_back={"preset": "fixed"}),
    ]


def command(*, out: Place, quick: bool = False) -> int:
    """Show what a scene costs, and what each thing that it leaves out would cost and change.

    On the block and pulse of the paper's figure 5-b. Times are of one thread, warm, the best of
    several.

    Parameters
    ----------
    out
        Folder for the tables; made if there is none.
    quick
        Shorter timing: a few seconds.
    """
    with own_folder(out, COST.name, COST.products, module=__name__, quick=quick):
        measure(out, quick)
        print(report(out))
    return 0


def measure(folder: Path, quick: bool) -> None:
    """Measure and write the three tables."""
    budget_s = QUICK_BUDGET_S if quick else BUDGET_S
    tables = {
        "shares": share_table(budget_s),
        "scenes": scene_table(budget_s),
        "reference": reference_table(),
    }
    for name, table in tables.items():
        provenance.write_text(folder / f"{name}.csv", table.to_csv(index=False, na_rep="nan"))


def pose_case() -> tuple[RigidBlock, SinePulse]:
    """Return the block and pulse of figure 5-b: one impact before the peak, κ about 5."""
    case = HISTORIES[5][1]
    return case.block, case.motion


def best_of(action: Callable[[], Response], budget_s: float) -> tuple[Response, float]:
    """Return the response with the shortest run time, and the shortest set-up time [s]."""
    began = time.perf_counter()
    responses = [action()]
    while time.perf_counter() - began < budget_s:
        responses.append(action())
    best = min(responses, key=lambda response: response.wall_s)
    return best, min(response.setup_s for response in responses)


def scene_table(budget_s: float) -> pd.DataFrame:
    """Return a row for each engine and omission: time, steps, set-up, memory, what it changes."""
    block, motion = pose_case()
    exact = simulate(block, motion).peak_ratio
    rows = []
    for engine in ENGINES:
        for omission in omissions(block, motion):
            scene = Scene(block=block, motion=motion, **omission.put_back)
            response, setup_s = best_of(partial(run, engine, scene), budget_s)
            rows.append(
                {
                    "engine": engine,
                    "scene": omission.name,
                    "outcome": response.outcome.value,
                    "wall_s": response.wall_s,
                    "steps": response.steps,
                    "step_s": response.wall_s / max(response.steps, 1),
                    "setup_s": setup_s,
                    "memory_kib": in_a_new_process(scene_memory, engine, omission.put_back),
                    "error": response.peak_ratio / exact - 1.0,
                    "message": response.message,
                }
            )
    return pd.DataFrame(rows)


def in_a_new_process(function: Callable[..., float], *arguments: Any) -> float:
    """Call a function in a process of its own, whose memory nothing has used before."""
    with ProcessPoolExecutor(max_workers=1, mp_context=get_context("spawn")) as pool:
        with left_to_this_process():
            task = pool.submit(function, *arguments)
        return task.result()


def scene_memory(engine: str, put_back: dict[str, Any]) -> float:
    """Return the memory [KiB] that a built scene takes, nan where the system does not tell."""
    block, motion = pose_case()
    scene = Scene(block=block, motion=motion, **put_back)
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


def share_table(budget_s: float) -> pd.DataFrame:
    """Return where the time of a step goes: the engine's own step, the rest of the adapter, ...

    Each part is timed from within by a clock around it, whose own cost is taken off.
    """
    block, motion = pose_case()
    clock_s = tick()
    rows = []
    for engine in ENGINES:
        scene = Scene(block=block, motion=motion)
        plain, _ = best_of(partial(run, engine, scene), budget_s)
        with clocks(engine) as spent:
            response = run(engine, scene)
        spent = {part: max(total - clock_s * response.steps, 0.0) for part, total in spent.items()}
        per_step = {part: total / response.steps for part, total in spent.items()}
        whole = plain.wall_s / plain.steps
        rows.append(
            {
                "engine": engine,
                "step_s": whole,
                "engine_s": per_step["engine"],
                "adapter_s": max(per_step["step"] - per_step["engine"], 0.0),
                "pose_s": per_step["pose"],
                "policy_s": per_step["policy"],
                "observer_s": per_step["observer"],
            }
        )
    return pd.DataFrame(rows)


def tick() -> float:
    """Return what reading the clock twice costs [s]."""
    count = 20_000
    began = time.perf_counter()
    for _ in range(count):
        time.perf_counter()
        time.perf_counter()
    return (time.perf_counter() - began) / count


def own_step(engine: str) -> tuple[Any, str]:
    """Return where an engine's own step stands, and its name there."""
    library, _, path = ENGINES[engine].own_step.partition(":")
    *owners, name = path.split(".")
    return functools.reduce(getattr, owners, importlib.import_module(library)), name


def example_world(engine: str) -> World:
    """Return a world of an engine, closed: its class is wanted."""
    block, motion = pose_case()
    world = build(ENGINES[engine], Scene(block=block, motion=motion))
    world.close()
    return world


@contextlib.contextmanager
def clocks(engine: str) -> Iterator[dict[str, float]]:
    """Put clocks around the parts of a step while the context lasts; yield the sums [s]."""
    from engines.stepping.steps import Stepper
    from engines.watching.observe import Observer

    world = type(example_world(engine))
    places = {
        "engine": own_step(engine),
        "step": (world, "step"),
        "pose": (world, "pose"),
        "policy": (Stepper, "next"),
        "observer": (Observer, "see"),
    }
    spent = dict.fromkeys(places, 0.0)
    kept = {part: getattr(owner, name) for part, (owner, name) in places.items()}

    def timed(part: str, call: Callable[..., Any]) -> Callable[..., Any]:
        def measured(*arguments: Any, **named: Any) -> Any:
            start = time.perf_counter()
            try:
                return call(*arguments, **named)
            finally:
                spent[part] += time.perf_counter() - start

        return measured

    try:
        for part, (owner, name) in places.items():
            setattr(owner, name, timed(part, kept[part]))
        yield spent
    finally:
        for part, (owner, name) in places.items():
            setattr(owner, name, kept[part])


def reference_table() -> pd.DataFrame:
    """Return what the exact solution leaves out: time of one response or of the whole sweep."""
    block, motion = pose_case()
    window = free_rocking_window(block, motion)
    times = np.linspace(0.0, window, 1001)
    cases = np.array(
        [
            (math.atan(1.0 / c.aspect), c.amplitude_g, c.omega_over_p, c.motion.half_cycles)
            for c in sweep_cases([6, 7, 8, 9])
            if c.width_m == 0.5
        ]
    ).T
    actions = {
        "one response, to its peak": lambda: simulate(block, motion),
        "8/p of free rocking after the pulse": lambda: simulate(block, motion, duration=window),
        "the same, recorded as a history": lambda: simulate(
            block, motion, duration=window, times=times
        ),
        "480 cases of the sweep": lambda: peak_ratios(*cases),
        "960 cases, half of them copies by similarity": lambda: peak_ratios(*np.tile(cases, 2)),
        "480 cases, one by one in Python": lambda: [one_by_one(*case) for case in cases.T],
    }
    return pd.DataFrame(
        {"scene": name, "wall_s": shortest(action)} for name, action in actions.items()
    )


def one_by_one(alpha: float, amplitude: float, omega: float, half_cycles: float) -> Response:
    """Solve a case of `peak_ratios` as a response of its own."""
    block = RigidBlock(width=1.0, height=1.0 / math.tan(alpha))
    pulse = SinePulse(
        amplitude=amplitude * block.gravity, omega=omega * block.p, half_cycles=int(half_cycles)
    )
    return simulate(block, pulse)


def shortest(action: Callable[[], Any], runs: int = 30) -> float:
    """Return the shortest of several run times [s]."""
    times = []
    for _ in range(runs):
        began = time.perf_counter()
        action()
        times.append(time.perf_counter() - began)
    return min(times)
