"""Errors by release, a panel for each engine."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.facets import key, panels
from studies.drawing.styles import preset_style, title_of
from studies.measures.presets import told
from studies.versions.tables import CHANGED, answered

COLUMNS = 2
"""Panels side by side."""

ALONE = 0.3
"""Half of the line of a median where there is one release."""

APART = 0.012
"""Distance over the panel's width of presets at a release, which are often equally far off."""

FLOOR = 1e-8
"""Errors below are drawn here."""


def draw_versions(lines: pd.DataFrame, changes: pd.DataFrame) -> Figure:
    """Draw the error of each preset by release; where answers changed, a line stands."""
    lines = lines.assign(preset=lines["source"].str.partition(":")[2])
    engines = list(lines["engine"].unique())
    drawing, grid = panels(len(engines), COLUMNS, (9.4 / COLUMNS, 2.9), 0.0, sharey=True)
    for place, (axes, engine) in enumerate(zip(grid, engines, strict=True)):
        _panel(axes, lines[lines["engine"] == engine], changes[changes["engine"] == engine])
        axes.set_title(title_of(str(engine)), fontsize=10)
        if place % COLUMNS == 0:
            axes.set_ylabel("relative error of the peak  [–]")
    grid[0].set_ylim(FLOOR, 3.0 * max(1.0, lines["max_error"].max()))
    drawing.suptitle(
        "Errors by release: medians (lines) and largest (points); "
        f"at a grey line an answer moved by more than {CHANGED:g}",
        fontsize=11,
    )
    key(drawing, [_handle(preset) for preset in lines["preset"].unique() if preset], across=5)
    return drawing


def _handle(preset: str) -> Line2D:
    look = {**preset_style(preset).points(6.0), "linestyle": told(preset).line}
    return Line2D([], [], **look, label=told(preset).short)


def _panel(axes: Axes, lines: pd.DataFrame, changes: pd.DataFrame) -> None:
    releases = list(lines["release"].unique())
    axes.set(yscale="log", xlim=(-0.5, len(releases) - 0.5))
    axes.set_xticks(range(len(releases)), releases, rotation=60, ha="right", fontsize=8)
    for release in changes["release"]:
        axes.axvline(releases.index(release) - 0.5, color="#999999", linewidth=1.0)
    for release in set(releases) - set(answered(lines)["release"]):
        at = releases.index(release)
        axes.axvspan(at - 0.5, at + 0.5, color="#EEEEEE", linewidth=0.0)
        axes.text(at, 1e-4, "no answer", rotation=90, fontsize=8, color="#555555", ha="center")
    presets = lines[lines["preset"] != ""].groupby("preset", sort=False)
    for number, (preset, mine) in enumerate(presets):
        both = mine.groupby("release", sort=False)[["median_error", "max_error"]].max()
        both = both.clip(lower=FLOOR).rename(index=releases.index)
        style, line = preset_style(str(preset)), told(str(preset)).line
        median = both["median_error"]
        if len(median) == 1:  # a line needs two ends
            median = pd.concat([median.rename(index=lambda at: at - ALONE),
                                median.rename(index=lambda at: at + ALONE)])  # fmt: skip
        axes.plot(median, line, color=style.colour, linewidth=1.3)
        aside = min(APART * len(releases), 0.2) * (number - (len(presets) - 1) / 2)
        axes.plot(both.index + aside, both["max_error"], **style.points(4.5))
    axes.grid(alpha=0.25)
