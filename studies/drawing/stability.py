"""The matrix of extreme cases and methods: one mark for each verdict."""

from __future__ import annotations

import itertools
from collections.abc import Mapping, Sequence
from textwrap import fill
from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Patch, Rectangle

from studies.drawing.facets import key, sheet
from studies.drawing.styles import title_of
from studies.measures.presets import look_of, preset_of
from studies.measures.verdicts import Verdict
from studies.measures.wrongness import FALL, MEANINGS, NO_ANSWER, REST, WORDS

MARKS = {
    Verdict.GOOD: ("#B5E0D3", "✓", "#000000", "", "outcome right, peak within 1 % or 1e-6 θcr"),
    Verdict.UNSEEN: ("#E3F3EE", "·", "#000000", "", "misses a rocking below 1e-6 θcr"),
    Verdict.COARSE: ("#F7EE8A", "~", "#000000", "", "peak within 10 %"),
    Verdict.OFF: ("#F2B33D", "≠", "#000000", "", "peak off by more than 10 %"),
    Verdict.SLIDES: ("#E3B3CE", "→", "#000000", "", "slides more than 1 % of B"),
    Verdict.ENERGY: ("#56A0D3", "↑", "#000000", "", "energy grows by more than 1 %"),
    Verdict.FALL: ("#D55E00", "✗", "#FFFFFF", "", WORDS[FALL]),
    Verdict.REST: ("#8B5A3C", "–", "#FFFFFF", "", f"{WORDS[REST]} ({MEANINGS[REST]})"),
    Verdict.FAILED: ("#222222", "!", "#FFFFFF", "", WORDS[NO_ANSWER]),
    Verdict.INVALID: ("#FFFFFF", "○", "#555555", "////", "the reference is not valid here"),
}
"""Verdict -> its colour (Okabe and Ito's palette), symbol, colour of that, hatching, and what a
reader sees."""
ACROSS = 22
"""Methods side by side at most; more stand in a panel below."""


def draw_matrix(rows: pd.DataFrame, title: str) -> Figure:
    """Draw the cases as rows and the methods as columns, those of a preset side by side."""
    cases = rows.drop_duplicates("case")
    panels: list[dict[str, list[str]]] = [{}]
    members: dict[str, list[str]] = {}
    for source in rows["source"].unique():
        members.setdefault(preset_of(source), []).append(source)
    for preset, sources in members.items():
        if panels[-1] and sum(map(len, panels[-1].values())) + len(sources) > ACROSS:
            panels.append({})
        panels[-1][preset] = sources
    most = max(sum(map(len, panel.values())) for panel in panels)
    width = 4.2 + (0.3 if most > 14 else 0.5) * most
    size = (max(width, 7.5), (0.235 * len(cases) + 1.7) * len(panels) + 1.5)
    drawing, grid = sheet(size, len(panels))
    for axes, panel in zip(grid, panels, strict=True):
        _panel(axes, rows, cases, panel)
        axes.set_xlim(0, most)
    drawing.suptitle(fill(title, 75), fontsize=12)
    handles = [
        Patch(fc=colour, ec="#888888", hatch=hatch, label=f"{symbol}  {words}")
        for verdict, (colour, symbol, _, hatch, words) in MARKS.items()
        if verdict.value in set(rows["verdict"])
    ]
    handles.append(Patch(fc="white", ec="#888888", label="    does not apply"))
    key(drawing, handles, 3 if width > 9.0 else 2, fontsize=8)
    return drawing


def _panel(
    axes: Axes, rows: pd.DataFrame, cases: pd.DataFrame, groups: Mapping[str, Sequence[str]]
) -> None:
    """Paint a cell for each case and method; name presets above, exact peaks beside."""
    sources, names = [*itertools.chain(*groups.values())], list(cases["case"])
    for row in rows[rows["source"].isin(sources)].to_dict("records"):
        i, j = sources.index(row["source"]), names.index(row["case"])
        colour, symbol, ink, hatch, _ = MARKS[Verdict(row["verdict"])]
        axes.add_patch(Rectangle((i, j), 1, 1, lw=0.0, fc=colour, ec="#cccccc", hatch=hatch))
        axes.add_patch(Rectangle((i, j), 1, 1, fill=False, ec="white", lw=1.2))
        axes.text(i + 0.5, j + 0.52, symbol, ha="center", va="center_baseline", color=ink)
    axes.xaxis.tick_top()
    labels = [title_of(source).replace("average-acc", "average-\nacc") for source in sources]
    axes.set_xticks([i + 0.5 for i in range(len(sources))], labels, fontsize=8.5, ha="left",
                    rotation=70, rotation_mode="anchor", linespacing=0.9)  # fmt: skip
    axes.set_yticks([j + 0.5 for j in range(len(names))], names, fontsize=8.5)
    beside: dict[str, Any] = {"va": "center", "fontsize": 7.5, "color": "#555555"}
    for j, (peak, outcome) in enumerate(cases[["exact_peak", "exact_outcome"]].to_numpy()):
        text = f"{peak:.3g} θcr" if outcome == "rocked" else outcome
        axes.text(len(sources) + 0.2, j + 0.5, text, **beside)
    axes.text(len(sources) + 0.2, -0.4, "exact peak", **beside)
    line: dict[str, Any] = {"color": "#666666", "lw": 0.8, "clip_on": False}
    end = 0
    for preset, members in groups.items():
        if end:
            axes.plot([end, end], [-1.0, len(names)], **line)
        heading, colour = "models and SciPy", "#000000"
        if preset:
            heading, colour = look_of(preset).short, look_of(preset).colour
        if len(members) < 4:
            heading = heading.replace(" ", "\n")
        axes.annotate(heading, (end + 0.5 * len(members), 0.0), (0.0, 72.0),
                      textcoords="offset points", ha="center", va="bottom", fontsize=9.5,
                      weight="bold", color=colour)  # fmt: skip
        end += len(members)
    for j, (before, after) in enumerate(itertools.pairwise(cases["group"]), start=1):
        if before != after:
            axes.plot([-0.2, len(sources) + 0.2], [j, j], **line)
    axes.set(ylim=(len(names), 0))
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)
