"""Errors by release, a panel for each engine."""

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import engine_style, line_of
from studies.versions.tables import CHANGED

COLUMNS = 2
"""Panels side by side."""

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
    names = []
    for axes, engine in zip(panels, engines, strict=False):
        mine = lines[lines["engine"] == engine]
        names.append(_panel(axes, mine, changes[changes["engine"] == engine]))
        axes.set_title(f"{engine} by release", fontsize=10)
    for axes in panels[len(engines) :]:
        axes.set_axis_off()
    key = (
        f"line: median, points: largest error; grey line: an answer moved by more than {CHANGED:g}"
    )
    drawing.suptitle(key, fontsize=9, color="#555555")
    for axes in panels[::COLUMNS]:
        axes.set_ylabel("relative error of the peak  [–]")
    for axes, mine in zip(panels, names, strict=False):
        beside(axes, mine, 8.0)
    return drawing


def _panel(axes: Axes, lines: pd.DataFrame, changes: pd.DataFrame) -> list[Name]:
    """Draw medians and largest errors over both sets of cases; return the names of the presets."""
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
    names = []
    for source, rows in lines[lines["source"] != ""].groupby("source", sort=False):
        engine, _, preset = str(source).partition(":")
        style = engine_style(engine, preset)
        both = rows.groupby("release", sort=False)
        median = both["median_error"].max().clip(lower=FLOOR)
        largest = both["max_error"].max().clip(lower=FLOOR)
        x = [place[str(name)] for name in median.index]
        axes.plot(x, median, color=style.colour, linestyle=line_of(str(source)), linewidth=1.3)
        axes.plot(x, largest, **style.points(4.0))
        shown = median.dropna()
        if len(shown):
            names.append(Name(preset, place[str(shown.index[-1])], shown.iloc[-1], style.colour))
    axes.grid(alpha=0.25)
    return names
