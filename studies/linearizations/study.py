"""What in a linearization matters: its onset, its frequency, its saddle, each changed alone."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd

from analytic import peak_ratios
from analytic.models import Model
from analytic.motion import FloatArray
from studies.cases.paper import PULSES, sweep_cases
from studies.drawing.kept import tell
from studies.old.arguments import Out
from studies.old.journal import Row
from studies.old.options import DEFAULT_RUNNING
from studies.old.plan import Plan, Tables, carry_out
from studies.old.tables import read_table
from studies.linearizations import STUDY
from studies.measures.claims import TABLE, claim, read_findings, tally, write_findings
from studies.measures.differences import posed_cases
from studies.measures.words import out_of

NAMED = {"000": "housner", "100": "onset-matched", "111": "modified"}
"""Which of onset, frequency and saddle are changed from Housner's -> the model's name."""

QUANTILES = np.linspace(0.0, 1.0, 201)
GRIDS = ("paper", "wide")
SHOWN = [
    *("title", "cases", "wrong", "false", "missed", "median_error", "rms_error", "max_error"),
    *("rms_difference", "max_difference"),
]


def variant(changed: str) -> Model:
    """Return the linear model with Housner's or, by a 1, the modified onset, frequency and saddle.

    The onset is g alpha or g tan(alpha), the frequency p or p sqrt(cos(alpha)), the saddle alpha or
    tan(alpha); the forcing factor is the saddle over the onset.
    """
    onset, frequency, saddle = (digit == "1" for digit in changed)

    def angle(changed: bool, alpha: FloatArray) -> FloatArray:
        return np.tan(alpha) if changed else np.asarray(alpha, np.float64)

    words = (
        "onset " + ("g tan α" if onset else "g α"),
        "p√cos α" if frequency else "p",
        "saddle " + ("tan α" if saddle else "α"),
    )
    known = NAMED.get(changed)
    return Model(
        name=known or ", ".join(words),
        title=", ".join(words) + (f" ({known})" if known else ""),
        linear=True,
        saddle=lambda alpha: angle(saddle, alpha),
        frequency=lambda alpha: np.sqrt(np.cos(alpha)) if frequency else np.ones_like(alpha),
        forcing=lambda alpha: angle(saddle, alpha) / angle(onset, alpha),
    )


VARIANTS = {word: variant(word) for word in map("".join, itertools.product("01", repeat=3))}
"""Changes from Housner's, as of NAMED -> the model: all eight."""


def grid(name: str) -> pd.DataFrame:
    """Return the cases of a grid: aspect, amplitude_g, omega_over_p, half_cycles.

    "paper" is that of figures 6 to 9, without the copies by similarity; "wide" has H/B from 1.5 to
    10, amplitudes from 1.02 to 4 onsets and omega/p from 0.2 to 8.
    """
    if name == "paper":
        cases = [c for c in sweep_cases([6, 7, 8, 9]) if c.width_m == 0.5]
        rows = [(c.aspect, c.amplitude_g, c.omega_over_p, PULSES[c.pulse]) for c in cases]
    else:
        rows = [
            (aspect, onsets / aspect, omega, half_cycles)
            for aspect in np.geomspace(1.5, 10.0, 12)
            for onsets in np.geomspace(1.02, 4.0, 30)
            for omega in np.linspace(0.2, 8.0, 40)
            for half_cycles in PULSES.values()
        ]
    columns = ["aspect", "amplitude_g", "omega_over_p", "half_cycles"]
    return pd.DataFrame(rows, columns=columns)


def command(*, out: Out) -> int:
    """Take a linearization apart: onset, frequency and saddle, each changed alone."""
    return carry_out(STUDY, Plan(tabulate=tabulate), out, DEFAULT_RUNNING, report)


def tabulate(_: Sequence[Row] = ()) -> Tables:
    """Return the summary and the quantiles of all errors."""
    errors = all_errors()
    return {"linearizations": summarize(errors), "quantiles": quantiles(errors)}


@functools.cache
def all_errors() -> pd.DataFrame:
    """Return the cases of both grids through every variant."""
    return pd.concat([errors_on(name) for name in GRIDS], ignore_index=True)


def errors_on(name: str) -> pd.DataFrame:
    """Return every case of a grid through every variant, held against the exact solution."""
    cases = grid(name)
    posed = posed_cases(cases)
    exact, outcome = peak_ratios(*posed)
    parts = []
    for changed, model in VARIANTS.items():
        peak, found = peak_ratios(*posed, model=model)
        both = np.isfinite(peak) & np.isfinite(exact) & (exact > 0.0) & (peak > 0.0)
        found_peak, right = (np.where(both, value, np.nan) for value in (peak, exact))
        parts.append(
            cases.assign(
                grid=name,
                changed=changed,
                error=found_peak / right - 1.0,
                difference=found_peak - right,
                false=np.isinf(peak) & ~np.isinf(exact),
                missed=~np.isinf(peak) & np.isinf(exact),
                wrong=found != outcome,
            )
        )
    return pd.concat(parts, ignore_index=True)


