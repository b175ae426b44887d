"""Error against run time: errors, orders and cheapest settings, from the CSV alone."""

from __future__ import annotations

import json
import math
from itertools import chain
from pathlib import Path

import numpy as np
import pandas as pd

from analytic import simulate
from analytic.response import Outcome, Response
from studies.cases.paper import Case, free_rocking_window
from studies.cases.selection import COMPARED_IMPACTS, chosen_cases
from studies.drawing.kept import tell
from studies.old.tables import write_table
from studies.measures.words import duration, listed, part, times
from studies.precision import STUDY
from studies.precision.choices import ALL, EXACT, TYPICAL, cheapest_below, choices, exact_cost
from studies.precision.methods import METHODS, Method

TARGETS = (1e-2, 1e-3, 1e-4, 1e-6)
STRICT = "RK4"
"""The paper's solver, with a strict criterion for contact."""

CASE = ("figure", "aspect", "width_m", "omega_over_p")
"""Columns that tell one case from another."""

FINEST = (
    *("method", "value", "median_error", "max_error", "impact_error", "energy_drift"),
    *("steps", "wall_s", "runs", "setup_s"),
)
"""Columns of the table of the finest settings."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's precision.csv; write and return what it shows."""
    rows = pd.read_csv(folder / "precision.csv", dtype={"message": str})
    table = work_precision(with_errors(rows))
    write_table(folder / "work-precision.csv", table)
    typical = table[table["set"] == TYPICAL]
    costs = cheapest(typical)
    tables = {
        "Cheapest setting with which, as with every finer one, the largest error of a typical "
        "case stays below": over_targets(costs, "value"),
        f"Its cost over that of the {EXACT} at its tightest": over_targets(costs, "cost"),
        "Typical cases at the setting with the smallest median error": finest(typical),
    }
    return tell(STUDY, folder, tables)


def finding(table: pd.DataFrame) -> str:
    """Say what the smallest of the targets costs with an engine, and with the paper's solver."""
    found = choices(table)
    reached = [target for target, cases in found if cases == TYPICAL]
    if not reached:
        return "No engine setting reaches any of the errors asked for on every typical case."
    asked = {TYPICAL: "on typical cases", ALL: "with those near overturning"}
    engines = [
        f"{times(chosen['over_exact'])} that {words} ({chosen['setting']})"
        for cases, words in asked.items()
        if (chosen := found.get((reached[-1], cases)))
    ]
    typical = table[table["set"] == TYPICAL]
    own = exact_cost(typical)
    best = cheapest_below(typical[typical["method"] == STRICT], reached[-1])
    rival = "" if best is None else f"; RK4 takes {times(best['wall_s'] / own)} it"
    return (
        f"The exact solution takes {duration(own)} a case. An error below {part(reached[-1])} "
        f"costs an engine {listed(engines)}{rival}."
    )


def with_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Add to every row its errors: of the peak, against its method's own finest run, of impacts.

    A wrong outcome is an infinite error, so that it cannot pass unseen; a failed row has none.
    """
    exact = {}
    for case in chain(*chosen_cases(quick=False).values()):
        window = free_rocking_window(case.block, case.motion)
        found = simulate(case.block, case.motion, duration=window)
        exact[tuple(getattr(case, name) for name in CASE)] = case, found
    posed = [exact[case] for case in rows[list(CASE)].itertuples(index=False, name=None)]
    peaks = np.array([response.peak_ratio for _, response in posed])
    failed = rows["outcome"] == Outcome.FAILED.value
    error = (rows["peak_ratio"] / peaks - 1.0).abs()
    finest = rows.groupby(["method", "figure", "aspect", "set"])["peak_ratio"].transform("last")
    own = (rows["peak_ratio"] / finest - 1.0).abs()
    impacts = map(json.loads, rows["impact_times"])
    late = [_impact_error(each, *asked) for each, asked in zip(impacts, posed, strict=True)]
    return rows.assign(
        error=error.mask(failed),
        own_error=own.mask(failed),
        impact_error=pd.Series(late, index=rows.index).mask(failed),
        failed=failed,
        pulse_s=[case.motion.duration for case, _ in posed],
    )


def _impact_error(found: list[float], case: Case, exact: Response) -> float:
    """Return the largest error of the first impact times [1/p]; inf where one is missing."""
    wanted = [impact.time * case.block.p for impact in exact.impacts[:COMPARED_IMPACTS]]
    if len(found) < len(wanted):
        return math.inf
    return max((abs(a - b) for a, b in zip(found, wanted, strict=False)), default=0.0)


def work_precision(compared: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each method, setting and set: errors over the cases, cost of one case."""
    groups = compared.groupby(["set", "method", "value"], sort=False)
    table = groups.agg(
        cases=("error", "size"),
        failed=("failed", "sum"),
        median_error=("error", "median"),
        max_error=("error", "max"),
        own_error=("own_error", "median"),
        impact_error=("impact_error", "median"),
        energy_drift=("energy_drift", "median"),
        steps=("steps", "mean"),
        wall_s=("wall_s", "mean"),
        setup_s=("setup_s", "mean"),
        runs=("runs", "min"),
        pulse_s=("pulse_s", "mean"),
    ).reset_index()
    table["real_time_factor"] = table["pulse_s"] / table["wall_s"]
    return table.drop(columns="pulse_s")


def cheapest(table: pd.DataFrame) -> pd.DataFrame:
    """Return for methods and targets the cheapest setting that stays below with all finer ones.

    Returns
    -------
    DataFrame
        method, target, value, and cost: over that of the Taylor series at its tightest tolerance.
    """
    unit = table[table["method"] == EXACT]["wall_s"].iloc[-1]
    return pd.DataFrame(
        {"method": name, "target": target, "value": best["value"], "cost": best["wall_s"] / unit}
        for name, group in table.groupby("method", sort=False)
        for target in TARGETS
        if (best := cheapest_below(group, target)) is not None
    )


def over_targets(costs: pd.DataFrame, name: str) -> pd.DataFrame:
    """Return a column of `cheapest` as a table: a row for each method, a column for each target."""
    if costs.empty:
        return costs
    found = costs.set_index(["method", "target"])[name].unstack("target", sort=False)
    shown = found.sort_index(axis=1, ascending=False).rename(columns="{:g}".format)
    return shown.reset_index()


def finest(table: pd.DataFrame) -> pd.DataFrame:
    """Return each method at its smallest median error, with its order and how many cases failed."""
    lines = []
    for name, group in table.groupby("method", sort=False):
        order, spread = observed_order(group, METHODS[str(name)])
        best = group.sort_values("median_error").iloc[0]
        found = {"order": order, "order_error": spread, "failed": group["failed"].sum()}
        lines.append({**best[list(FINEST)], **found})
    return pd.DataFrame(lines)


def observed_order(line: pd.DataFrame, method: Method) -> tuple[float, float]:
    """Return the order of the median error in the step with its standard error; nan if unclear.

    A line through the logarithms, over the settings whose error is above three times the floor, and
    that are coarser than the one that reaches it: beyond, rounding makes the error grow again.
    """
    from scipy.stats import linregress

    usable = line[(line["failed"] == 0) & np.isfinite(line["median_error"])]
    floor = usable["median_error"].min()
    reached = usable["value"][usable["median_error"] == floor].max()
    usable = usable[usable["median_error"].between(3.0 * floor, 0.3, inclusive="neither")]
    usable = usable[usable["value"] > reached]
    if not method.stepping or len(usable) < 3:
        return math.nan, math.nan
    fit = linregress(np.log(usable["value"]), np.log(usable["median_error"]))
    return float(fit.slope), float(fit.stderr)
