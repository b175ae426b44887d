"""Rows beside the exact solution: errors, outcomes, the summary table."""

from __future__ import annotations

import math
from typing import Any, TypeAlias

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analytic import condition_numbers, conditioning, peak_ratios, sensitivities, sensitivity
from analytic.frame import Rocker, RockingFrame
from analytic.motion import FloatArray, Motion
from analytic.response import Outcome, Response
from studies.cases.paper import PULSES
from studies.measures.wrongness import counted, wrong_in

WELL_CONDITIONED = 10.0
"""Below this κ the error of a peak says more about its source than about the case."""


def with_reference(rows: pd.DataFrame) -> pd.DataFrame:
    """Add the exact outcome and peak of every case, and the difference of each row from them."""
    # kappa, kappa_eta and sensitivity are nan where no peak survives
    posed, eta, back = _different(rows)
    peak, outcome = peak_ratios(*posed, restitution=eta)
    condition = condition_numbers(*posed, restitution=eta)
    joined = rows.assign(
        kappa=condition.amplitude[back],
        kappa_eta=condition.restitution[back],
        sensitivity=sensitivities(*posed, restitution=eta)[back],
        exact_peak=peak[back],
        exact_outcome=[str(getattr(it, "value", it)) for it in outcome[back]],
    )
    return beside(joined)


def beside(joined: pd.DataFrame) -> pd.DataFrame:
    """Add the difference of each row from its exact outcome and peak."""
    # error and difference are nan where the outcome is wrong or the exact block does not rock and
    # survive
    found, right = joined["outcome"], joined["exact_outcome"]
    agrees = wrong_in(joined) == ""
    both_rock = agrees & (right == "rocked")
    return joined.assign(
        agrees=agrees,
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both_rock),
        difference=(joined["peak_ratio"] - joined["exact_peak"]).where(both_rock),
        false_overturning=(found == "overturned") & (right != "overturned"),
        missed_overturning=(right == "overturned") & found.isin(["rocked", "at rest"]),
    )


Posed: TypeAlias = tuple[FloatArray, FloatArray, FloatArray, FloatArray]


def posed_cases(cases: pd.DataFrame) -> Posed:
    """Return the first four arguments of `peak_ratios`."""
    steepness = 1.0 / cases["aspect"].to_numpy(float)
    amplitude = cases["amplitude_g"] if "amplitude_g" in cases else steepness + cases["excess_g"]
    half_cycles = cases["half_cycles"] if "half_cycles" in cases else cases["pulse"].map(PULSES)
    posed = np.arctan(steepness), amplitude, cases["omega_over_p"], half_cycles
    alpha, strength, omega, cycles = (np.asarray(column, np.float64) for column in posed)
    return alpha, strength, omega, cycles


def _different(cases: pd.DataFrame) -> tuple[Posed, FloatArray | None, NDArray[np.intp]]:
    """Return what is posed without repeats, frames' restitution, and where each case is there."""
    columns = [*posed_cases(cases)]
    if "load" in cases:
        frames = zip(cases["aspect"], cases["load"], strict=True)
        found = [RockingFrame(width=1.0, height=h, load=load).restitution for h, load in frames]
        columns.append(np.array(found))
    rows, back = np.unique(np.stack(columns, axis=1), axis=0, return_inverse=True)
    alpha, amplitude, omega, cycles, *kept = (np.ascontiguousarray(each) for each in rows.T)
    return (alpha, amplitude, omega, cycles), kept[0] if kept else None, back


def conditioning_of_one(
    block: Rocker, motion: Motion, start: tuple[float, float], exact: Response
) -> dict[str, float]:
    """Return the condition number and sensitivity of an exact peak, as EQUATIONS.md has them."""
    if exact.outcome is Outcome.FAILED:
        return {"kappa": math.nan, "sensitivity": math.nan}
    kappa, _ = conditioning(block, motion, start=start)
    return {"kappa": kappa, "sensitivity": sensitivity(block, motion, start=start)}


def sensitivity_of(cases: pd.DataFrame) -> pd.Series[float]:
    """Return what errors are judged against: the largest of κ, κ of η and sensitivity, and 1."""
    kappas = cases[["kappa", "kappa_eta"]].abs().max(axis=1, skipna=False)
    return kappas.clip(lower=1.0).clip(lower=cases["sensitivity"])


def summarize(compared: pd.DataFrame) -> pd.DataFrame:
    """Return one line for each figure and source, and for all figures where there are several."""
    tables = [compared]
    if compared["figure"].nunique() > 1:
        tables.append(compared.assign(figure="all"))
    return pd.DataFrame(
        [
            {"figure": figure, "source": source, **_line(group)}
            for table in tables
            for (figure, source), group in table.groupby(["figure", "source"], sort=False)
        ]
    )


def _line(group: pd.DataFrame) -> dict[str, Any]:
    errors, differences = group["error"].abs().dropna(), group["difference"].abs()
    return {
        "cases": len(group),
        "agree": int(group["agrees"].sum()),
        **counted(wrong_in(group)),
        "survivors": len(errors),
        "median_error": errors.median(),
        "p90_error": errors.quantile(0.9),
        "max_error": errors.max(),
        "max_error_over_kappa": (errors / sensitivity_of(group)).max(),
        "median_difference": differences.median(),
        "max_difference": differences.max(),
        "false_overturnings": int(group["false_overturning"].sum()),
        "missed_overturnings": int(group["missed_overturning"].sum()),
        "wall_s": group["wall_s"].sum(),
    }
