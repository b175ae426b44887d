"""What an overturning map says: who differs from the exact solution, and where.

Thresholds are held against closed forms and against the literature. What could be read of it is
its formulas as later papers and `analytic.criteria` quote them. The tables and figures of Makris
and Roussos (2000) and of Zhang and Makris (2001) could not be read, so no number of theirs stands
here.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pandas as pd

from analytic.block import RigidBlock
from analytic.criteria import overturning_amplitude, overturning_velocity
from analytic.maps import overturning_modes
from analytic.models import MODELS
from analytic.motion import FloatArray
from analytic.response import Outcome
from studies.cases.window import LEAST_ONSETS, Window
from studies.drawing.kept import tell
from studies.old import provenance
from studies.old.tables import table_in, write_table
from studies.measures.presets import in_order, in_words, preset_of
from studies.measures.words import between, listed, part
from studies.measures.wrongness import FALL, NO_ANSWER, REST, kinds_of
from studies.overturning import STUDY

NAMES = dict(
    enumerate(("survives", "no_impact", "after_1", "after_2", "after_3", "after_more"), -1)
)
"""Modes of overturning."""

DIFFERENCES = (
    *("source", "false", "missed", "other_mode", "cells", REST, NO_ANSWER),
    *("false_from", "false_to", "missed_from", "missed_to"),
)
"""Columns of differences.csv."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's tables; write and return what they show."""
    window, areas = window_of(folder), table_in(folder, "map")
    compared, checked = differences(areas, table_in(folder, "engines"), window), checks(window)
    write_table(folder / "checks.csv", checked)
    if len(compared):
        write_table(folder / "differences.csv", compared)
    shown, of_models = compared.astype({"cells": "Int64"}), compared["cells"].isna()
    tables = {
        f"Parts of the map by the impacts after which a block overturns, {window.title}": (
            modes(areas, window)
        ),
        "Parts of the map that a model gets wrong, and where nine tenths of each lie": (
            shown[of_models].dropna(axis=1, how="all")
        ),
        "Parts of the cells of a coarse grid that an engine gets wrong": (
            shown[~of_models].dropna(axis=1, how="all")
        ),
        "Edges of each model, and by what they were found": (
            edges(table_in(folder, "boundaries"), list(areas["model"].unique()))
        ),
        "Parts of an engine's outcomes that are right, by the relative distance from an edge": (
            beside_edges(table_in(folder, "edges"))
        ),
        "Thresholds of an engine over the exact ones, less 1, where they are within 3 %": (
            shifts(table_in(folder, "thresholds"))
        ),
        "Thresholds over those of closed forms and the literature, less 1": apart(checked),
    }
    return tell(STUDY, folder, tables)


def finding(lines: pd.DataFrame) -> str:
    """Say how much of the map the linearizations get wrong, and how many cells engines do."""
    if lines.empty:
        return "The exact map stands alone: no other source was asked."
    models, engines = lines[lines["cells"].isna()], lines[lines["cells"].notna()]
    shares = [
        f"{row['source']} {part(row['false'] + row['missed'])}" for _, row in models.iterrows()
    ]
    words = f"Of an overturning map is wrong: {listed(shares)}"
    if engines.empty:
        return f"{words}."
    # the falls are parts of the map, the other kinds are counts
    falls = (engines["cells"] * (engines["false"] + engines["missed"])).round()
    engines, presets = engines.assign(**{FALL: falls}), engines["source"].map(preset_of)
    cells = []
    for name in in_order(presets):
        group = engines[presets == name]
        cells.append(f"{in_words(name)} {between(group, group['source'])}")
    return f"{words}. Of {engines['cells'].max():.0f} cells of a coarse grid: {'; '.join(cells)}."


def differences(areas: pd.DataFrame, engines: pd.DataFrame, window: Window) -> pd.DataFrame:
    """Return the columns of differences.csv: the parts in which each source is not as exact.

    Of models parts of the area, exact in the amplitude, from the intervals; the mean over the
    columns in the abscissa. Of engines parts of the cells; their runs end when the outcome is
    decided, so their number of impacts is not held against the mode.
    """
    exact = areas.loc[areas["model"] == "exact", ["x", "low", "mode"]]
    others = areas[areas["model"] != "exact"].groupby("model", sort=False)
    rows = [{"source": model, **_of_model(exact, area, window)} for model, area in others]
    if len(engines):
        cells = with_verdicts(engines, window).groupby("source", sort=False)["verdict"]
        rows += [{"source": source, **_of_engine(verdict)} for source, verdict in cells]
    return pd.DataFrame(rows, columns=DIFFERENCES)


