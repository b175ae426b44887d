"""Estimates beside the true errors, and by how much they are to be multiplied."""

import math

import pandas as pd

from studies.measures.differences import scientific, with_reference
from studies.measures.halving import BOUNDED, MOST_TRUSTED, estimates_of
from studies.measures.presets import engine_of, in_order, in_words, preset_of
from studies.measures.words import capital, listed, out_of, part

RESOLVED = 1e-9
"""Errors below are as good as none: no estimate has to bound them."""


def beside_errors(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each case and source: its estimate beside its error.

    Parameters
    ----------
    rows : DataFrame
        The columns of estimate.csv, half being 1 for the runs at half the step.

    Returns
    -------
    DataFrame
        The rows at the whole step with the columns of `with_reference`, estimate, and over: the
        error over the estimate, 0 where there is no error to speak of; nan unless both rocked.
    """
    whole = with_reference(rows[rows["half"] == 0]).reset_index(drop=True)
    whole = whole.assign(estimate=estimates_of(whole, rows[rows["half"] == 1]))
    errors = whole["error"].abs()
    over = (errors / whole["estimate"]).where(errors > RESOLVED, 0.0)
    return whole.assign(over=over.where(errors.notna() & whole["estimate"].notna()))


def factors(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: by how much its estimates are to be multiplied.

    Parameters
    ----------
    lines : DataFrame
        From `beside_errors`.

    Returns
    -------
    DataFrame
        source, cases, survivors (in both), median_estimate, median_error, the factors that bound
        half, 95 % and all of the errors, the parts that 3 and 10 estimates bound; wrong outcomes,
        and how many of them half the step tells by another one.
    """
    table = []
    for source, rows in lines.groupby("source", sort=False):
        kept = rows[rows["over"].notna()]
        wrong = rows[~rows["agrees"] & (rows["outcome"] != "failed")]
        table.append(
            {
                "source": source,
                "cases": len(rows),
                "survivors": len(kept),
                "median_estimate": kept["estimate"].median(),
                "median_error": kept["error"].abs().median(),
                "factor_50": _quantile(kept["over"], 0.5),
                "factor_95": _quantile(kept["over"], BOUNDED),
                "factor_all": _quantile(kept["over"], 1.0),
                "within_3": (kept["over"] <= 3.0).mean(),
                "within_10": (kept["over"] <= 10.0).mean(),
                "wrong": len(wrong),
                "told": int((wrong["estimate"] == math.inf).sum()),
            }
        )
    return pd.DataFrame(table)


def _quantile(values: "pd.Series[float]", level: float) -> float:
    """Return the smallest value that so much of all are not above; nan without any."""
    ordered = values.sort_values(ignore_index=True)
    if ordered.empty:
        return math.nan
    return float(ordered[max(math.ceil(level * len(ordered)) - 1, 0)])


def factors_text(table: pd.DataFrame) -> str:
    """Return factors as an aligned table."""
    shown = pd.DataFrame(
        {
            "source": table["source"],
            "survive": table["survivors"],
            "estimate": table["median_estimate"].map(scientific),
            "error": table["median_error"].map(scientific),
            "half": table["factor_50"].map("{:.3g}".format),
            "95 %": table["factor_95"].map("{:.3g}".format),
            "all": table["factor_all"].map("{:.3g}".format),
            "within 3": table["within_3"].map(part),
            "within 10": table["within_10"].map(part),
            "wrong outcomes told": table["told"].astype(str) + "/" + table["wrong"].astype(str),
        }
    )
    return shown.to_string(index=False)


def first_claim(table: pd.DataFrame) -> str:
    """Say whose estimates bound the error, and whose do not see it."""
    good = table[table["factor_95"] <= MOST_TRUSTED]
    blind = table[table["factor_95"] > MOST_TRUSTED]
    words = [f"{line['source']} ({line['factor_95']:.2g})" for _, line in good.iterrows()]
    claim = (
        f"The difference from half the step, times the number in brackets, bounds {part(BOUNDED)} "
        f"of the errors of {listed(words)}"
    )
    if blind.empty:
        return f"{claim}."
    missed = [f"{line['source']} ({line['factor_95']:.3g})" for _, line in blind.iterrows()]
    return f"{claim}; it does not see those of {listed(missed)}."


def told(table: pd.DataFrame) -> str:
    """Say of every preset what part of the errors 3 and 10 estimates bound, engine by engine."""
    presets = table["source"].map(preset_of)
    return " ".join(_of_preset(name, table[presets == name]) for name in in_order(presets))


def _of_preset(preset: str, lines: pd.DataFrame) -> str:
    head = capital(in_words(preset))
    ordered = lines[lines["survivors"] > 0].sort_values("within_10", kind="stable")
    if ordered.empty:
        return f"{head} no case rocked at both steps."
    words = [
        f"{engine_of(line['source'])} {part(float(line['within_3']))} and "
        f"{part(float(line['within_10']))}"
        for _, line in ordered.iterrows()
    ]
    sentence = f"{head} 3 and 10 estimates bound, of the errors of {listed(words)}"
    if wrong := int(lines["wrong"].sum()):
        seen = out_of(int(lines["told"].sum()), wrong)
        sentence += f"; of their wrong outcomes half the step tells {seen}"
    return f"{sentence}."
