"""A sweep's rows beside the exact solution: errors, outcomes, the summary table."""

import math

import numpy as np
import pandas as pd

from analytic import peak_ratios
from studies.cases import PULSES

CASE_COLUMNS = ["figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p"]
"""What tells one case from another."""

SUMMARY_COLUMNS = [
    "figure",
    "source",
    "cases",
    "agree",
    "median_error",
    "p90_error",
    "max_error",
    "false_overturnings",
    "missed_overturnings",
    "failed",
    "wall_s",
]


def with_reference(rows: pd.DataFrame) -> pd.DataFrame:
    """Add the exact outcome and peak of every case, and the difference of each row from them.

    Parameters
    ----------
    rows : DataFrame
        The columns of sweep.csv.

    Returns
    -------
    DataFrame
        With the further columns exact_outcome, exact_peak, agrees, error (relative, where both
        rocked and survived; else nan), false_overturning and missed_overturning.
    """
    peak, outcome = peak_ratios(
        np.arctan(1.0 / rows["aspect"].to_numpy(float)),
        (1.0 / rows["aspect"] + rows["excess_g"]).to_numpy(float),
        rows["omega_over_p"].to_numpy(float),
        rows["pulse"].map(PULSES).to_numpy(),
    )
    joined = rows.assign(exact_peak=peak, exact_outcome=[_word(item) for item in outcome])
    found, right = joined["outcome"], joined["exact_outcome"]
    both_rocked = (found == "rocked") & (right == "rocked")
    return joined.assign(
        agrees=found == right,
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both_rocked),
        false_overturning=(found == "overturned") & (right != "overturned"),
        missed_overturning=(right == "overturned") & found.isin(["rocked", "at rest"]),
    )


def _word(outcome: object) -> str:
    return str(getattr(outcome, "value", outcome))


def summarize(compared: pd.DataFrame) -> pd.DataFrame:
    """Return one line for each figure and source, and for all figures where there are several.

    Parameters
    ----------
    compared : DataFrame
        From `with_reference`.
    """
    lines = _lines(compared)
    if compared["figure"].nunique() > 1:
        lines += _lines(compared.assign(figure="all"))
    return pd.DataFrame(lines, columns=SUMMARY_COLUMNS)


def _lines(compared: pd.DataFrame) -> list[list[object]]:
    return [
        [figure, source, *_line(group)]
        for (figure, source), group in compared.groupby(["figure", "source"], sort=False)
    ]


def _line(group: pd.DataFrame) -> list[object]:
    errors = group["error"].abs().dropna()
    return [
        len(group),
        int(group["agrees"].sum()),
        errors.median(),
        errors.quantile(0.9) if len(errors) else math.nan,
        errors.max(),
        int(group["false_overturning"].sum()),
        int(group["missed_overturning"].sum()),
        int((group["outcome"] == "failed").sum()),
        group["wall_s"].sum(),
    ]


def summary_text(summary: pd.DataFrame) -> str:
    """Return the summary as an aligned table; errors are relative, over the survivors."""
    shown = pd.DataFrame(
        {
            "figure": summary["figure"].astype(str),
            "source": summary["source"],
            "outcomes": summary["agree"].astype(str) + "/" + summary["cases"].astype(str),
            "median": summary["median_error"].map(scientific),
            "p90": summary["p90_error"].map(scientific),
            "max": summary["max_error"].map(scientific),
            "false": summary["false_overturnings"],
            "missed": summary["missed_overturnings"],
            "failed": summary["failed"],
            "time s": summary["wall_s"].map("{:.3g}".format),
        }
    )
    repeated = shown["figure"].eq(shown["figure"].shift())
    shown["figure"] = shown["figure"].mask(repeated, "")
    return shown.to_string(index=False)


def scientific(value: float) -> str:
    """Return a number in two digits, "-" for nan."""
    if math.isnan(value):
        return "-"
    return f"{value:.1e}" if value else "0"
