"""Error against run time, reported: errors, orders, cheapest settings, from the CSV alone."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd

from analytic import simulate
from analytic.response import Outcome, Response
from studies.cases.paper import Case, free_rocking_window
from studies.cases.selection import COMPARED_IMPACTS, chosen_cases
from studies.drawing.kept import Pictures, keep
from studies.kit.tables import write_table
from studies.measures.costs import LOOPS, loop_of
from studies.measures.differences import scientific
from studies.measures.words import duration, listed, times
from studies.precision import cost_report
from studies.precision.choices import TYPICAL, cheapest_below, choices, exact_cost
from studies.precision.methods import METHODS
from studies.precision.orders import observed_order

if TYPE_CHECKING:
    from matplotlib.figure import Figure

TARGETS = (1e-2, 1e-3, 1e-4, 1e-6)
STRICT = "RK4"
"""The paper's solver, with a strict criterion for contact."""

CASE = ("figure", "aspect", "width_m", "omega_over_p")
"""Columns that tell one case from another."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's precision.csv; return tables and findings as text."""
    rows = pd.read_csv(folder / "precision.csv", dtype={"message": str})
    table = work_precision(with_errors(rows))
    write_table(folder / "work-precision.csv", table)
    typical = table[table["set"] == "typical"]
    text = "\n".join(
        [
            "Cheapest setting whose largest error of the peak stays below a target, as every finer",
            "one's does, typical cases; cost over that of the Taylor series at its tightest:",
            cheapest(typical).to_string(index=False),
            "\nErrors at the finest setting, where they stop falling, and the observed order:",
            floor_text(typical),
        ]
    )
    return keep(folder, {"precision": drawn(folder)}, text)


def headline(folder: Path) -> str:
    """Return what a folder's work-precision.csv says first."""
    return first_claim(pd.read_csv(folder / "work-precision.csv"))


def first_claim(table: pd.DataFrame) -> str:
    """Say what the smallest of the targets costs with an engine, and with the paper's solver."""
    reached = [chosen for chosen in choices(table) if chosen.typical is not None]
    if not reached:
        return "No engine setting reaches any of the errors asked for on every typical case."
    last = reached[-1]
    engines = [
        f"{times(chosen.over_exact)} that {words}, {LOOPS[chosen.loop]}"
        for chosen, words in (
            (last.typical, "on typical cases"),
            (last.everywhere, "with those near overturning"),
        )
        if chosen is not None
    ]
    typical = table[table["set"] == TYPICAL]
    own = exact_cost(typical)
    best = cheapest_below(typical[typical["method"] == STRICT], last.target)
    rival = "" if best is None else f", and RK4 {times(best['wall_s'] / own)} it"
    return (
        f"The exact solution takes {duration(own)} a case; an error below {last.target:g} costs "
        f"an engine {listed(engines)}{rival}."
    )


def pictures(folder: Path) -> Pictures:
    """Draw the work-precision diagram of a folder, and what a scene costs, from the CSVs."""
    return {"precision": drawn(folder), **cost_report.pictures(folder)}


def drawn(folder: Path) -> Figure:
    """Draw the work-precision diagram of a folder's work-precision.csv."""
    from studies.precision.figure import draw_precision

    return draw_precision(pd.read_csv(folder / "work-precision.csv"))


def with_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Add to every row its errors: of the peak, against its method's own finest run, of impacts.

    A wrong outcome is an infinite error, so that it cannot pass unseen; a failed row has none.
    """
    exact = {}
    for case in (case for cases in chosen_cases(quick=False).values() for case in cases):
        window = free_rocking_window(case.block, case.motion)
        exact[tuple(asdict(case)[name] for name in CASE)] = (
            simulate(case.block, case.motion, duration=window),
            case,
        )
    names = list(rows[list(CASE)].itertuples(index=False, name=None))
    peaks = np.array([exact[name][0].peak_ratio for name in names])
    failed = rows["outcome"] == Outcome.FAILED.value
    error = (rows["peak_ratio"] / peaks - 1.0).abs()
    finest = rows.groupby(["method", "figure", "aspect", "set"])["peak_ratio"].transform("last")
    own = (rows["peak_ratio"] / finest - 1.0).abs()
    late = [
        _impact_error(json.loads(found), *exact[name])
        for found, name in zip(rows["impact_times"], names, strict=True)
    ]
    return rows.assign(
        error=error.mask(failed),
        own_error=own.mask(failed),
        impact_error=pd.Series(late, index=rows.index).mask(failed),
        failed=failed,
        pulse_s=[exact[name][1].motion.duration for name in names],
    )


def _impact_error(found: list[float], response: Response, case: Case) -> float:
    """Return the largest error of the first impact times [1/p]; inf where one is missing."""
    wanted = [impact.time * case.block.p for impact in response.impacts[:COMPARED_IMPACTS]]
    if len(found) < len(wanted):
        return math.inf
    pairs = zip(found, wanted, strict=False)
    return max((abs(a - b) for a, b in pairs), default=0.0)


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
        driver=("driver", lambda found: loop_of(found.fillna(""))),
        pulse_s=("pulse_s", "mean"),
    ).reset_index()
    table["real_time_factor"] = table["pulse_s"] / table["wall_s"]
    return table.drop(columns="pulse_s")


def cheapest(table: pd.DataFrame) -> pd.DataFrame:
    """Return, for each method and target, the cheapest setting that stays below with all finer.

    Costs are over that of the Taylor series at its tightest tolerance.
    """
    unit = table[table["method"] == "Taylor series"]["wall_s"].iloc[-1]
    lines = []
    for name, group in table.groupby("method", sort=False):
        line: dict[str, object] = {"method": name}
        for target in TARGETS:
            best = cheapest_below(group, target)
            if best is None:
                line[f"{target:.0e}"] = "-"
                continue
            setting = f" at {best['value']:.0e}" if METHODS[str(name)].setting else ""
            line[f"{target:.0e}"] = f"{best['wall_s'] / unit:.3g} x{setting}"
        lines.append(line)
    return pd.DataFrame(lines)


def floor_text(table: pd.DataFrame) -> str:
    """Return for each method its smallest median error, its order and the errors beside it."""
    lines = []
    for name, group in table.groupby("method", sort=False):
        best = group.sort_values("median_error").iloc[0]
        order, spread = observed_order(group, METHODS[str(name)])
        lines.append(
            {
                "method": name,
                "best setting": f"{best['value']:.0e}" if METHODS[str(name)].setting else "-",
                "median": scientific(best["median_error"]),
                "max": scientific(best["max_error"]),
                "impact times": scientific(best["impact_error"]),
                "energy": scientific(best["energy_drift"]),
                "order": "-" if math.isnan(order) else f"{order:.2f} ± {spread:.2f}",
                "steps": f"{best['steps']:.0f}",
                "time": f"{best['wall_s'] * 1e6:.0f} µs",
                "runs": int(best["runs"]),
                "loop": str(best["driver"] or "-"),
                "set-up": f"{best['setup_s'] * 1e6:.0f} µs",
                "failed": int(group["failed"].sum()),
            }
        )
    return pd.DataFrame(lines).to_string(index=False)
