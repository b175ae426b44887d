"""Where the reference is valid: no lift-off, no slip; and what the engines do beyond."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic import RigidBlock, SinePulse, simulate
from analytic.response import Outcome, Reason, Response
from studies.cases.extreme import Extreme
from studies.drawing.kept import tell
from studies.old.arguments import BadInputError, Out
from studies.old.jobs import Job, summary
from studies.old.journal import Row
from studies.old.naming import EngineSources
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.plan import Plan, Tables, carry_out
from studies.old.tables import write_table
from studies.measures.words import listed
from studies.sources.registry import core_sources, resolve
from studies.validity import STUDY

CASE = ["aspect", "onsets", "omega_over_p"]
"""Columns that tell cases apart."""

ASPECTS = (1.0, 1.5, 2.0, 3.0)
"""H/B: the squatter, the less valid."""

MAP_ONSETS = tuple(np.geomspace(1.02, 8.0, 36).round(4).tolist())
MAP_OMEGAS = tuple(np.geomspace(0.5, 12.0, 36).round(4).tolist())
"""Amplitude over g tan alpha, and omega/p, of the map of the reference."""

ONSETS = (1.2, 1.6, 2.4, 3.6, 5.4)
OMEGAS = (1.0, 2.0, 4.0, 8.0)
"""The same of the engines' cases."""

FACTORS = (0.5, 0.8, 0.95, 1.05, 1.25)
QUICK_FACTORS = (0.8, 1.05)
"""Friction of an engine over the least that the reference needs."""

MOST_NEEDED = 8.0
"""Friction needed by the reference beyond which no FACTORS are tried: near N = 0 it grows without
bound, and an engine takes 10 at most."""

DEFAULT_SOURCES = core_sources("fixed")


def command(
    *,
    out: Out,
    sources: EngineSources = DEFAULT_SOURCES,
    quick: bool = False,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Map where the reference is valid, and see what engines do beyond.

    Parameters
    ----------
    sources
        Engines.
    quick
        Every other case of the engines, and fewer frictions.
    """
    for name in sources:
        if resolve(name).kind != "engine":
            raise BadInputError(f"--sources names {name!r}; it must name engines, which can slide")
    every = 2 if quick else 1
    onsets, omegas = ONSETS[::every], OMEGAS[::every]
    factors = QUICK_FACTORS if quick else FACTORS
    jobs = []
    # with the engine's own friction, and, where the reference needs no more, with parts of that
    for case in product(ASPECTS, onsets, omegas):
        needed = simulate(*posed(*case)).friction_needed
        for source in sources:
            jobs.append(_job(case, source, math.nan, {}))
            if needed <= MOST_NEEDED:
                jobs += [_job(case, source, f, {"friction": f * needed}) for f in factors]
    plan = Plan(
        jobs=jobs,
        settings={"onsets": onsets, "omegas": omegas, "factors": factors},
        growing={"source": sources},
        reduce=_reduce,
        tabulate=tabulate,
        # a block that slid away is what was asked for
        needed=lambda rows: [row for row in rows if row["verdict"] == "failed"],
    )
    return carry_out(STUDY, plan, out, running, report)


def tabulate(rows: Sequence[Row]) -> Tables:
    """Return the engines' table, and the map of the reference beside it."""
    reference = reference_map(product(ASPECTS, MAP_ONSETS, MAP_OMEGAS))
    return {"validity": pd.DataFrame(rows), "map": reference}


def posed(aspect: float, onsets: float, omega_over_p: float) -> tuple[RigidBlock, SinePulse]:
    """Return a block, by similarity one of any width, and a full-sine pulse of so many g B/H."""
    case = Extreme(
        name="", group="validity", aspect=aspect, onsets=onsets, omega_over_p=omega_over_p
    )
    return case.block, case.motion


def reference_map(cases: Iterable[Sequence[float]]) -> pd.DataFrame:
    """Return what the exact solution of each case needs to be one: the columns of map.csv."""
    rows = []
    for case in cases:
        exact = simulate(*posed(*case))
        needs = (exact.outcome.value, exact.peak_ratio, exact.min_normal, exact.friction_needed)
        rows.append((*case, *needs))
    needed = ["outcome", "peak_ratio", "min_normal", "friction_needed"]
    return pd.DataFrame(rows, columns=[*CASE, *needed])


def _job(case: Sequence[float], source: str, factor: float, options: dict[str, float]) -> Job:
    block, motion = posed(*case)
    labels = {**dict(zip(CASE, case, strict=True)), "friction_factor": factor}
    return Job(labels=labels, block=block, motion=motion, source=source, options=options)


LIFTED_WIDTHS = 3e-5
"""A pivot that rises by this part of the width has lifted off; three times what it does where the
reference needs no pull."""

SLID_WIDTHS = 3e-4
"""A pivot that moves along the base by this part of the width has slid: five times the creep of a
contact that holds."""

LEFT = {Reason.SLID: "slid away", Reason.THROWN: "flew off"}
"""Reason of a failure that is an answer of the study -> verdict."""


def _reduce(job: Job, response: Response) -> Row:
    row = summary(job, response)
    slip, hop = response.slip_m / job.block.width, response.hop_m / job.block.width
    gone = LEFT.get(response.reason) if response.reason else None
    if response.outcome is Outcome.FAILED:
        verdict = gone or "failed"
    elif slip > SLID_WIDTHS:
        verdict = "slid and lifted off" if hop > LIFTED_WIDTHS else "slid"
    else:
        verdict = "lifted off" if hop > LIFTED_WIDTHS else "held"
    if gone:
        # an answer of the study: it is not tried again
        row["outcome"] = "left"
    return {**row, "slip_widths": slip, "hop_widths": hop, "verdict": verdict}


def report(folder: Path) -> str:
    """Reduce a folder's tables to compared.csv, the drawing and the findings; return these."""
    rows = pd.read_csv(folder / "validity.csv", dtype={"message": str})
    table = pd.read_csv(folder / "map.csv")
    cases = rows[CASE].drop_duplicates().to_numpy(float).tolist()
    beside = compared(rows, reference_map(cases))
    write_table(folder / "compared.csv", beside)
    own = beside["friction_factor"].isna()
    normal = pd.cut(beside["min_normal"], [-math.inf, -0.5, 0.0, 0.2, math.inf])
    tables = {
        "What the reference needs under full sines": needs(table),
        "Engines that hardly slide, by the normal force over the weight": verdicts(
            beside[own], normal[own]
        ),
        "Engines with a part of the friction needed": verdicts(
            beside[~own], beside.loc[~own, "friction_factor"]
        ),
    }
    return tell(STUDY, folder, tables)


def compared(rows: pd.DataFrame, exact: pd.DataFrame) -> pd.DataFrame:
    """Return the columns of compared.csv: the engines' rows beside the exact solution."""
    named = exact.rename(columns={"outcome": "exact_outcome", "peak_ratio": "exact_peak"})
    joined = rows.merge(named, on=CASE, validate="many_to_one")
    both = (joined["outcome"] == "rocked") & (joined["exact_outcome"] == "rocked")
    return joined.assign(
        agrees=joined["outcome"] == joined["exact_outcome"],
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both),
    )


