"""What an overturning map says: who differs from the exact solution, and where; as text."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.motion import FloatArray
from studies.cases.window import LEAST_ONSETS, Window
from studies.drawing.kept import Pictures, keep
from studies.kit.tables import write_table
from studies.measures.differences import scientific
from studies.measures.words import gathered, in_kinds, listed, part
from studies.measures.wrongness import FALL, NO_ANSWER, REST
from studies.overturning.areas import read, window_of, with_verdicts
from studies.overturning.checks import checks


def report(folder: Path) -> str:
    """Reduce and draw a folder's tables; return the summary and the findings as text."""
    window = window_of(folder)
    areas = read(folder, "map")
    engines = read(folder, "engines")
    differences = pd.DataFrame(
        [*model_differences(areas, window), *engine_differences(engines, window)]
    )
    checked = checks(window)
    if len(differences):
        write_table(folder / "differences.csv", differences)
    write_table(folder / "checks.csv", checked)
    text = "\n".join(
        [
            f"Overturning map: {window.title}; parts of the area of the map, exact mode by mode:",
            modes_text(areas, window),
            "\nAgainst the exact solution, parts of the area (engines: of the cells of a coarse",
            "grid): false overturning, missed overturning, overturning after other impacts; and",
            "between which abscissae nine tenths of each lie:",
            differences_text(differences),
            "\nEdges of the models:",
            edges_text(read(folder, "boundaries"), list(areas["model"].unique())),
            *engine_text(read(folder, "edges"), read(folder, "thresholds")),
            "\nChecks against closed forms and the literature:",
            checks_text(checked),
        ]
    )
    return keep(folder, pictures(folder), text)


def pictures(folder: Path) -> Pictures:
    """Draw the figures of a folder from its CSVs alone."""
    from studies.overturning.figure import draw_conditioning, draw_differences, draw_map

    areas, engines = read(folder, "map"), read(folder, "engines")
    window = window_of(folder)
    drawn = {
        "map": draw_map(areas, window),
        "conditioning": draw_conditioning(read(folder, "conditioning"), window),
    }
    if len(areas["model"].unique()) > 1 or len(engines):
        drawn["differences"] = draw_differences(areas, engines, window)
    return drawn


def headline(folder: Path) -> str:
    """Say how much of the map the linearizations get wrong, and how many cells engines do."""
    lines = read(folder, "differences")
    models, engines = lines[lines["cells"].isna()], lines[lines["cells"].notna()]
    shares = [
        f"{row['source']} {part(row['false'] + row['missed'])}" for _, row in models.iterrows()
    ]
    words = f"Of an overturning map is wrong: {listed(shares)}"
    if engines.empty:
        return f"{words}."
    cells = ((row["source"], in_kinds(_kinds(row))) for _, row in engines.iterrows())
    return f"{words}. Of {engines['cells'].max():.0f} cells of a coarse grid: {gathered(cells)}."


def _kinds(line: pd.Series[Any]) -> dict[str, int]:
    """Return how many cells an engine gets wrong of each kind; the falls are parts of the map."""
    fall = round(float(line["cells"]) * float(line["false"] + line["missed"]))
    return {FALL: fall, REST: int(line[REST]), NO_ANSWER: int(line[NO_ANSWER])}


def model_differences(areas: pd.DataFrame, window: Window) -> list[dict[str, object]]:
    """Return the parts of the area in which each model differs from the exact one.

    Exact in the amplitude, from the intervals; the mean over the columns in the abscissa.
    """
    exact = dict(iter(areas[areas["model"] == "exact"].groupby("x")))
    rows: list[dict[str, object]] = []
    for model, area in areas.groupby("model", sort=False):
        if model == "exact":
            continue
        x = np.unique(area["x"])
        shares = np.array([_compare(exact[at], group) for at, group in area.groupby("x")])
        false, missed, other = shares.mean(axis=0) / (window.onsets - LEAST_ONSETS)
        counts = {"source": model, "false": false, "missed": missed, "other_mode": other}
        places = {
            f"{name}_{end}": _quantile(x, shares[:, i], share)
            for i, name in enumerate(("false", "missed"))
            for end, share in (("from", 0.05), ("to", 0.95))
        }
        rows.append({**counts, "cells": math.nan, REST: 0, NO_ANSWER: 0, **places})
    return rows


def _quantile(x: FloatArray, weights: FloatArray, part: float) -> float:
    """Return the abscissa up to which a part of the weights lies; nan without any."""
    total = np.cumsum(weights)
    return float(x[np.searchsorted(total, part * total[-1])]) if total[-1] > 0.0 else math.nan


def _compare(exact: pd.DataFrame, model: pd.DataFrame) -> tuple[float, float, float]:
    """Return the lengths of amplitude of a column in which a model is false, misses, differs."""
    ends = np.unique(np.concatenate([exact["low"], model["low"], exact["high"]]))
    middle, length = 0.5 * (ends[1:] + ends[:-1]), np.diff(ends)
    right, found = (
        part["mode"].to_numpy()[np.searchsorted(part["low"].to_numpy(), middle, "right") - 1]
        for part in (exact, model)
    )
    false = (right < 0) & (found >= 0)
    missed = (right >= 0) & (found < 0)
    other = (right >= 0) & (found >= 0) & (right != found)
    return tuple(float(length[where].sum()) for where in (false, missed, other))  # type: ignore[return-value]


