"""Extreme cases that engines predict: a bar for each engine and preset, and cases that differ."""

from textwrap import fill

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.facets import key, preset_dots, rows, sheet
from studies.drawing.styles import title_of
from studies.measures.presets import in_order, look_of

DIFFER = 6
"""How many cases are drawn: those that the last preset predicts most often beyond the first."""


def draw_scores(title: str, engines: pd.DataFrame, cases: pd.DataFrame) -> Figure:
    """Draw of how many valid cases each preset is right: engine by engine, and on some cases."""
    presets = in_order(engines["preset"])
    share = cases.assign(share=cases["right"] / cases["valid"])
    wide = share.pivot(index="case", columns="preset", values="share")
    gain = (wide[presets[-1]] - wide[presets[0]]).sort_values(ascending=False, kind="stable")
    named = {title_of(str(name)): of for name, of in engines.groupby("engine", sort=False)}
    differ = {str(name): cases[cases["case"] == name] for name in gain.index[:DIFFER]}
    heights = [len(named), len(differ)]
    size = (8.6, 2.0 + (0.2 + 0.085 * len(presets)) * sum(heights))
    drawing, (upper, lower) = sheet(size, 2, 1, sharex=True, height_ratios=heights)
    _bars(upper, named, presets)
    _bars(lower, differ, presets)
    upper.set_title("Right in all valid extreme cases", fontsize=10.5)
    lower.set_title("Cases with which presets differ most: engines that are right", fontsize=10.5)
    lower.set(xlim=(0.0, 1.12), xticks=[0.0, 0.5, 1.0], xticklabels=["0", "50 %", "100 %"])
    drawing.suptitle(fill(title, 75), fontsize=12)
    key(drawing, preset_dots(presets), 5)
    return drawing


def _bars(axes: Axes, lines: dict[str, pd.DataFrame], presets: list[str]) -> None:
    rows(axes, [*lines], 10.0)
    axes.grid(axis="y", visible=False)
    high = 0.84 / len(presets)
    for place, of in enumerate(lines.values()):
        known = of.set_index("preset").reindex(presets).dropna()
        first = place - 0.5 * high * (len(known) - 1)
        for number, (preset, line) in enumerate(known.iterrows()):
            share, y = line["right"] / line["valid"], first + number * high
            axes.barh(y, share, 0.85 * high, color=look_of(str(preset)).colour)
            words = f"{line['right']:.0f} of {line['valid']:.0f}"
            axes.text(share + 0.01, y, words, va="center", fontsize=7.5)
