"""The price of an error: a case's time with the cheapest setting that keeps it."""

from __future__ import annotations

from collections.abc import Sequence
from textwrap import wrap

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines import ENGINES
from studies.advise.evidence import in_words
from studies.drawing.labels import Name, around, beyond
from studies.drawing.styles import engine_style, title_of
from studies.measures.presets import told
from studies.measures.words import listed, per_cent

LETTERS = 88
"""In a line of the title."""
BEFORE, AFTER, EDGE = 0.9, 1.3, 0.25
"""Room for names before and after the points of a panel, and for none, over that of the points."""


def draw_advice(lines: pd.DataFrame) -> Figure:
    """Draw a case's time against the error that is kept, a line for each preset of an engine.

    Parameters
    ----------
    lines : DataFrame
        The columns of advice.csv.
    """
    targets = sorted(lines["target"].unique(), reverse=True)
    landing = lines["preset"] == "landing"
    parts = {"landing steps": lines[landing], "equal steps, or an engine's own": lines[~landing]}
    parts = {title: part for title, part in parts.items() if (part["message"] == "").any()}
    drawing = Figure(figsize=(10.0, 5.6), layout="constrained")
    panels = drawing.subplots(1, max(len(parts), 1), sharey=True, squeeze=False)[0]
    panels[0].set(yscale="log", ylabel="time of a case  [ms]")
    panels[0].margins(y=0.1)
    drawn = [
        _panel(axes, part, targets) for axes, part in zip(panels, parts.values(), strict=False)
    ]
    for axes, title, (ends, steps) in zip(panels, parts, drawn, strict=False):
        axes.set_title(title, fontsize=10)
        alone = [end for end in ends if end.x == targets[0]]
        beyond(axes, alone, -1 if len(alone) < len(ends) else 1)
        last = min((end.x for end in ends), default=0.0)
        beyond(axes, [end for end in ends if end.x == last and end not in alone])
        # others go on where these end
        between = [end for end in ends if end.x not in (targets[0], last)]
        around(axes, [*steps, *between], 7.0)
    drawing.supxlabel("largest error of a peak, kept with every finer step", fontsize=10)
    drawing.suptitle(_title(lines, targets), fontsize=11)
    return drawing


def _panel(
    axes: Axes, lines: pd.DataFrame, targets: Sequence[float]
) -> tuple[list[Name], list[Name]]:
    """Draw the lines of some presets; return their names, and their steps where these change."""
    ends: list[Name] = []
    steps: list[Name] = []
    for (engine, preset), group in lines.groupby(["engine", "preset"], sort=False):
        kept = group[group["message"] == ""]
        if not kept.empty:
            end, mine = _draw(axes, str(engine), str(preset), kept)
            ends.append(end)
            steps += mine
    shown = [
        error for error in targets if (lines.loc[lines["message"] == "", "target"] == error).any()
    ]
    axes.set(xscale="log", xticks=shown)
    axes.set_xticks([], minor=True)
    axes.set_xticklabels([per_cent(float(error)) for error in shown])
    reach = max(shown[0] / shown[-1], 10.0)
    first = BEFORE if any(end.x == shown[0] > shown[-1] for end in ends) else EDGE
    axes.set_xlim(shown[0] * reach**first, shown[-1] / reach**AFTER)
    axes.grid(alpha=0.25)
    return ends, steps


def _draw(axes: Axes, engine: str, preset: str, kept: pd.DataFrame) -> tuple[Name, list[Name]]:
    """Draw a preset's line; return its name, with its last step, and the steps before."""
    style = engine_style(engine, preset)
    errors, times = kept["target"].to_numpy(float), 1e3 * kept["wall_s"].to_numpy(float)
    axes.plot(
        errors,
        times,
        color=style.colour,
        linestyle=told(preset).line,
        marker=style.marker,
        fillstyle=style.fill,
        markersize=6,
    )
    steps = [_step(engine, preset, value) for value in kept["value"]]
    marks = [
        Name(step, float(error), float(time), style.colour)
        for step, before, error, time in zip(steps, ["", *steps], errors, times, strict=False)
        if step not in (before, steps[-1])
    ]
    name = f"{title_of(engine)}, {told(preset).short}, {steps[-1]}"
    return Name(name, float(errors[-1]), float(times[-1]), style.colour), marks


def _step(engine: str, preset: str, value: float) -> str:
    """Return a setting: a number alone where it has one."""
    return in_words(ENGINES[engine].preset(preset), value).rpartition(" = ")[2]


def _title(lines: pd.DataFrame, targets: Sequence[float]) -> str:
    """Say which presets keep the smallest error, and which keep none at all."""
    kept, asked = lines[lines["message"] == ""], list(lines["preset"].unique())
    best = list(kept.loc[kept["target"] == targets[-1], "preset"].unique())
    none = [name for name in asked if name not in set(kept["preset"])]
    words = f"{per_cent(targets[-1])} is kept {_named(best) if best else 'by none of them'}"
    if 0 < len(best) < len(asked):
        words += " alone"
    if none and len(targets) > 1:
        words += f", and {per_cent(targets[0])} not even {_named(none)}"
    return "\n".join(
        [*wrap(words, LETTERS), "(numbers: p dt, or the accuracy of an engine's own steps)"]
    )


def _named(presets: Sequence[str]) -> str:
    return listed([told(name).words for name in presets], "or")
