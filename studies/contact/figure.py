"""The largest error of each contact variant, a panel for each engine."""

from __future__ import annotations

from typing import Any

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from studies.measures.presets import in_order, told
from studies.measures.words import part

MATTER = 10
"""How many variants of an engine are drawn one by one."""
ROW, HEAD, FOOT = 0.148, 0.3, 1.15
"""Heights [in] of a line, of what is above a panel, and of the key."""
LOWEST, BROKEN, HIGHEST = 1e-6, 2.0, 4.0
"""Errors below are drawn at the first; failed variants and wrong outcomes at the second."""


def draw_contact(lines: pd.DataFrame) -> Figure:
    """Draw the largest error of the peak of the variants that matter most, and count the others.

    Parameters
    ----------
    lines : DataFrame
        The columns of variants.csv.
    """
    engines = list(lines["engine"].unique())
    shown = [_ordered(lines[lines["engine"] == engine]) for engine in engines]
    heights = [HEAD + ROW * (len(ordered) + 1) for ordered, _ in shown]
    drawing = Figure(figsize=(8.6, FOOT + sum(heights)), layout="constrained")
    panels = drawing.subplots(len(engines), 1, squeeze=False, sharex=True, height_ratios=heights)
    for axes, engine, (ordered, others) in zip(panels[:, 0], engines, shown, strict=True):
        _one_engine(axes, ordered, others)
        axes.set_title(engine, fontsize=10, pad=3.0)
    panels[-1, 0].set_xlabel("relative error  [–]", fontsize=9)
    drawing.suptitle(
        f"{MATTER} changes to each engine, those of each preset that matter most, from the "
        "smallest error down",
        fontsize=10,
    )
    handles = _handles(set(lines["preset"]))
    drawing.legend(handles=handles, loc="outside lower center", ncols=3, frameon=False, fontsize=8)
    return drawing


def _one_engine(axes: Axes, ordered: pd.DataFrame, others: pd.DataFrame) -> None:
    axes.set(xscale="log", xlim=(LOWEST / 2.0, HIGHEST), ylim=(len(ordered) + 0.5, -0.7))
    axes.axvspan(1.0, HIGHEST, color="#eeeeee", zorder=-1)
    for place, (_, line) in enumerate(ordered.iterrows()):
        _one_variant(axes, place, line)
    for preset in ordered["preset"].unique():
        _baseline(axes, ordered, preset)
    axes.set_yticks(range(len(ordered)), [_label(line) for _, line in ordered.iterrows()])
    for text, (_, line) in zip(axes.get_yticklabels(), ordered.iterrows(), strict=True):
        text.set(fontsize=8, color=told(str(line["preset"])).colour)
        if not line["factor"]:
            text.set_fontweight("bold")
    axes.axhline(len(ordered) - 0.5, color="#999999", linewidth=0.8)
    axes.text(0.7 * LOWEST, len(ordered), _summed(others), fontsize=8, style="italic", va="center",
              color="#555555")  # fmt: skip
    axes.grid(axis="x", alpha=0.25)


def _ordered(lines: pd.DataFrame) -> tuple[pd.DataFrame, pd.DataFrame]:
    """Return an engine's presets with the variants that matter, and the other variants.

    Of each preset in turn the one that breaks most cases, or else moves a peak or an impact most;
    they stand by preset, from the most accurate in peak and impact to the failed.
    """
    broken = lines["worse"] | lines["max_error"].isna()
    lines = lines.assign(
        broken=broken,
        lost=(lines["failed"] + lines["wrong"]).where(broken, 0),
        matter=lines[["moved", "ratio_moved"]].max(axis=1).fillna(0.0),
    )
    varied = lines[lines["factor"] != ""].sort_values(
        ["broken", "lost", "matter"], ascending=False, kind="stable"
    )
    turn = varied.groupby("preset").cumcount().sort_values(kind="stable")
    varied = varied.loc[turn.index]
    drawn = pd.concat([lines[lines["factor"] == ""], varied.head(MATTER)])
    return _by_error(drawn), varied.iloc[MATTER:]


def _by_error(lines: pd.DataFrame) -> pd.DataFrame:
    keyed = lines.assign(
        first=-lines["preset"].map(in_order(lines["preset"]).index),
        own=lines["factor"] != "",
        worst=lines["max_error"].clip(lower=(lines["ratio_over_eta"] - 1.0).abs()),
    )
    return keyed.sort_values(["first", "own", "broken", "worst"])


def _summed(others: pd.DataFrame) -> str:
    """Return one line on the variants that are not drawn."""
    if others.empty:
        return "no other changes"
    kept, lost = others[~others["broken"]], int(others["broken"].sum())
    words = [f"{lost} break a case"] * bool(lost)
    if len(kept):
        moved = part(float(kept["moved"].max()))
        words.append(f"{len(kept) if lost else 'they'} move a peak by {moved} at most")
    return f"{len(others)} others matter less: {', '.join(words)}"


def _one_variant(axes: Axes, place: int, line: pd.Series[Any]) -> None:
    colour = told(str(line["preset"])).colour
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
    axes.plot([base.iloc[0]] * 2, [places[0] - 0.5, places[-1] + 0.5], color=told(preset).colour,
              linewidth=1.0, linestyle="--", zorder=0)  # fmt: skip
    axes.axhline(places[0] - 0.5, color="#999999", linewidth=0.8)


def _label(line: pd.Series[Any]) -> str:
    name = f"{line['factor']}: {line['level']}" if line["factor"] else str(line["level"])
    return f"{name}  [trap]" if line["trap"] else name


def _handles(presets: set[str]) -> list[Line2D]:
    plain: dict[str, Any] = {"linestyle": "none", "marker": "o"}
    return [
        *(Line2D([], [], color=told(name).colour, label=told(name).varied, **plain)
          for name in reversed(in_order(presets))),
        Line2D([], [], color="#666666", linestyle="--", label="the preset as it is"),
        Line2D([], [], color="#666666", marker="o", label="peak, median to largest error"),
        Line2D([], [], color="#444444", linestyle="none", marker="D", markersize=4,
               markerfacecolor="none", label="velocity ratio against Housner's η, median"),
        Line2D([], [], color="#000000", linestyle="none", marker="X", label="failed"),
        Line2D([], [], color="#000000", linestyle="none", marker="s", markerfacecolor="none",
               label="wrong outcome"),
    ]  # fmt: skip