def _of_model(exact: pd.DataFrame, area: pd.DataFrame, window: Window) -> dict[str, float]:
    both = exact.merge(area[["x", "low", "mode"]], on=["x", "low"], how="outer")
    column = both.groupby("x")
    right, found = (column[f"mode_{side}"].ffill() for side in "xy")
    length = column["low"].shift(-1).fillna(window.onsets) - both["low"]
    where = {
        "false": (right < 0) & (found >= 0),
        "missed": (right >= 0) & (found < 0),
        "other_mode": (right >= 0) & (found >= 0) & (right != found),
    }
    whole = window.onsets - LEAST_ONSETS
    lengths = pd.DataFrame({kind: length.where(at, 0.0) for kind, at in where.items()})
    shares = lengths.groupby(both["x"]).sum()
    return {
        **dict(zip(where, np.ascontiguousarray(shares).mean(axis=0) / whole, strict=True)),
        **{"cells": math.nan, REST: 0, NO_ANSWER: 0},
        **{
            f"{kind}_{end}": _reached(shares[kind], share)
            for kind in ("false", "missed")
            for end, share in (("from", 0.05), ("to", 0.95))
        },
    }


def _reached(weights: pd.Series[float], share: float) -> float:
    """Return the abscissa up to which a part of the weights lies; nan without any."""
    total = weights.cumsum().to_numpy()
    place = np.searchsorted(total, share * total[-1])
    return float(weights.index[place]) if total[-1] > 0.0 else math.nan


def _of_engine(verdict: pd.Series[str]) -> dict[str, float]:
    return {
        **{kind: float((verdict == kind).mean()) for kind in ("false", "missed")},
        **{"other_mode": math.nan, "cells": len(verdict)},
        **{kind: int((verdict == kind).sum()) for kind in (REST, NO_ANSWER)},
    }


def modes(areas: pd.DataFrame, window: Window) -> pd.DataFrame:
    """Return the part of the area of each mode, a row a model."""
    whole = areas["x"].nunique() * (window.onsets - LEAST_ONSETS)
    parts = areas.assign(
        mode=areas["mode"].clip(-1, 4), part=(areas["high"] - areas["low"]) / whole
    )
    table = parts.pivot_table("part", "model", "mode", aggfunc="sum", fill_value=0.0)
    return table.rename(columns=NAMES).reset_index()


def edges(found: pd.DataFrame, models: list[str]) -> pd.DataFrame:
    """Return how many edges each model has, how wide at most, and how many each search found.

    An edge between two modes is an island too narrow to be seen.
    """
    islands = (found["below"] >= 0) & (found["above"] >= 0)
    each = found.assign(width=found["high"] - found["low"], islands=islands).groupby("model")
    table = each.agg(edges=("low", "size"), width=("width", "max"), islands=("islands", "sum"))
    counts = pd.crosstab(found["model"], found["found"])
    return table.join(counts).reindex(models, fill_value=0).reset_index()


def beside_edges(cases: pd.DataFrame) -> pd.DataFrame:
    """Return the part of each engine's outcomes that are right at each distance from an edge."""
    if cases.empty:
        return cases
    above = (cases["offset"] > 0.0) == (cases["overturns"] == "above")
    right = (cases["outcome"] == "overturned") == above
    distance = cases["offset"].abs().map("{:g}".format)
    return right.groupby([cases["source"], distance], sort=False).mean().unstack().reset_index()


def shifts(thresholds: pd.DataFrame) -> pd.DataFrame:
    """Return how many of each engine's thresholds were found, and how far from the exact ones."""
    if thresholds.empty:
        return thresholds
    found = thresholds["shift"].abs().groupby(thresholds["source"], sort=False)
    return found.agg(asked="size", found="count", median="median", largest="max").reset_index()


def apart(checked: pd.DataFrame) -> pd.DataFrame:
    """Return the least and the largest difference from each thing that is held against."""
    off = (checked["found"] / checked["expected"] - 1.0).groupby(checked["against"], sort=False)
    return off.agg(thresholds="size", least="min", largest="max").reset_index()


def window_of(folder: Path) -> Window:
    """Return the window that a folder's map is of, from its provenance."""
    return Window(**provenance.record_of(folder)["settings"]["window"])


def modes_at(areas: pd.DataFrame, x: FloatArray, onsets: FloatArray) -> FloatArray:
    """Return the modes of a model's map on a grid.

    Parameters
    ----------
    areas : DataFrame
        The model's lines of map.csv: x, low and mode of each interval.
    x : ndarray (n,)
        Abscissae; the nearest column of the map stands for each.
    onsets : ndarray (m,)
        Amplitudes over g tan(alpha).

    Returns
    -------
    ndarray (n, m)
        As of `analytic.maps.Modes`.
    """
    groups = {float(str(at)): group for at, group in areas.groupby("x")}
    known = np.array(sorted(groups))
    found = np.empty((len(x), len(onsets)))
    for i, at in enumerate(x):
        group = groups[float(known[np.argmin(abs(known - at))])]
        place = np.searchsorted(group["low"].to_numpy(), onsets, side="right") - 1
        found[i] = group["mode"].to_numpy()[np.maximum(place, 0)]
    return found


