"""The largest error of each contact variant, a panel for each engine."""

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from engines.factors import BEST, DEFAULT

COLOURS = {"landing": "#009E73", BEST: "#0072B2", DEFAULT: "#D55E00"}
TITLES = {BEST: "one change from the best fixed-step setting", DEFAULT: "one from the defaults"}
LOWEST, BROKEN, HIGHEST = 1e-6, 2.0, 4.0
"""Errors below are drawn at the first; failed variants and wrong outcomes at the second."""


def draw_contact(lines: pd.DataFrame) -> Figure:
    """Draw the largest error of the peak of every variant.

    Parameters
    ----------
    lines : DataFrame
        The columns of variants.csv.
    """
    engines = list(lines["engine"].unique())
    most = max(lines.groupby("engine").size())
    drawing = Figure(figsize=(7.6 * len(engines), 2.0 + 0.2 * most), layout="constrained")
    panels = drawing.subplots(1, len(engines), squeeze=False)[0]
    for axes, engine in zip(panels, engines, strict=True):
        _one_engine(axes, lines[lines["engine"] == engine])
        axes.set_title(engine)
    drawing.legend(handles=_handles(), loc="outside lower center", ncols=4, frameon=False)
    return drawing


def _one_engine(axes: Axes, lines: pd.DataFrame) -> None:
    ordered = _ordered(lines)
    axes.set(xscale="log", xlim=(LOWEST / 2.0, HIGHEST), ylim=(len(ordered) - 0.3, -0.7))
    axes.axvspan(1.0, HIGHEST, color="#eeeeee", zorder=-1)
    for place, (_, line) in enumerate(ordered.iterrows()):
        _one_variant(axes, place, line)
    for preset in (BEST, DEFAULT):
        _baseline(axes, ordered, preset)
    axes.set_yticks(range(len(ordered)), [_label(line) for _, line in ordered.iterrows()])
    for text, (_, line) in zip(axes.get_yticklabels(), ordered.iterrows(), strict=True):
        text.set(fontsize=8, color=COLOURS[str(line["preset"])])
        if not line["factor"]:
            text.set_fontweight("bold")
    axes.set_xlabel("relative error  [–]")
    axes.grid(axis="x", alpha=0.25)


def _ordered(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the variants from the most accurate in peak and impact to the failed, by preset."""
    broken = lines["worse"] | lines["max_error"].isna()
    keyed = lines.assign(
        first=lines["preset"].map({name: place for place, name in enumerate(COLOURS)}),
        own=lines["factor"] != "",
        broken=broken,
        worst=lines["max_error"].clip(lower=(lines["ratio_over_eta"] - 1.0).abs()),
    )
    return keyed.sort_values(["first", "own", "broken", "worst"])


def _one_variant(axes: Axes, place: int, line: "pd.Series[Any]") -> None:
    colour = COLOURS[str(line["preset"])]
    error = max(float(line["max_error"]), LOWEST)
    if line["max_error"] == line["max_error"]:
        median = max(float(line["median_error"]), LOWEST)
        axes.plot([median, error], [place, place], color=colour, linewidth=1.4, alpha=0.5)
        axes.plot(error, place, "o", color=colour, markersize=4.5 if line["factor"] else 7)
    if line["ratio_over_eta"] == line["ratio_over_eta"]:
        off = min(max(abs(float(line["ratio_over_eta"]) - 1.0), LOWEST), 1.0)
        axes.plot(off, place, "D", color="#444444", markerfacecolor="none", markersize=3.6)
    if line["failed"]:
        axes.plot(BROKEN, place, "X", color="#000000", markersize=6)
    elif line["wrong"]:
        axes.plot(BROKEN, place, "s", color="#000000", markerfacecolor="none", markersize=5.5)


def _baseline(axes: Axes, ordered: pd.DataFrame, preset: str) -> None:
    own = (ordered["preset"] == preset).to_numpy()
    base = ordered[own & (ordered["factor"] == "").to_numpy()]["max_error"]
    if base.empty:
        return
    places = own.nonzero()[0]
    axes.plot([base.iloc[0]] * 2, [places[0] - 0.5, places[-1] + 0.5], color=COLOURS[preset],
              linewidth=1.0, linestyle="--", zorder=0)  # fmt: skip
    axes.axhline(places[0] - 0.5, color="#999999", linewidth=0.8)


def _label(line: "pd.Series[Any]") -> str:
    name = f"{line['factor']}: {line['level']}" if line["factor"] else str(line["level"])
    return f"{name}  [trap]" if line["trap"] else name


def _handles() -> list[Line2D]:
    plain: dict[str, Any] = {"linestyle": "none", "marker": "o"}
    return [
        *(Line2D([], [], color=COLOURS[key], label=name, **plain) for key, name in TITLES.items()),
        Line2D([], [], color="#666666", linestyle="--", label="the preset as it is"),
        Line2D([], [], color="#666666", marker="o", label="peak, median to largest error"),
        Line2D([], [], color="#444444", linestyle="none", marker="D", markersize=4,
               markerfacecolor="none", label="velocity ratio against Housner's η, median"),
        Line2D([], [], color="#000000", linestyle="none", marker="X", label="failed"),
        Line2D([], [], color="#000000", linestyle="none", marker="s", markerfacecolor="none",
               label="wrong outcome"),
    ]  # fmt: skip
