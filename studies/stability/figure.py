"""The matrix of extreme cases and methods: one mark for each verdict."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from studies.drawing.facets import key
from studies.drawing.styles import engine_title
from studies.measures.presets import in_order, in_words, preset_of, told
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
NAMES_PT = 72.0
"""Height that the names of methods take above their cases [points]."""
ACROSS = 22
"""Methods side by side at most; more stand in a panel below."""

MANY = 14
"""More methods than this leave no room for the size of errors in the cells."""


def draw_matrix(rows: pd.DataFrame) -> Figure:
    """Draw the cases as rows and the methods as columns, those of a preset side by side."""
    many = rows["source"].nunique() > MANY
    groups = _groups(rows["source"].unique())
    cases = rows.drop_duplicates("case")
    most = max(sum(map(len, panel.values())) for panel in groups)
    width, height = 4.2 + (0.3 if many else 0.5) * most, 0.235 * len(cases) + 1.7
    size = max(width, 7.5), height * len(groups) + 1.5
    drawing = Figure(figsize=size, layout="constrained")
    for axes, panel in zip(drawing.subplots(len(groups), squeeze=False).flat, groups, strict=True):
        _panel(axes, rows, cases, panel, sized=not many)
        axes.set_xlim(0, most)
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


def _groups(sources: Iterable[str]) -> list[dict[str, list[str]]]:
    """Return for each panel its presets, empty for what is no engine, and who has each."""
    found: dict[str, list[str]] = {}
    for source in sources:
        found.setdefault(preset_of(source), []).append(source)
    panels: list[dict[str, list[str]]] = []
    for preset, members in found.items():
        if not panels or sum(map(len, panels[-1].values())) + len(members) > ACROSS:
            panels.append({})
        panels[-1][preset] = members
    return panels


def _panel(
    axes: Axes,
    rows: pd.DataFrame,
    cases: pd.DataFrame,
    groups: Mapping[str, Sequence[str]],
    *,
    sized: bool,
) -> None:
    sources, names = [*itertools.chain(*groups.values())], list(cases["case"])
    for row in rows[rows["source"].isin(sources)].itertuples():
        place = (sources.index(str(row.source)), names.index(str(row.case)))
        _cell(axes, place, Verdict(row.verdict), float(str(row.error)) if sized else math.nan)
    _label_methods(axes, rows, sources, len(names), sized=sized)
    _label_cases(axes, cases, len(sources))
    ends = list(itertools.accumulate(map(len, groups.values())))
    for preset, end in zip(groups, ends, strict=True):
        heading = told(preset).short if preset else "models and SciPy"
        middle = end - 0.5 * len(groups[preset])
        axes.annotate(heading, (middle, 0.0), (0.0, NAMES_PT), textcoords="offset points",
                      ha="center", va="bottom", fontsize=9.5, weight="bold",
                      color=told(preset).colour if preset else "#000000")  # fmt: skip
    for end in ends[:-1]:
        axes.plot([end, end], [-1.0, len(names) + 1], color="#666666", lw=0.8, clip_on=False)
    for j, (before, after) in enumerate(itertools.pairwise(cases["group"]), start=1):
        if before != after:
            axes.plot([-0.2, len(sources) + 0.2], [j, j], color="#666666", lw=0.8, clip_on=False)
    axes.set(ylim=(len(names) + 1, 0))
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


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


def _label_methods(
    axes: Axes, rows: pd.DataFrame, sources: list[str], level: int, *, sized: bool
) -> None:
    """Name each method above its cases; write below how many are right, of those valid."""
    axes.xaxis.tick_top()
    labels = [engine_title(source).replace("average-acc", "average-\nacc") for source in sources]
    axes.set_xticks([i + 0.5 for i in range(len(sources))], labels, fontsize=8.5, ha="left",
                    rotation=70, rotation_mode="anchor", linespacing=0.9)  # fmt: skip
    valid = rows["verdict"] != Verdict.INVALID.value
    right = rows["verdict"].isin([verdict.value for verdict in ACCEPTED]) & valid
    score: dict[str, Any] = {"va": "center", "fontsize": 8, "color": "#333333", "linespacing": 0.9}
    axes.text(-0.08, level + 0.6, "right, of the valid", ha="right", **score)
    between = "/" if sized else "\n"
    for i, source in enumerate(sources):
        mine = rows["source"] == source
        text = f"{(right & mine).sum()}{between}{(valid & mine).sum()}"
        axes.text(i + 0.5, level + 0.6, text, ha="center", **score)


def _label_cases(axes: Axes, cases: pd.DataFrame, across: int) -> None:
    places = [j + 0.5 for j in range(len(cases))]
    axes.set_yticks(places, [WORDS.get(name, name) for name in cases["case"]], fontsize=8.5)
    for place, outcome, peak in zip(
        places, cases["exact_outcome"], cases["exact_peak"], strict=True
    ):
        text = f"{peak:.3g} θcr" if outcome == "rocked" else outcome
        axes.text(across + 0.2, place, text, va="center", fontsize=7.5, color="#555555")
    axes.text(across + 0.2, -0.4, "exact peak", fontsize=7.5, color="#555555")


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
    return f"Right answers of engines to extreme cases:\n{', '.join(words)}"
