"""Contact models, reported: a line for each variant, what to set, and what it buys."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from engines import ENGINES
from engines.parts.factors import AS_BEST, BEST, BY_DEFAULT, DEFAULT
from studies.cases.variants import preset_values
from studies.contact.claims import errors_of, findings, first_claim, name_of, variant_of
from studies.drawing.kept import Pictures, keep
from studies.kit.tables import in_columns, read_table, write_table
from studies.measures.differences import scientific, with_reference
from studies.measures.wrongness import FALL, NO_ANSWER, REST, wrong_in

KEY = ["engine", "preset", "factor", "level"]
"""Columns that tell one variant from another."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's contact.csv; write and return tables and findings as text."""
    rows = read(folder / "contact.csv")
    lines, own = variant_table(rows[~rows["own_step"]]), variant_table(rows[rows["own_step"]])
    for name, table in {"variants": lines, "own-steps": own}.items():
        write_table(folder / f"{name}.csv", table)
    text = "\n".join(
        [
            "Every variant: errors of the peak over typical cases, outcomes over all cases.",
            "moves: by how much it changes a peak of its preset, at most; η: the velocity ratio",
            "over Housner's; e: Newton's coefficient; slip and sink in widths of the block.",
            "Peaks of half-sine cases come before any impact: a wrong impact shows in η alone.",
            "Cases near overturning, some within a few percent, count for outcomes and moves.",
            variants_text(lines),
            "\nFor rigid, inelastic, non-sliding contact set this:",
            recommendation_text(lines),
            "",
            findings(lines),
        ]
    )
    return keep(folder, pictures(folder), text)


def headline(folder: Path) -> str:
    """Return, for each engine, the tuned setting that matters most."""
    return first_claim(read(folder / "variants.csv"))


def pictures(folder: Path) -> Pictures:
    """Draw the largest error of every variant of a folder from its variants.csv alone."""
    from studies.contact.figure import draw_contact

    return {"contact": draw_contact(read(folder / "variants.csv"))}


def read(path: Path) -> pd.DataFrame:
    """Read a table back with empty words as such."""
    return read_table(path, "factor", "level", "trap")


def variant_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return one line for each variant: its errors, what it changes, its impact, its cost."""
    compared = with_reference(rows)
    case = ["set", "figure", "aspect"]
    base = compared[compared["factor"] == ""].set_index(["engine", "preset", *case])["peak_ratio"]
    base = base.where(np.isfinite(base))  # a preset that overturns has no peak to move
    own = base.reindex(pd.MultiIndex.from_frame(compared[["engine", "preset", *case]])).to_numpy()
    kinds = wrong_in(compared)
    compared = compared.assign(
        moved=(compared["peak_ratio"] / own - 1.0).where(compared["error"].notna()).abs(),
        typical=compared["error"].abs().where(compared["set"] == "typical"),
        step_s=compared["wall_s"] / compared["steps"].clip(lower=1),
        failed=kinds == NO_ANSWER,
        wrong=kinds.isin((FALL, REST)),
    )
    groups = compared.groupby(KEY, sort=False)
    table = groups.agg(
        trap=("trap", "first"),
        cases=("outcome", "size"),
        failed=("failed", "sum"),
        wrong=("wrong", "sum"),
        median_error=("typical", "median"),
        max_error=("typical", "max"),
        moved=("moved", "max"),
        ratio_over_eta=("ratio_over_eta", "median"),
        newton_e=("newton_e", "median"),
        slip_widths=("slip_widths", "max"),
        sink_widths=("sink_widths", "max"),
        energy_drift=("energy_drift", "median"),
        energy_growth=("energy_growth", "max"),
        step_s=("step_s", "median"),
        message=("message", "max"),
    ).reset_index()
    first = table.groupby(["engine", "preset"])[["ratio_over_eta", "wrong"]].transform("first")
    return table.assign(
        ratio_moved=(table["ratio_over_eta"] / first["ratio_over_eta"] - 1.0).abs(),
        worse=(table["failed"] > 0) | (table["wrong"] > first["wrong"]),
    )


def variants_text(lines: pd.DataFrame) -> str:
    """Return all variants as an aligned table."""
    shown = pd.DataFrame(
        {
            "engine": lines["engine"],
            "from": lines["preset"],
            "variant": [name_of(line) for _, line in lines.iterrows()],
            "failed": lines["failed"],
            "wrong": lines["wrong"],
            "median": lines["median_error"].map(scientific),
            "max": lines["max_error"].map(scientific),
            "moves": lines["moved"].map(scientific),
            "η": lines["ratio_over_eta"].map("{:.4f}".format),
            "e": lines["newton_e"].map("{:.3f}".format),
            "slip": lines["slip_widths"].map(scientific),
            "sink": lines["sink_widths"].map(scientific),
            "drift": lines["energy_drift"].map(scientific),
            "step µs": (1e6 * lines["step_s"]).map("{:.1f}".format),
            "why": lines["message"].where(lines["failed"] > 0, lines["trap"]),
        }
    )
    return in_columns(shown.astype(str))


def recommendation(lines: pd.DataFrame) -> pd.DataFrame:
    """Return what to set, and the errors without it and with nothing else, by importance."""
    table = []
    for engine in lines["engine"].unique():
        naive = variant_of(lines, engine, DEFAULT, "")
        for factor in ENGINES[engine].factors:
            left = variant_of(lines, engine, BEST, factor.name, BY_DEFAULT)
            alone = variant_of(lines, engine, DEFAULT, factor.name, AS_BEST)
            if naive is None or alone is None:
                continue
            values = preset_values(engine, BEST, factor.settings)
            table.append(
                {
                    "engine": engine,
                    "set": ", ".join(f"{name} {value}" for name, value in values.items()),
                    "moves": math.nan if left is None else left["moved"],
                    "turns": math.nan if left is None else left["ratio_moved"],
                    "without": "-" if left is None else errors_of(left),
                    "defaults": _with_ratio(naive),
                    "alone": _with_ratio(alone),
                    "weight": _weight(left, alone),
                }
            )
    return pd.DataFrame(table).sort_values(
        ["engine", "weight"], ascending=[False, False], ignore_index=True
    )


def _with_ratio(line: pd.Series[Any]) -> str:
    ratio = float(line["ratio_over_eta"])
    return errors_of(line) + (f" ({ratio:.3f} η)" if math.isfinite(ratio) else "")


def _weight(*found: pd.Series[Any] | None) -> float:
    """Return by how much a setting matters: what it moves, all where it breaks something."""
    lines = [line for line in found if line is not None]
    if any(line["worse"] for line in lines):
        return math.inf
    return max(float(line[name]) for line in lines for name in ("moved", "ratio_moved"))


def recommendation_text(lines: pd.DataFrame) -> str:
    """Return the recommendation as an aligned table."""
    table = recommendation(lines)
    shown = pd.DataFrame(
        {
            "engine": table["engine"].mask(table["engine"].duplicated(), ""),
            "set": table["set"],
            "left at its default it moves a peak by": table["moves"].map(scientific),
            "a velocity ratio by": table["turns"].map(scientific),
            "and the largest error is": table["without"],
            "set alone, the defaults' largest error (ratio)": table["defaults"],
            "becomes": table["alone"],
        }
    )
    return in_columns(shown.astype(str))
