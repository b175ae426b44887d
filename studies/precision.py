"""Error against run time, every method along its own setting; and what a scene costs."""

from __future__ import annotations

import math
import time
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from itertools import product
from typing import Any

import numpy as np
import pandas as pd

from analytic import Outcome, Response, RigidBlock, simulate
from engines import ENGINES
from engines.declaration import Engine
from engines.scene import free_rocking_window
from studies.cases.paper import HISTORIES, chosen_cases
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.say import duration, part
from studies.kit.study import Figures, Study, Tables, stages
from studies.measures.costs import EXACT, best_of, cheapest_below, exact_cost, joint, parts_of
from studies.measures.presets import engine_of, look_of, uses_of
from studies.measures.published import TARGETS
from studies.measures.wrongness import REST, kind_of
from studies.sources.registry import core_sources

ALONG, SCENES = "precision", "scenes"
"""The tables whose rows are measured."""
TYPICAL, ALL = "typical", "all"
"""A set of cases, and both together."""
FINE_TARGETS = (*TARGETS[1:], 1e-6)
"""Errors that are asked of every method."""
CASE = HISTORIES[5][1]
"""Figure 5-b, of which scenes are timed: one impact before the peak, κ about 5."""

TOLERANCES = tuple(10.0**-n for n in range(2, 13))
TIGHT = {"event_tolerance": 1e-13}
STEPS = (0.1, 0.05, 0.02, 0.01, 5e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4)


@dataclass(frozen=True, slots=True)
class Method:
    """A source with one of its options left open, with values from cheap to dear."""

    source: str
    setting: str = ""
    values: tuple[float, ...] = (0.0,)  # a step is p dt
    options: Mapping[str, Any] = field(default_factory=dict)
    own: bool = False  # whether the option is among an engine's own settings

    def options_at(self, value: float) -> dict[str, Any]:
        """Return the options with the open one at a value."""
        if self.own:
            whole = int(value) if float(value).is_integer() else value
            return {**self.options, "settings": {self.setting: whole}}
        return {**self.options, **({self.setting: value} if self.setting else {})}


PLAIN = {
    EXACT: Method("exact", "tolerance", (*TOLERANCES, 1e-14, 1e-16)),
    **{
        f"SciPy {name}": Method(name.lower(), "rtol", TOLERANCES)
        for name in ("RK45", "DOP853", "Radau", "LSODA")
    },
    "RK4": Method("rk4", "step", STEPS, TIGHT),
    "RK4, contact to 1e-6": Method("rk4", "step", STEPS, {"event_tolerance": 1e-6}),
    "average acceleration": Method("average-acceleration", "step", STEPS, TIGHT),
    **{f"{name}, closed form": Method(name) for name in ("housner", "modified", "onset-matched")},
}
"""Name -> method, of all that are no engines."""


def methods_of(sources: Iterable[str]) -> dict[str, Method]:
    """Return the methods of sources by their names; of an engine without a preset those of all."""
    names = list(sources)
    found = {name: method for name, method in PLAIN.items() if method.source in names}
    iterated = {}
    for engine, _, preset in (name.partition(":") for name in names):
        if engine not in ENGINES:
            continue
        for use in [ENGINES[engine].preset(preset)] if preset else uses_of(engine):
            source, knob = f"{engine}:{use.name}", use.accuracy_knob
            setting, values = knob or ("step", STEPS[1:-1])
            found[f"{engine} {use.name}"] = Method(source, setting, values, own=knob is not None)
            if use.name == "tuned" and use.takes(iterations=1):
                values = (2.0, 5.0, 10.0, 50.0, 200.0)
                method = Method(source, "iterations", values, {"step": 1e-3}, own=True)
                iterated[f"{engine} tuned, iterations"] = method
    return found | iterated


def jobs(sources: Iterable[str], quick: bool) -> list[Job]:
    """Return a job for each method, setting and case; then those of scenes."""
    names = tuple(sources)
    # spent at most on timing a case with one setting, and on timing a scene
    brief_s, long_s = (0.02, 0.15) if quick else (0.5, 5.0)
    found, sets = [], chosen_cases(quick)
    for name, method in methods_of(names).items():
        # quick: every other setting, without the two dearest
        values = method.values[: max(len(method.values) - 2, 1) : 2] if quick else method.values
        for value, (kind, cases) in product(values, sets.items()):
            for case in cases:
                block, motion = case.block, case.motion
                window = free_rocking_window(block, motion)
                asked = Question(system=block, motion=motion, duration=window)
                labels = {"table": ALONG, "method": name, "value": value, "set": kind}
                labels |= {**asdict(case), "budget_s": brief_s}
                options = method.options_at(value)
                found.append(Job(labels=labels, case=asked, source=method.source, options=options))
    engines = dict.fromkeys(engine_of(name) for name in names if engine_of(name) in ENGINES)
    asked = Question(system=CASE.block, motion=CASE.motion)
    for engine, (left_out, options) in product(engines, omissions().items()):
        if has(ENGINES[engine], **options):
            labels = {"table": SCENES, "engine": engine, "scene": left_out, "budget_s": long_s}
            found.append(Job(labels=labels, case=asked, source=engine))
    return found