def with_verdicts(engines: pd.DataFrame, window: Window) -> pd.DataFrame:
    """Hold the outcomes of engines on a map against the exact ones.

    Parameters
    ----------
    engines : DataFrame
        Lines of engines.csv: x, onsets and outcome of each cell.
    window : Window

    Returns
    -------
    DataFrame
        With exact_mode and verdict: right, missed or false (of an overturning), or the kind REST or
        NO_ANSWER.
    """
    mode = window.modes(engines["x"].to_numpy(), engines["onsets"].to_numpy()).mode
    # no pulse of the map is too weak to lift the block
    right = np.where(mode >= 0, Outcome.OVERTURNED.value, Outcome.ROCKED.value)
    wrong = kinds_of(engines["outcome"], right)
    verdict = np.where(wrong == FALL, np.where(mode >= 0, "missed", "false"), wrong)
    verdict = np.where(wrong == "", "right", verdict)
    return engines.assign(exact_mode=mode, verdict=verdict)


def no_impact_line(x: FloatArray, window: Window, model: str) -> FloatArray:
    """Return the least amplitudes that overturn a linearized block without an impact.

    By the closed form of `analytic.criteria.overturning_amplitude`.

    Parameters
    ----------
    x : ndarray (n,)
        Abscissae of the map.
    window : Window
    model : str
        A linear one of `analytic.MODELS`.

    Returns
    -------
    ndarray (n,)
        Over g tan(alpha); nan where no amplitude overturns it so.

    Raises
    ------
    KeyError
        If there is no such model.
    """
    line = np.full(len(x), math.nan)
    for i, (alpha, ratio) in enumerate(zip(window.alpha(x), window.ratio(x), strict=True)):
        law = MODELS[model].law(float(alpha), 0.9)
        try:
            amplitude = overturning_amplitude(float(ratio) / law.k, window.half_cycles)
        except ValueError:
            continue
        line[i] = amplitude * law.onset / math.tan(alpha)
    return line


HOUSNER_1963 = "Housner (1963): sqrt(1 + (ω/p)²), which drops the exponential"
CRITERION = "the criterion with the exponential (Shi and others 1996, Makris and Roussos 2000)"
VELOCITY = "one velocity step, 4 R p sqrt(2 (1 - cos α)) / (3 cos α)"
RATIOS = (1.0, 2.0, 4.0, 8.0)
SHORT = 1e5
"""ω/p of a pulse that is short beside the block's own time."""


def threshold(overturns: Callable[[float], bool], low: float, high: float) -> float:
    """Return where a monotone outcome changes, by bisection to rounding."""
    while high - low > 4e-16 * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (low, middle) if overturns(middle) else (middle, high)
    return high


def checks(window: Window) -> pd.DataFrame:
    """Return the checks: what was found, the value and the source that it is held against.

    At the slenderness of the middle of the window.
    """
    middle = np.array(0.5 * (window.low + window.high))
    alpha = float(window.alpha(middle))
    linear = [name for name, model in MODELS.items() if model.linear]
    posed = itertools.product((1, 2), linear, RATIOS)
    rows = [without_impact(model, alpha, ratio, cycles) for cycles, model, ratio in posed]
    return pd.DataFrame([*rows, *map(housner, RATIOS), short_pulse(alpha)])


def without_impact(model: str, alpha: float, ratio: float, half_cycles: int) -> dict[str, object]:
    """Return the threshold of overturning without impact, over the onset, and the criterion."""
    law = MODELS[model].law(alpha, 0.9)
    expected = overturning_amplitude(ratio / law.k, half_cycles)

    def overturns(onsets: float) -> bool:
        amplitude = onsets * law.onset
        return bool(overturning_modes(alpha, amplitude, ratio, half_cycles, model).mode == 0)

    found = threshold(overturns, expected * 0.99, expected * 1.01)
    pulse = "half-sine" if half_cycles == 1 else "full-sine"
    name = f"{model}, {pulse}, ω/p = {ratio:g}, no impact, over the onset"
    return {"check": name, "found": found, "against": CRITERION, "expected": expected}


def housner(ratio: float) -> dict[str, object]:
    """Return Housner's linearization under a half-sine, beside Housner's own formula."""
    alpha = 0.1
    expected = math.hypot(1.0, ratio)

    def overturns(onsets: float) -> bool:
        return bool(overturning_modes(alpha, onsets * alpha, ratio, 1, "housner").mode >= 0)

    found = threshold(overturns, 1.0, expected * 1.01)
    name = f"housner, half-sine, ω/p = {ratio:g}, over the onset"
    return {"check": name, "found": found, "against": HOUSNER_1963, "expected": expected}


def short_pulse(alpha: float) -> dict[str, object]:
    """Return the velocity 2 a_p/ω of the least short half-sine that overturns the exact block."""
    block = RigidBlock(width=math.sin(alpha), height=math.cos(alpha))
    expected = overturning_velocity(block)

    def overturns(velocity: float) -> bool:
        amplitude = 0.5 * velocity * SHORT * block.p / block.gravity
        return bool(overturning_modes(alpha, amplitude, SHORT, 1).mode == 0)

    found = threshold(overturns, 0.5 * expected, 2.0 * expected)
    name = f"exact, half-sine, ω/p = {SHORT:g}, its velocity [m/s]"
    return {"check": name, "found": found, "against": VELOCITY, "expected": expected}
