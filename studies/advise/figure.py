"""The price of an error: a case's time with the cheapest setting that keeps it."""

from collections.abc import Sequence
from textwrap import wrap

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines import ENGINES
from studies.advise.evidence import in_words
from studies.drawing.labels import Name, around, beside
from studies.drawing.styles import engine_style, preset_line
from studies.measures.words import listed, per_cent

WORDS = {
    "naive": "the libraries' defaults",
    "fixed": "equal steps",
    "landing": "landing steps",
    "error-controlled": "an engine's own steps",
}
"""Preset -> what it is called in the title."""
LETTERS = 88
"""In a line of the title."""


def draw_advice(lines: pd.DataFrame) -> Figure:
    """Draw a case's time against the error that is kept, a line for each preset of an engine.

    Parameters
    ----------
    lines : DataFrame
        The columns of advice.csv.
    """
    drawing = Figure(figsize=(8.4, 5.2), layout="constrained")
    axes = drawing.subplots()
    names, steps = [], []
    for (engine, preset), group in lines.groupby(["engine", "preset"], sort=False):
        kept = group[group["message"] == ""]
        if not kept.empty:
            name, mine = _draw(axes, str(engine), str(preset), kept)
            names.append(name)
            steps += mine
    targets = sorted(lines["target"].unique(), reverse=True)
    axes.set(xscale="log", yscale="log", xticks=targets)
    axes.set_xticks([], minor=True)
    axes.set_xticklabels([per_cent(float(error)) for error in targets])
    axes.set_xlim(2.0 * targets[0], targets[-1] / 2.0)
    axes.margins(y=0.15)
    axes.set_xlabel("largest error of a peak, kept on every published case")
    axes.set_ylabel("time of a case  [ms]")
    axes.grid(alpha=0.25)
    axes.set_title(_title(lines, targets), fontsize=10)
    around(axes, steps, np.array([(step.x, step.y) for step in steps]).reshape(-1, 2), 7.0)
    beside(axes, names)
    return drawing


def _draw(axes: Axes, engine: str, preset: str, kept: pd.DataFrame) -> tuple[Name, list[Name]]:
    """Draw a preset's line; return its name, at the end, and its steps where they change."""
    style = engine_style(engine, preset)
    errors, times = kept["target"].to_numpy(float), 1e3 * kept["wall_s"].to_numpy(float)
    axes.plot(
        errors,
        times,
        color=style.colour,
        linestyle=preset_line(preset),
        marker=style.marker,
        fillstyle=style.fill,
        markersize=6,
    )
    steps = [_step(engine, preset, value) for value in kept["value"]]
    name = f"{engine} {preset}"
    if len(set(steps)) == 1:
        return Name(f"{name}, {steps[0]}", float(errors[-1]), float(times[-1]), style.colour), []
    changed = kept["value"].ne(kept["value"].shift())
    marks = [
        Name(step, float(error), float(time), style.colour)
        for step, error, time, new in zip(steps, errors, times, changed, strict=True)
        if new
    ]
    return Name(name, float(errors[-1]), float(times[-1]), style.colour), marks


def _step(engine: str, preset: str, value: float) -> str:
    """Return a setting, of a step the number alone."""
    return in_words(ENGINES[engine].preset(preset), value).removeprefix("p dt = ")


def _title(lines: pd.DataFrame, targets: Sequence[float]) -> str:
    """Say which presets keep the smallest error, and which keep none at all."""
    kept = lines[lines["message"] == ""]
    best = list(kept.loc[kept["target"] == targets[-1], "preset"].unique())
    none = [name for name in lines["preset"].unique() if name not in set(kept["preset"])]
    words = f"{per_cent(targets[-1])} is kept by {_named(best)} alone"
    if none:
        words += f", and {per_cent(targets[0])} not even by {_named(none)}"
    return "\n".join([*wrap(words, LETTERS), "(numbers: p dt)"])


def _named(presets: Sequence[str]) -> str:
    return listed([WORDS.get(name, name) for name in presets], "or")