def summarize(errors: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each grid and variant; errors are relative, differences in theta_cr."""
    groups = errors.groupby(["grid", "changed"], sort=False)
    table = groups.agg(
        cases=("wrong", "size"),
        wrong=("wrong", "sum"),
        false=("false", "sum"),
        missed=("missed", "sum"),
        survivors=("error", "count"),
        median_error=("error", lambda e: e.abs().median()),
        rms_error=("error", lambda e: np.sqrt((e**2).mean())),
        max_error=("error", lambda e: e.abs().max()),
        rms_difference=("difference", lambda e: np.sqrt((e**2).mean())),
        max_difference=("difference", lambda e: e.abs().max()),
    ).reset_index()
    titles = [VARIANTS[word].title for word in table["changed"]]
    return table.assign(title=titles)


def quantiles(errors: pd.DataFrame) -> pd.DataFrame:
    """Return the quantiles of the absolute relative error of each grid and variant."""
    parts = [
        pd.DataFrame(
            {
                "grid": name,
                "changed": changed,
                "quantile": QUANTILES,
                "error": rows["error"].abs().dropna().quantile(QUANTILES).to_numpy(),
            }
        )
        for (name, changed), rows in errors.groupby(["grid", "changed"], sort=False)
    ]
    return pd.concat(parts, ignore_index=True)


def report(folder: Path) -> str:
    """Draw the folder's tables, and write and return the text."""
    table, errors = STUDY.read(folder, "linearizations"), all_errors()
    write_findings(folder, [each(errors) for each in CONCLUSIONS])
    tables = {
        "What the paper concludes": read_table(folder / TABLE),
        **{f"On the {name} grid": table.loc[table["grid"] == name, SHOWN] for name in GRIDS},
        "On the wide grid by slenderness, the median error and the part of wrong outcomes": (
            by_slenderness(errors).reset_index()
        ),
    }
    return tell(STUDY, folder, tables)


def finding(folder: Path) -> str:
    """Say which of the paper's conclusions hold."""
    return tally(read_findings(folder), "the paper's conclusions about the linearizations")


@claim("(a) p√cos α in place of p brings a linearization closer, other things being equal")
def frequency_matters(errors: pd.DataFrame) -> tuple[bool, str]:
    """Change the frequency alone, with either onset and either saddle."""
    lines = errors["error"].abs().groupby([errors["grid"], errors["changed"]]).median()
    pairs = itertools.product(GRIDS, "01", "01")
    closer = [
        lines[g, f"{onset}1{saddle}"] < lines[g, f"{onset}0{saddle}"] for g, onset, saddle in pairs
    ]
    words = out_of(sum(closer), len(closer))
    return all(closer), f"the median error falls in {words} comparisons"


@claim("(b) Housner's linearization overturns blocks that survive, also at H/B of 3 and more")
def maps_mislead(errors: pd.DataFrame) -> tuple[bool, str]:
    """Count what Housner's linearization overturns falsely, also where H/B is 3 or more."""
    housner = errors[errors["changed"] == "000"]
    words, fallen = [], {}
    for name, rows in housner.groupby("grid", sort=False):
        slender = rows.loc[rows["aspect"] >= 3.0, "false"]
        fallen[name] = slender.any()
        words.append(
            f"{name} grid: {out_of(rows['false'].sum(), len(rows))} falsely overturned, at H/B ≥ 3 "
            f"{out_of(slender.sum(), len(slender))}; {rows['missed'].sum()} missed"
        )
    return bool(fallen["paper"]), "; ".join(words)


def by_slenderness(errors: pd.DataFrame) -> pd.DataFrame:
    """Return for each H/B of the wide grid how far off the named linearizations are.

    Returns
    -------
    DataFrame
        Columns by the model's name: its median error, and its part of wrong outcomes.
    """
    wide = errors[errors["grid"] == "wide"].assign(error=lambda rows: rows["error"].abs())
    groups = wide.groupby(["aspect", "changed"])
    parts = {"error": groups["error"].median(), "wrong": groups["wrong"].mean()}
    found = {
        word: part.unstack()[list(NAMED)].rename(columns=NAMED) for word, part in parts.items()
    }
    return pd.concat([part.add_suffix(f" {word}") for word, part in found.items()], axis=1)


@claim("(c) The modified linearization is closer than Housner's at every slenderness tried")
def modified_is_better(errors: pd.DataFrame) -> tuple[bool, str]:
    """Compare median errors and wrong outcomes at every slenderness."""
    found = by_slenderness(errors)
    closer = found["modified error"] < found["housner error"]
    as_right = found["modified wrong"] <= found["housner wrong"]
    counts = [out_of(each.sum(), len(found)) for each in (closer, as_right)]
    return bool((closer & as_right).all()), (
        f"closer in the median at {counts[0]} values of H/B, and wrong no more often at {counts[1]}"
    )


CONCLUSIONS = (frequency_matters, maps_mislead, modified_is_better)
"""What the paper concludes of the linearizations."""