def engine_differences(engines: pd.DataFrame, window: Window) -> list[dict[str, object]]:
    """Return the parts of the cells in which each engine differs from the exact solution.

    An engine's run ends when its outcome is decided, so its number of impacts is not held against
    the mode.
    """
    if not len(engines):
        return []
    compared = with_verdicts(engines, window)
    return [
        {
            "source": source,
            "false": float((group["verdict"] == "false").mean()),
            "missed": float((group["verdict"] == "missed").mean()),
            "other_mode": math.nan,
            "cells": len(group),
            **{kind: int((group["verdict"] == kind).sum()) for kind in (REST, NO_ANSWER)},
        }
        for source, group in compared.groupby("source", sort=False)
    ]


def modes_text(areas: pd.DataFrame, window: Window) -> str:
    """Return the part of the area of each mode as an aligned table, a row a model."""
    length = (areas["high"] - areas["low"]) / (window.onsets - LEAST_ONSETS)
    mode = areas["mode"].clip(-1, 4).map(lambda m: NAMES.get(int(m), "after 4 or more"))
    total = areas["x"].nunique()
    table = areas.assign(length=length, name=mode).pivot_table(
        index="model", columns="name", values="length", aggfunc="sum", sort=False
    )
    names = [name for name in (*NAMES.values(), "after 4 or more") if name in table]
    return (table[names].fillna(0.0) / total).to_string(float_format="{:.4f}".format)


NAMES = {-1: "survives", 0: "no impact", 1: "after 1", 2: "after 2", 3: "after 3"}
"""Modes of overturning."""


def differences_text(differences: pd.DataFrame) -> str:
    """Return the differences as an aligned table."""
    if not len(differences):
        return "  no other source"
    shown = differences.copy()
    for name in ("false", "missed", "other_mode"):
        shown[name] = shown[name].map(lambda share: "-" if math.isnan(share) else f"{share:.4%}")
    for name in ("false_from", "false_to", "missed_from", "missed_to"):
        if name in shown:
            shown[name] = shown[name].map(lambda x: "-" if math.isnan(x) else f"{x:.2f}")
    shown["cells"] = shown["cells"].map(lambda count: "-" if math.isnan(count) else f"{count:.0f}")
    return shown.to_string(index=False)


def edges_text(edges: pd.DataFrame, models: Sequence[str]) -> str:
    """Return how many edges each model has, and how they were found."""
    lines = []
    for model in models:
        group = edges[edges["model"] == model]
        if not len(group):
            lines.append(f"  {model}: none")
            continue
        found = group["found"].value_counts()
        direct = int(((group["below"] >= 0) & (group["above"] >= 0)).sum())
        width = (group["high"] - group["low"]).max()
        between, inside = found.get("mode", 0), found.get("margin", 0)
        lines.append(
            f"  {model}: {len(group)} within {width:.1e}; {between} by a change of the mode and "
            f"{inside} by the margin between neighbours of the grid; {direct} narrower islands"
        )
    return "\n".join(lines)


def engine_text(edges: pd.DataFrame, thresholds: pd.DataFrame) -> list[str]:
    """Return what the engines say beside the exact edges, as lines."""
    if not len(edges):
        return []
    over = (edges["outcome"] == "overturned").to_numpy()
    expected = (edges["offset"] > 0.0) == (edges["overturns"] == "above")
    marked = edges.assign(right=over == expected, distance=edges["offset"].abs())
    table = marked.pivot_table(index="source", columns="distance", values="right", sort=False)
    lines = [
        "\nEngines beside exact edges: parts of the outcomes that are right, by relative distance:",
        table.to_string(float_format="{:.3f}".format),
        "\nThresholds of the engines, relative to the exact ones:",
    ]
    for source, group in thresholds.groupby("source", sort=False):
        shifts = group["shift"].dropna().abs()
        lost = f", {len(group) - len(shifts)} not within 3 %" if len(shifts) < len(group) else ""
        if len(shifts):
            lines.append(
                f"  {source}: median {scientific(float(shifts.median()))}, largest "
                f"{scientific(float(shifts.max()))} of {len(shifts)}{lost}"
            )
        else:
            lines.append(f"  {source}: none of {len(group)} within 3 %")
    return lines


def checks_text(checked: pd.DataFrame) -> str:
    """Return the checks as lines, a line for each thing that they are held against."""
    lines = []
    apart = checked["found"] / checked["expected"] - 1.0
    for against, group in checked.assign(apart=apart).groupby("against", sort=False):
        parts = ", ".join(scientific(part) for part in group["apart"])
        worst = scientific(float(group["apart"].abs().max()))
        several = f"{len(group)} thresholds, within {worst}" if len(group) > 4 else parts
        lines.append(f"  {against}: {several}")
    return "\n".join(lines)
