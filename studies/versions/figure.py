"""Errors by release, a panel for each engine."""

from __future__ import annotations

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.styles import preset_style, title_of
from studies.measures.presets import in_words, told
from studies.versions.tables import CHANGED

COLUMNS = 2
"""Panels side by side."""

ALONE = 0.3
"""Half of the line of a median where there is one release."""

APART = 0.012
"""Distance over the panel's width of presets at a release, which are often equally far off."""

FLOOR = 1e-8
"""Errors below are drawn here."""


def draw_versions(lines: pd.DataFrame, changes: pd.DataFrame) -> Figure:
    """Draw the error of each preset by release; where answers changed, a line stands.

    Parameters
    ----------
    lines, changes : DataFrame
        The columns of releases.csv and changes.csv.
    """
    engines = list(lines["engine"].unique())
    rows = -(-len(engines) // COLUMNS)
    drawing = Figure(figsize=(9.4, 2.9 * rows), layout="constrained")
    panels = drawing.subplots(rows, COLUMNS, sharey=True, squeeze=False).ravel()
    for axes, engine in zip(panels, engines, strict=False):
        mine = lines[lines["engine"] == engine]
        _panel(axes, mine, changes[changes["engine"] == engine])
        axes.set_title(title_of(str(engine)), fontsize=10)
    panels[0].set_ylim(FLOOR, 3.0 * max(1.0, lines["max_error"].max()))
    for axes in panels[len(engines) :]:
        axes.set_axis_off()
    drawing.suptitle(
        "Errors by release: medians (lines) and largest (points); "
        f"at a grey line an answer moved by more than {CHANGED:g}",
        fontsize=11,
    )
    for axes in panels[::COLUMNS]:
        axes.set_ylabel("relative error of the peak  [–]")
    presets = _presets(lines[lines["source"] != ""]).unique()
    handles = [_handle(preset) for preset in presets]
    drawing.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return drawing


def _presets(lines: pd.DataFrame) -> pd.Series[str]:
    """Return the preset of each line, whose engine need not be here."""
    return lines["source"].str.partition(":")[2]


def _handle(preset: str) -> Line2D:
    """Return what stands for a preset, whatever its engine."""
    look = {**preset_style(preset).points(6.0), "linestyle": told(preset).line}
    return Line2D([], [], **look, label=in_words(preset))


def _panel(axes: Axes, lines: pd.DataFrame, changes: pd.DataFrame) -> None:
    """Draw medians and largest errors over both sets of cases."""
    releases = [str(name) for name in lines["release"].unique()]
    place = {name: number for number, name in enumerate(releases)}
    axes.set(yscale="log", xlim=(-0.5, len(releases) - 0.5))
    axes.set_xticks(range(len(releases)), releases, rotation=60, ha="right", fontsize=8)
    for release in changes["release"]:
        axes.axvline(place[str(release)] - 0.5, color="#999999", linewidth=1.0)
    answered = set(lines.loc[lines["failed"] < lines["cases"], "release"])
    for release in (name for name in releases if name not in answered):
        at = place[release]
        axes.axvspan(at - 0.5, at + 0.5, color="#EEEEEE", linewidth=0.0)
        axes.text(at, 1e-4, "no answer", rotation=90, fontsize=8, color="#555555", ha="center")
    asked = lines[lines["source"] != ""]
    presets = _presets(asked)
    for number, preset in enumerate(names := list(presets.unique())):
        style = preset_style(preset)
        both = asked[presets == preset].groupby("release", sort=False)
        median = both["median_error"].max().clip(lower=FLOOR)
        largest = both["max_error"].max().clip(lower=FLOOR)
        x = [place[str(name)] for name in median.index]
        alone = len(x) == 1  # a line needs two ends
        axes.plot(
            [x[0] - ALONE, x[0] + ALONE] if alone else x,
            [*median] * (1 + alone),
            color=style.colour,
            linestyle=told(preset).line,
            linewidth=1.3,
        )
        aside = APART * len(releases) * (number - (len(names) - 1) / 2)
        axes.plot([at + aside for at in x], largest, **style.points(4.5))
    axes.grid(alpha=0.25)
