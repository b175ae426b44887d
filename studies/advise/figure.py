"""The price of an error: a case's time with the cheapest setting that keeps it."""

from __future__ import annotations

from textwrap import fill

import pandas as pd
from matplotlib.figure import Figure

from engines import ENGINES
from engines.declaration import RECOMMENDED
from studies.advise.choice import NOTHING
from studies.advise.evidence import in_words
from studies.drawing.facets import HALO, key, panels, preset_dots, rows
from studies.drawing.styles import title_of
from studies.measures.presets import told
from studies.measures.words import listed, per_cent

LETTERS = 44
"""In a line of the title, for each panel under it."""
LEFT, RIGHT = 0.5, 2.0
"""Room before the first point of all and after the last, as factors of a time."""


def draw_advice(lines: pd.DataFrame) -> Figure:
    """Draw the time of a case with each preset that keeps an error: engines as rows.

    A panel for each error; at a point the step, p dt, or the accuracy of an engine's own.
    """
    engines, targets = list(lines["engine"].unique()), list(lines["target"].unique())
    each = (4.8, 0.9 + 0.3 * len(engines))
    drawing, grid = panels(len(targets), 2, each, 1.0, sharex=True, sharey=True)
    kept = lines[lines["message"] == ""]
    for axes, target in zip(grid, targets, strict=True):
        rows(axes, [title_of(name) for name in engines])
        axes.set_title(f"{per_cent(target)} kept with every finer step", fontsize=10.5)
        axes.set(xscale="log")
        mine = kept[kept["target"] == target]
        for line in mine.to_dict("records"):
            place = (1e3 * line["wall_s"], engines.index(line["engine"]))
            preset = ENGINES[line["engine"]].preset(line["preset"])
            axes.plot(*place, "o", color=told(preset.name).colour)
            step = in_words(preset, line["value"]).rpartition(" = ")[2]
            axes.annotate(step, place, (0, -11 if preset.name == RECOMMENDED else 5), ha="center",
                          textcoords="offset points", fontsize=7, path_effects=HALO)  # fmt: skip
        for engine in set(engines) - set(mine["engine"]):
            axes.text(0.01, engines.index(engine), NOTHING, fontsize=7.5, color="#888888",
                      va="center", path_effects=HALO,
                      transform=axes.get_yaxis_transform())  # fmt: skip
    if len(kept):
        times = 1e3 * kept["wall_s"]
        grid[0].set_xlim(LEFT * times.min(), RIGHT * times.max())
    for axes in grid[-2:]:
        axes.set_xlabel("time of a case  [ms]")
    drawing.suptitle(_title(lines, targets), fontsize=11)
    key(drawing, preset_dots(kept["preset"].unique()), 5)
    return drawing


def _title(lines: pd.DataFrame, targets: list[float]) -> str:
    kept, asked = lines[lines["message"] == ""], list(lines["preset"].unique())
    best = list(kept.loc[kept["target"] == min(targets), "preset"].unique())
    none = [name for name in asked if name not in set(kept["preset"])]
    words = f"{per_cent(min(targets))} is kept {_named(best) if best else 'by none of them'}"
    if 0 < len(best) < len(asked):
        words += " alone"
    if none and len(targets) > 1:
        words += f", and {per_cent(max(targets))} not even {_named(none)}"
    note = "(numbers: p dt, or the accuracy of an engine's own steps)"
    return f"{fill(words, LETTERS * min(len(targets), 2))}\n{note}"


def _named(presets: list[str]) -> str:
    return listed([told(name).words for name in presets], "or")
