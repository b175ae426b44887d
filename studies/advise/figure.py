"""The price of an error: a case's time with the cheapest setting that keeps it."""

import math
from collections.abc import Sequence

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import PRESET_LINES, engine_style
from studies.measures.words import listed, part

WORDS = {
    "naive": "the libraries' defaults",
    "fixed": "equal steps",
    "error-controlled": "error-controlled steps",
    "landing": "landing steps",
}
"""Preset -> what it is called in the title."""


def draw_advice(lines: pd.DataFrame) -> Figure:
    """Draw a case's time against the error that is kept, a line for each preset of an engine.

    Parameters
    ----------
    lines : DataFrame
        The columns of advice.csv.
    """
    drawing = Figure(figsize=(8.4, 5.2), layout="constrained")
    axes = drawing.subplots()
    engines = list(lines["engine"].unique())
    names = []
    for (engine, preset), group in lines.groupby(["engine", "preset"], sort=False):
        kept = group[group["message"] == ""]
        if not kept.empty:
            above = engines.index(engine) % 2 == 0
            names.append(_draw(axes, str(engine), str(preset), kept, above))
    targets = sorted(lines["target"].unique(), reverse=True)
    axes.set(xscale="log", yscale="log", xticks=targets)
    axes.set_xticks([], minor=True)
    axes.set_xticklabels([part(float(target)) for target in targets])
    axes.set_xlim(2.0 * targets[0], targets[-1] / 2.0)
    axes.margins(y=0.15)
    axes.set_xlabel("largest error of a peak, kept on every published case")
    axes.set_ylabel("time of a case  [ms]")
    axes.grid(alpha=0.25)
    axes.set_title(_title(lines, targets), fontsize=11)
    beside(axes, names)
    return drawing


def _draw(axes: Axes, engine: str, preset: str, kept: pd.DataFrame, above: bool) -> Name:
    """Draw a preset's line, and its steps where they change; return its name, at the end."""
    style = engine_style(engine, preset)
    errors, times = kept["target"].to_numpy(float), 1e3 * kept["wall_s"].to_numpy(float)
    axes.plot(
        errors,
        times,
        color=style.colour,
        linestyle=PRESET_LINES.get(preset, "-"),
        marker=style.marker,
        fillstyle=style.fill,
        markersize=6,
    )
    steps = [_step(value) for value in kept["value"]]
    name = f"{engine} {preset}"
    if len(set(steps)) == 1:
        return Name(f"{name}, {steps[0]}", float(errors[-1]), float(times[-1]), style.colour)
    changed = kept["value"].ne(kept["value"].shift())
    for error, time, value in zip(
        errors[changed], times[changed], kept["value"][changed], strict=True
    ):
        axes.annotate(
            _step(value),
            (error, time),
            xytext=(-4, 5) if above else (4, -5),
            textcoords="offset points",
            ha="right" if above else "left",
            va="bottom" if above else "top",
            fontsize=8,
            color=style.colour,
        )
    return Name(name, float(errors[-1]), float(times[-1]), style.colour)


def _step(value: float) -> str:
    return "its own" if math.isnan(value) else f"{value:g}"


def _title(lines: pd.DataFrame, targets: Sequence[float]) -> str:
    """Say which presets keep the smallest error, and which keep none at all."""
    kept = lines[lines["message"] == ""]
    best = list(kept.loc[kept["target"] == targets[-1], "preset"].unique())
    none = [name for name in lines["preset"].unique() if name not in set(kept["preset"])]
    words = f"{part(targets[-1])} is kept by {_named(best)} alone"
    if none:
        words += f", and {part(targets[0])} not even by {_named(none)}"
    return f"{words}\n(numbers: p dt)"


def _named(presets: Sequence[str]) -> str:
    return listed([WORDS.get(name, name) for name in presets], "or")
