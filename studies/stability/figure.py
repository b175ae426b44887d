"""The matrix of extreme cases and methods: one mark for each verdict."""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from studies.drawing.facets import key
from studies.drawing.styles import name_of
from studies.measures.presets import in_order, in_words
from studies.measures.verdicts import ACCEPTED, Verdict
from studies.stability.study import scores


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
    """Draw the cases as rows and the methods as columns."""
    cases, sources = rows.drop_duplicates("case"), list(rows["source"].unique())
    names = list(cases["case"])
    many = len(sources) > MANY
    width, height = 5.2 + (0.3 if many else 0.5) * len(sources), 0.235 * len(names) + 3.6
    drawing = Figure(figsize=(max(width, 7.5), height), layout="constrained")
    axes = drawing.subplots()
    for row in rows.itertuples():
        place = (sources.index(str(row.source)), names.index(str(row.case)))
        _cell(axes, place, Verdict(row.verdict), math.nan if many else float(str(row.error)))
    _label_methods(axes, rows, sources, len(names))
    _label_cases(axes, cases)
    for j, (before, after) in enumerate(itertools.pairwise(cases["group"]), start=1):
        if before != after:
            axes.plot([-0.2, len(sources) + 0.2], [j, j], color="#666666", lw=0.8, clip_on=False)
    axes.set(xlim=(0, len(sources)), ylim=(len(names) + 1, 0))
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
    drawing.suptitle(_message(rows), fontsize=12)
    handles = [
        Patch(fc=mark.colour, ec="#888888", hatch=mark.hatch,
              label=f"{mark.symbol}  {verdict.sentence}")
        for verdict, mark in MARKS.items()
        if verdict.value in set(rows["verdict"])
    ]  # fmt: skip
    handles.append(Patch(fc="white", ec="#888888", label="    does not apply"))
    if not many:
        handles.append(Patch(alpha=0.0, label="1e-3  error of the peak below"))
    key(drawing, handles, 3, fontsize=8)
    return drawing


def _cell(axes: Axes, place: tuple[int, int], verdict: Verdict, error: float) -> None:
    mark, (i, j) = MARKS[verdict], place
    axes.add_patch(Rectangle(place, 1, 1, lw=0.0, fc=mark.colour, ec="#cccccc", hatch=mark.hatch))
    axes.add_patch(Rectangle(place, 1, 1, fill=False, ec="white", lw=1.2))
    sized = abs(error) > 0.0
    axes.text(i + (0.3 if sized else 0.5), j + 0.52, mark.symbol, fontsize=10, ha="center",
              va="center_baseline", color=mark.ink)  # fmt: skip
    if sized:
        size = f"1e{max(math.ceil(math.log10(abs(error))), -16):d}"
        axes.text(i + 0.68, j + 0.53, size, fontsize=7, ha="center", va="center_baseline",
                  color=mark.ink)  # fmt: skip


def _label_methods(axes: Axes, rows: pd.DataFrame, sources: list[str], level: int) -> None:
    """Name each method above its cases; write below how many are right, of those valid."""
    axes.xaxis.tick_top()
    labels = [name_of(source).replace("average-acc", "average-\nacc") for source in sources]
    axes.set_xticks([i + 0.5 for i in range(len(sources))], labels, fontsize=8, ha="left",
                    rotation=70 if len(sources) > MANY else 40, rotation_mode="anchor",
                    linespacing=0.9)  # fmt: skip
    valid = rows["verdict"] != Verdict.INVALID.value
    right = rows["verdict"].isin([verdict.value for verdict in ACCEPTED]) & valid
    score: dict[str, Any] = {"va": "center", "fontsize": 8, "color": "#333333", "linespacing": 0.9}
    axes.text(-0.08, level + 0.6, "right, of the valid", ha="right", **score)
    between = "\n" if len(sources) > MANY else "/"
    for i, source in enumerate(sources):
        mine = rows["source"] == source
        text = f"{(right & mine).sum()}{between}{(valid & mine).sum()}"
        axes.text(i + 0.5, level + 0.6, text, ha="center", **score)


def _label_cases(axes: Axes, cases: pd.DataFrame) -> None:
    places = [j + 0.5 for j in range(len(cases))]
    axes.set_yticks(places, [WORDS.get(name, name) for name in cases["case"]], fontsize=8.5)
    exact = [
        f"{peak:.3g} θcr" if outcome == "rocked" else outcome
        for outcome, peak in zip(cases["exact_outcome"], cases["exact_peak"], strict=True)
    ]
    right = axes.secondary_yaxis("right")
    right.set_yticks(places, exact, fontsize=7.5, color="#555555")
    right.tick_params(length=0)
    right.spines["right"].set_visible(False)
    axes.text(1.02, 1.005, "exact peak", transform=axes.transAxes, fontsize=7.5, color="#555555")


def _message(rows: pd.DataFrame) -> str:
    """Say how many valid cases engines get right as they come and at best."""
    found = scores(rows).groupby("preset")[["right", "valid"]].sum()
    if found.empty:
        return "Extreme cases: what each method's answer is worth"
    names = in_order(found.index)
    words = [
        f"{in_words(name)} {found['right'][name]} of {found['valid'][name]}"
        for name in dict.fromkeys((names[0], names[-1]))
    ]
    return f"Of engines' answers to extreme cases are right: {', '.join(words)}"
