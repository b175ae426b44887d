"""Errors by release, a panel for each engine."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.drawing.styles import line_of, preset_line, preset_style, style_of
from studies.measures.presets import in_words
from studies.versions.tables import CHANGED

COLUMNS = 2
"""Panels side by side."""

ALONE = 0.05
"""Half of the line of a median where there is one release."""

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
    drawing = Figure(figsize=(12.4, 3.6 * rows), layout="constrained")
    panels = drawing.subplots(rows, COLUMNS, sharey=True, squeeze=False).ravel()
    for axes, engine in zip(panels, engines, strict=False):
        mine = lines[lines["engine"] == engine]
        _panel(axes, mine, changes[changes["engine"] == engine])
        axes.set_title(f"{engine} by release", fontsize=10)
    for axes in panels[len(engines) :]:
        axes.set_axis_off()
    key = (
        f"line: median, points: largest error; grey line: an answer moved by more than {CHANGED:g}"
    )
    drawing.suptitle(key, fontsize=9, color="#555555")
    for axes in panels[::COLUMNS]:
        axes.set_ylabel("relative error of the peak  [–]")
    presets = lines.loc[lines["source"] != "", "source"].str.partition(":")[2].unique()
    handles = [_handle(preset) for preset in presets]
    drawing.legend(handles=handles, loc="outside lower center", ncols=4, frameon=False, fontsize=9)
    return drawing


def _handle(preset: str) -> Line2D:
    """Return what stands for a preset, whatever its engine."""
    look = {**preset_style(preset).points(6.0), "color": "#555555"}
    return Line2D([], [], **{**look, "linestyle": preset_line(preset)}, label=in_words(preset))


def _panel(axes: Axes, lines: pd.DataFrame, changes: pd.DataFrame) -> None:
    """Draw medians and largest errors over both sets of cases."""
    releases = [str(name) for name in lines["release"].unique()]
    place = {name: number for number, name in enumerate(releases)}
    axes.set(yscale="log", xlim=(-0.5, len(releases) - 0.5), ylim=(FLOOR, 30.0))
    axes.set_xticks(range(len(releases)), releases, rotation=60, ha="right", fontsize=8)
    for release in changes["release"]:
        axes.axvline(place[str(release)] - 0.5, color="#999999", linewidth=1.0)
    answered = set(lines.loc[lines["failed"] < lines["cases"], "release"])
    for release in (name for name in releases if name not in answered):
        at = place[release]
        axes.axvspan(at - 0.5, at + 0.5, color="#EEEEEE", linewidth=0.0)
        axes.text(at, 1e-4, "no answer", rotation=90, fontsize=8, color="#555555", ha="center")
    for source, rows in lines[lines["source"] != ""].groupby("source", sort=False):
        style = style_of(str(source))
        both = rows.groupby("release", sort=False)
        median = both["median_error"].max().clip(lower=FLOOR)
        largest = both["max_error"].max().clip(lower=FLOOR)
        x = [place[str(name)] for name in median.index]
        alone = len(x) == 1  # a line needs two ends
        ends = [x[0] - ALONE, x[0] + ALONE] if alone else x
        axes.plot(
            ends,
            [*median] * (1 + alone),
            color=style.colour,
            linestyle=line_of(str(source)),
            linewidth=1.3,
        )
        axes.plot(x, largest, **style.points(4.0))
    axes.grid(alpha=0.25)