def measure(job: Job) -> Row:
    """Return what a job's table has of it."""
    return {ALONG: along, SCENES: put_back}[job.labels["table"]](job)


def along(job: Job) -> Row:
    """Run a job over its whole window once, then time it to its peak alone."""
    whole, block, case = ask(job), job.case.system, job.case
    assert isinstance(block, RigidBlock)
    plain = replace(job, case=replace(case, duration=None))

    def timed() -> Response:
        start = time.perf_counter()
        response = ask(plain)
        # by the same clock for all sources, of which only engines know their own
        return replace(response, setup_s=time.perf_counter() - start - response.wall_s)

    ((best, runs),) = best_of([timed], job.labels["budget_s"])
    found, error = whole, math.nan
    if best.outcome is Outcome.FAILED:
        found = best
    elif whole.outcome is not Outcome.FAILED:
        timed_alone = ("outcome", "peak_ratio", "steps", "wall_s")
        found = replace(whole, **{name: getattr(best, name) for name in timed_alone})
        exact = simulate(block, case.motion, duration=case.duration)
        right = kind_of(found, exact) != REST
        error = abs(found.peak_ratio / exact.peak_ratio - 1.0) if right else math.inf
    return {**summary(found), "setup_s": round(best.setup_s, 9), "runs": runs, "error": error}


def omissions() -> dict[str, dict[str, Any]]:
    """Return the options that put back what a scene leaves out, by the name of that; none first."""
    window, grid = free_rocking_window(CASE.block, CASE.motion), np.linspace(0.0, 1.0, 1001)
    return {
        "as it is": {},
        "free body instead of planar": {"settings": {"planar": False}},
        "full box instead of corners": {"settings": {"geometry": "box"}},
        "base moving in the world": {"frame": "world"},
        "8/p of free rocking after the pulse": {"duration": window},
        "the same, recorded as a history": {"duration": window, "times": window * grid},
        "steps all equal": {"preset": "tuned"},
    }


def has(
    engine: Engine, preset: str = "", settings: Row | None = None, frame: str = "base", **_: Any
) -> bool:
    """Return whether an engine has what is put back into its scene."""
    known = not preset or preset in [use.name for use in engine.presets]
    return (
        known and frame in engine.frames and engine.preset(preset or None).takes(**settings or {})
    )


def put_back(job: Job) -> Row:
    """Time a scene with what it leaves out, in turn with the scene as it is."""
    options = omissions()[str(job.labels["scene"])]
    observed = {name: options.pop(name) for name in ("duration", "times") if name in options}
    preset = options.pop("preset", "")
    source, case = f"{job.source}:{preset}" if preset else job.source, replace(job.case, **observed)
    posed = replace(job, case=case, source=source, options=options)
    asked = [partial(ask, posed), partial(ask, job)]
    (found, runs), (plain, _) = best_of(asked, job.labels["budget_s"])
    exact = simulate(CASE.block, CASE.motion).peak_ratio
    return {
        **summary(found),
        "runs": runs,
        "step_s": found.wall_s / max(found.steps, 1),
        "plain_s": plain.wall_s,
        "setup_s": found.setup_s,
        "error": found.peak_ratio / exact - 1.0,
    }


OF_SCENES = [
    *("engine", "scene", "outcome", "wall_s", "runs", "steps"),
    *("step_s", "plain_s", "setup_s", "error", "message"),
]
"""Columns of the table of scenes."""


def tabulate(rows: Tables) -> Tables:
    """Return the rows of each table, and a line for each method, setting and set of cases."""
    scenes = rows.get(SCENES, pd.DataFrame()).reindex(columns=OF_SCENES)
    found = rows[ALONG].drop(columns="table")
    return {ALONG: found, SCENES: scenes, "work-precision": work_precision(found)}