def finding(table: pd.DataFrame) -> str:
    """Say from which amplitude on the reference does not hold, by slenderness."""
    words = [
        f"{f'from {ends:.2g} onsets' if math.isfinite(ends) else 'never'} at H/B {aspect:g}"
        for aspect, ends in needs(table).set_index("aspect")["from_onsets"].items()
    ]
    what = "where the pivot of a block that survives lifts off"
    return f"An engine is right to differ {what}: {listed(words)}."


def needs(table: pd.DataFrame) -> pd.DataFrame:
    """Return what the reference needs, a line for each H/B.

    How many of the map's cases and of those that survive need a pull at the pivot, and from which
    amplitude on; the friction needed where it survives and stays down.
    """
    survives, lifts = table["outcome"] == "rocked", table["min_normal"] < 0.0
    lost = lifts & survives
    found = table.assign(
        survive=survives,
        lifted=lifts,
        survivors_lifted=lost,
        from_onsets=table["onsets"].where(lost),
        friction=table["friction_needed"].where(survives & ~lifts),
    )
    groups = found.groupby("aspect")
    return groups.agg(
        cases=("survive", "size"),
        lifted=("lifted", "sum"),
        survive=("survive", "sum"),
        survivors_lifted=("survivors_lifted", "sum"),
        from_onsets=("from_onsets", "min"),
        least_friction=("friction", "min"),
        median_friction=("friction", "median"),
    ).reset_index()


def verdicts(rows: pd.DataFrame, by: pd.Series[Any]) -> pd.DataFrame:
    """Return how many cases of each source end how, and their errors, for each value of `by`."""
    keys = [rows["source"], by]
    groups = rows.assign(error=rows["error"].abs()).groupby(keys, observed=True)
    found = groups.agg(
        agrees=("agrees", "sum"),
        median_error=("error", "median"),
        max_error=("error", "max"),
        slip_widths=("slip_widths", "max"),
        hop_widths=("hop_widths", "max"),
    )
    counts = groups["verdict"].value_counts().unstack(fill_value=0)
    return counts.join(found).reset_index()
