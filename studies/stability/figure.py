"""The matrix of extreme cases and methods: one mark for each verdict."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from studies.drawing.styles import name_of
from studies.measures.verdicts import ACCEPTED, Verdict


@dataclass(frozen=True, slots=True)
class Mark:
    """Colour of a cell, its symbol, the symbol's colour, and the cell's hatching."""

    colour: str
    symbol: str
    ink: str = "#000000"
    hatch: str = ""


# the palette of Okabe and Ito; no two verdicts share a symbol
MARKS = {
    Verdict.GOOD: Mark("#B5E0D3", "✓"),
    Verdict.UNSEEN: Mark("#E3F3EE", "·"),
    Verdict.COARSE: Mark("#F7EE8A", "~"),
    Verdict.OFF: Mark("#F2B33D", "≠"),
    Verdict.SLIDES: Mark("#E3B3CE", "→"),
    Verdict.ENERGY: Mark("#56A0D3", "↑"),
    Verdict.FALL: Mark("#D55E00", "✗", "#FFFFFF"),
    Verdict.REST: Mark("#8B5A3C", "–", "#FFFFFF"),
    Verdict.FAILED: Mark("#222222", "!", "#FFFFFF"),
    Verdict.INVALID: Mark("#FFFFFF", "○", "#555555", "////"),
}

WORDS = {
    "onset − 1e-6": "pulse 1e-6 below the onset",
    "onset + 1e-6": "pulse 1e-6 above the onset",
    "boundary − 1e-6": "1e-6 below overturning",
    "boundary + 1e-6": "1e-6 above overturning",
    "boundary after impact − 1e-6": "the same after an impact, below",
    "boundary after impact + 1e-6": "the same after an impact, above",
    "ω/p 0.01": "slow pulse, ω/p 0.01",
    "ω/p 0.01, over": "the same, overturning",
    "ω/p 10": "fast pulse, ω/p 10",
    "ω/p 100": "ω/p 100",
    "H/B 20": "slender, H/B 20",
    "H/B 1": "squat, H/B 1",
    "60 s at rest": "pulse too weak, 60 s at rest",
    "density 1e-6": "density 1e-6 of water's",
    "density 1e9": "density 1e9 of water's",
    "contact of 0.1/p": "soft contact, time 0.1/p",
    "contact of 0.01/p": "contact time 0.01/p",
    "contact of 1e-3/p": "contact time 1e-3/p",
    "contact of 1e-5/p": "stiff contact, time 1e-5/p",
}
"""Name of a case -> what stands beside its row, where the name needs words."""
MANY = 14
"""More methods than this leave no room for the size of errors in the cells."""


def draw_matrix(rows: pd.DataFrame) -> Figure:
    """Draw the cases as rows and the methods as columns.

    Parameters
    ----------
    rows : DataFrame
        The columns of stability.csv.
    """
    cases = rows[["group", "case"]].drop_duplicates()
    names, sources = list(cases["case"]), list(rows["source"].unique())
    many = len(sources) > MANY
    each = 0.3 if many else 0.5
    width, height = 3.0 + each * len(sources) + 2.2, 0.235 * len(names) + 3.6
    drawing = Figure(figsize=(max(width, 7.5), height), layout="constrained")
    axes = drawing.subplots()
    for row in rows.itertuples():
        place = (sources.index(str(row.source)), names.index(str(row.case)))
        _cell(axes, place, Verdict(row.verdict), math.nan if many else float(str(row.error)))
    _label_methods(axes, sources)
    _label_cases(axes, rows, names)
    _separate_groups(axes, list(cases["group"]), len(sources))
    _score(axes, rows, sources, len(names))
    axes.set(xlim=(0, len(sources)), ylim=(len(names) + 1, 0))
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    drawing.suptitle("Extreme cases: what each method's answer is worth", fontsize=12)
    _legend(drawing, {Verdict(value) for value in rows["verdict"]}, many)
    return drawing


def _cell(axes: Axes, place: tuple[int, int], verdict: Verdict, error: float) -> None:
    mark, (i, j) = MARKS[verdict], place
    look = {"facecolor": mark.colour, "edgecolor": "#cccccc", "hatch": mark.hatch}
    axes.add_patch(Rectangle((i, j), 1, 1, linewidth=0.0, **look))  # type: ignore[arg-type]
    axes.add_patch(Rectangle((i, j), 1, 1, fill=False, edgecolor="white", linewidth=1.2))
    exponent = _exponent(error)
    style = {"ha": "center", "va": "center_baseline", "color": mark.ink}
    axes.text(i + (0.3 if exponent else 0.5), j + 0.52, mark.symbol, fontsize=10, **style)  # type: ignore[arg-type]
    if exponent:
        axes.text(i + 0.68, j + 0.53, exponent, fontsize=7, **style)  # type: ignore[arg-type]


def _exponent(error: float) -> str:
    """Return the size of an error as a power of ten, rounded up; empty if there is none."""
    if math.isnan(error) or error == 0.0:
        return ""
    return f"1e{max(math.ceil(math.log10(abs(error))), -16):d}"


def _label_methods(axes: Axes, sources: list[str]) -> None:
    axes.xaxis.tick_top()
    labels = [name_of(source).replace("average-acc", "average-\nacc") for source in sources]
    turned = 70 if len(sources) > MANY else 40
    axes.set_xticks([i + 0.5 for i in range(len(sources))], labels, fontsize=8)
    for label in axes.get_xticklabels():
        label.set(rotation=turned, ha="left", rotation_mode="anchor", linespacing=0.9)


def _label_cases(axes: Axes, rows: pd.DataFrame, names: list[str]) -> None:
    words = [WORDS.get(name, name) for name in names]
    axes.set_yticks([j + 0.5 for j in range(len(names))], words, fontsize=8.5)
    first = rows.drop_duplicates("case")
    exact = [
        _reference(str(outcome), float(peak))
        for outcome, peak in zip(first["exact_outcome"], first["exact_peak"], strict=True)
    ]
    right = axes.secondary_yaxis("right")
    right.set_yticks(
        [j + 0.5 for j in range(len(names))],
        exact,
        fontsize=7.5,
        color="#555555",
    )
    right.tick_params(length=0)
    right.spines["right"].set_visible(False)
    axes.text(1.02, 1.005, "exact peak", transform=axes.transAxes, fontsize=7.5, color="#555555")


def _reference(outcome: str, peak: float) -> str:
    return f"{peak:.3g} θcr" if outcome == "rocked" else outcome


def _score(axes: Axes, rows: pd.DataFrame, sources: list[str], level: int) -> None:
    """Write under each method how many of its cases are right, of those that are valid."""
    style = {"va": "center", "fontsize": 8, "color": "#333333"}
    axes.text(-0.08, level + 0.6, "right, of the valid", ha="right", **style)  # type: ignore[arg-type]
    for i, source in enumerate(sources):
        found = [Verdict(value) for value in rows.loc[rows["source"] == source, "verdict"]]
        valid = [verdict for verdict in found if verdict is not Verdict.INVALID]
        right = sum(verdict in ACCEPTED for verdict in valid)
        score = f"{right}/{len(valid)}" if len(sources) <= MANY else f"{right}\n{len(valid)}"
        axes.text(i + 0.5, level + 0.6, score, ha="center", linespacing=0.9, **style)  # type: ignore[arg-type]


def _separate_groups(axes: Axes, groups: list[str], width: int) -> None:
    for j, (before, after) in enumerate(itertools.pairwise(groups), start=1):
        if before != after:
            axes.plot([-0.2, width + 0.2], [j, j], color="#666666", linewidth=0.8, clip_on=False)


def _legend(drawing: Figure, present: set[Verdict], many: bool) -> None:
    handles = [
        Patch(
            facecolor=mark.colour,
            edgecolor="#888888",
            hatch=mark.hatch,
            label=f"{mark.symbol}  {verdict.sentence}",
        )
        for verdict, mark in MARKS.items()
        if verdict in present
    ]
    handles.append(Patch(facecolor="white", edgecolor="#888888", label="    does not apply"))
    if not many:
        handles.append(Patch(alpha=0.0, label="1e-3  error of the peak below"))
    drawing.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