def work_precision(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each set, method and setting: errors over the cases, cost of one case."""
    rows = rows.assign(failed=rows["outcome"] == Outcome.FAILED.value)
    groups = rows.groupby(["set", "method", "value"], sort=False)
    return groups.agg(
        cases=("error", "size"),
        failed=("failed", "sum"),
        median_error=("error", "median"),
        max_error=("error", "max"),
        **{name: (name, "mean") for name in ("steps", "wall_s", "setup_s")},
        runs=("runs", "min"),
    ).reset_index()


def engines_of(table: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the engines along their steps."""
    along = [name for name, method in methods_of(ENGINES).items() if method.setting == "step"]
    return table[table["method"].isin(along)]


def cheapest(table: pd.DataFrame) -> tuple[float, pd.Series[Any], str] | None:
    """Return the smallest error that an engine keeps, its cheapest setting, and on which cases."""
    engines = engines_of(table)
    for cases, lines in ((ALL, joint(engines)), (TYPICAL, engines[engines["set"] == TYPICAL])):
        for target in reversed(TARGETS):
            if (best := cheapest_below(lines, target)) is not None:
                return target, best, cases
    return None


def over_targets(table: pd.DataFrame, column: str) -> pd.DataFrame:
    """Return a column of each method's cheapest setting below some errors, an error a column."""
    found = {
        name: {f"{target:g}": best[column] for target in FINE_TARGETS
               if (best := cheapest_below(lines, target)) is not None}
        for name, lines in table.groupby("method", sort=False)
    }  # fmt: skip
    shown = pd.DataFrame.from_dict(found, "index", columns=[*map("{:g}".format, FINE_TARGETS)])
    return shown.dropna(how="all").rename_axis("method").reset_index()


def finding(tables: Tables) -> str:
    """Say with which engine the smallest error is cheapest, and how much the exact one costs."""
    table = tables["work-precision"]
    if engines_of(table).empty:
        return f"The exact solution takes {duration(exact_cost(table))} per case."
    if (found := cheapest(table)) is None:
        return f"No setting of an engine predicts every typical peak within {part(TARGETS[0])}."
    target, best, cases = found
    engine, preset, _ = parts_of(best["method"])  # one along its steps
    method = f"{ENGINES[engine].title} {look_of(preset).words}"
    exact = exact_cost(table if cases == ALL else table[table["set"] == TYPICAL])
    over = f", {best['wall_s'] / exact:.3g} times the run time of the exact solution"
    return (
        f"{method} predicts every {'typical ' * (cases == TYPICAL)}peak within {part(target)} "
        f"in {duration(best['wall_s'])} per case{over if exact > 0.0 else ''}."
    )


def shown(tables: Tables) -> Tables:
    """Return what each error costs, and what a scene costs."""
    table, scenes = tables["work-precision"], tables[SCENES]
    typical = table[table["set"] == TYPICAL]
    costs = over_targets(typical, "wall_s")
    costs[costs.columns[1:]] /= exact_cost(typical)
    found = {
        "The cheapest setting of each method below an error of typical peaks": over_targets(
            typical, "value"
        ),
        f"Its run time over that of the {EXACT} at its tightest": costs,
        "What a scene leaves out, put back one at a time; cost: run time over the scene as it is": (
            scenes.assign(cost=scenes["wall_s"] / scenes["plain_s"])[scenes["steps"] > 0].drop(
                columns="message"
            )
        ),
    }
    return {title: table for title, table in found.items() if len(table)}


def figures(tables: Tables) -> Figures:
    """Draw error against run time."""
    from studies.drawing.precision import draw_precision

    return {"precision": draw_precision(tables["work-precision"])}


STUDY = Study(
    name="precision",
    question="What accuracy does a given run time buy, and what can be left out?",
    help="""Error against run time of every method, from coarse to fine settings, on the same cases.

The setting is a tolerance, a step or the iterations of a solver. 12 cases have typical peaks, 12
are near overturning. A run time is the shortest of at least five runs, or of fewer runs if they
take longer than half a second; a column counts them. Building and compiling are timed separately.
A second table gives the cost of what a scene leaves out, such as a free body, a full box or a
moving base. A compiled loop over mj_step takes MuJoCo's steps; Python takes all others. With
--jobs above 1 processes slow each other down. Takes about 10 minutes.""",
    sources=(*dict.fromkeys(method.source for method in PLAIN.values()), *core_sources()),
    quick="Fewer cases and settings, shorter timing: one and a half minutes.",
    needed=lambda rows: [row for row in rows if row["table"] == ALONG],
    captions={
        "precision": "Median error of the peak against run time, from coarse to fine settings: "
        "models, solvers, and engines with default, tuned and landing (or error-controlled) "
        "steps. A cross marks a failed case or a wrong outcome."
    },
    alone=True,
    split="table",
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
