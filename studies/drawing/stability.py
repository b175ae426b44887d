"""The matrix of extreme cases and methods: one mark for each verdict."""

from __future__ import annotations

import itertools
from collections.abc import Iterable, Mapping, Sequence
from textwrap import fill
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from studies.drawing.facets import key, sheet
from studies.drawing.styles import title_of
from studies.measures.presets import look_of, preset_of
from studies.measures.verdicts import ACCEPTED, SENTENCES, Verdict

MARKS = {
    Verdict.GOOD: ("#B5E0D3", "✓", "#000000", ""),
    Verdict.UNSEEN: ("#E3F3EE", "·", "#000000", ""),
    Verdict.COARSE: ("#F7EE8A", "~", "#000000", ""),
    Verdict.OFF: ("#F2B33D", "≠", "#000000", ""),
    Verdict.SLIDES: ("#E3B3CE", "→", "#000000", ""),
    Verdict.ENERGY: ("#56A0D3", "↑", "#000000", ""),
    Verdict.FALL: ("#D55E00", "✗", "#FFFFFF", ""),
    Verdict.REST: ("#8B5A3C", "–", "#FFFFFF", ""),
    Verdict.FAILED: ("#222222", "!", "#FFFFFF", ""),
    Verdict.INVALID: ("#FFFFFF", "○", "#555555", "////"),
}
"""Verdict -> its cell's colour (Okabe and Ito's palette), symbol, colour of that, hatching."""
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
ACROSS = 22
"""Methods side by side at most; more stand in a panel below."""


def draw_matrix(rows: pd.DataFrame, title: str) -> Figure:
    """Draw the cases as rows and the methods as columns, those of a preset side by side."""
    groups, cases = _groups(rows["source"].unique()), rows.drop_duplicates("case")
    most = max(sum(map(len, panel.values())) for panel in groups)
    width = 4.2 + (0.3 if most > 14 else 0.5) * most
    size = (max(width, 7.5), (0.235 * len(cases) + 1.7) * len(groups) + 1.5)
    drawing, grid = sheet(size, len(groups))
    for axes, panel in zip(grid, groups, strict=True):
        _panel(axes, rows, cases, panel)
        axes.set_xlim(0, most)
    drawing.suptitle(fill(title, 75), fontsize=12)
    handles = [
        Patch(fc=colour, ec="#888888", hatch=hatch, label=f"{symbol}  {SENTENCES[verdict]}")
        for verdict, (colour, symbol, _, hatch) in MARKS.items()
        if verdict.value in set(rows["verdict"])
    ]
    handles.append(Patch(fc="white", ec="#888888", label="    does not apply"))
    key(drawing, handles, 3 if width > 9.0 else 2, fontsize=8)
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
    axes: Axes, rows: pd.DataFrame, cases: pd.DataFrame, groups: Mapping[str, Sequence[str]]
) -> None:
    sources, names = [*itertools.chain(*groups.values())], list(cases["case"])
    for row in rows[rows["source"].isin(sources)].to_dict("records"):
        i, j = sources.index(row["source"]), names.index(row["case"])
        colour, symbol, ink, hatch = MARKS[Verdict(row["verdict"])]
        axes.add_patch(Rectangle((i, j), 1, 1, lw=0.0, fc=colour, ec="#cccccc", hatch=hatch))
        axes.add_patch(Rectangle((i, j), 1, 1, fill=False, ec="white", lw=1.2))
        axes.text(i + 0.5, j + 0.52, symbol, ha="center", va="center_baseline", color=ink)
    _name_methods(axes, rows, sources, len(names))
    axes.set_yticks([j + 0.5 for j in range(len(names))], [WORDS.get(it, it) for it in names],
                    fontsize=8.5)  # fmt: skip
    beside: dict[str, Any] = {"va": "center", "fontsize": 7.5, "color": "#555555"}
    for j, (peak, outcome) in enumerate(cases[["exact_peak", "exact_outcome"]].to_numpy()):
        text = f"{peak:.3g} θcr" if outcome == "rocked" else outcome
        axes.text(len(sources) + 0.2, j + 0.5, text, **beside)
    axes.text(len(sources) + 0.2, -0.4, "exact peak", **beside)
    ends = list(itertools.accumulate(map(len, groups.values())))
    for preset, end in zip(groups, ends, strict=True):
        heading, colour = "models and SciPy", "#000000"
        if preset:
            heading, colour = look_of(preset).short, look_of(preset).colour
        if len(groups[preset]) < 4:
            heading = heading.replace(" ", "\n")
        axes.annotate(heading, (end - 0.5 * len(groups[preset]), 0.0), (0.0, 72.0),
                      textcoords="offset points", ha="center", va="bottom", fontsize=9.5,
                      weight="bold", color=colour)  # fmt: skip
    line: dict[str, Any] = {"color": "#666666", "lw": 0.8, "clip_on": False}
    for end in ends[:-1]:
        axes.plot([end, end], [-1.0, len(names) + 1], **line)
    for j, (before, after) in enumerate(itertools.pairwise(cases["group"]), start=1):
        if before != after:
            axes.plot([-0.2, len(sources) + 0.2], [j, j], **line)
    axes.set(ylim=(len(names) + 1, 0))
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def _name_methods(axes: Axes, rows: pd.DataFrame, sources: list[str], level: int) -> None:
    """Name each method above its cases; write below how many are right, of those valid."""
    axes.xaxis.tick_top()
    labels = [title_of(source).replace("average-acc", "average-\nacc") for source in sources]
    axes.set_xticks([i + 0.5 for i in range(len(sources))], labels, fontsize=8.5, ha="left",
                    rotation=70, rotation_mode="anchor", linespacing=0.9)  # fmt: skip
    valid = rows["verdict"] != Verdict.INVALID.value
    right = rows["verdict"].isin([verdict.value for verdict in ACCEPTED]) & valid
    score: dict[str, Any] = {"va": "center", "fontsize": 8, "color": "#333333", "linespacing": 0.9}
    axes.text(-0.08, level + 0.6, "right, of the valid", ha="right", **score)
    for i, source in enumerate(sources):
        mine = rows["source"] == source
        text = f"{(right & mine).sum()}\n{(valid & mine).sum()}"
        axes.text(i + 0.5, level + 0.6, text, ha="center", **score)
