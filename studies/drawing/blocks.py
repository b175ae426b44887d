"""The blocks of a list, ranked by the factor on a record that overturns them first."""

from collections.abc import Iterable, Sequence
from typing import Any

import matplotlib as mpl
import numpy as np
import pandas as pd
from matplotlib import rc_context
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.font_manager import fontManager
from matplotlib.lines import Line2D
from scipy.stats import norm

from studies.drawing.facets import key, sheet
from studies.drawing.styles import look_at

MOST_RECORDS = 5
"""Records that are drawn one by one."""
MOST_NAMED = 6
"""Curves with a name in the key, of the blocks that overturn first."""
MOST_DRAWN = 60
"""Blocks in the picture, those that overturn first."""
FONTS = (
    *("DejaVu Sans", "Noto Sans CJK JP", "Noto Sans JP", "IPAexGothic", "Yu Gothic"),
    *("Hiragino Sans", "Meiryo", "Microsoft YaHei", "PingFang SC", "WenQuanYi Zen Hei"),
    *("Malgun Gothic", "Noto Sans Devanagari", "Noto Sans Thai", "Noto Emoji"),
    *("Segoe UI Emoji", "Symbola"),
)
"""Fonts that are used where they are installed; the first comes with matplotlib."""


def draw_blocks(lines: pd.DataFrame, scales: Sequence[float], title: str) -> Figure:
    """Draw, for each block and record, the factors from lifting to overturning."""
    records = [*dict.fromkeys(lines.sort_index()["record"])]
    names = [*dict.fromkeys(lines["name"])]
    kept = f"; these {MOST_DRAWN} first" if len(names) > MOST_DRAWN else ""
    names = names[:MOST_DRAWN]
    many = len(records) > MOST_RECORDS
    fonts = families([title, *names, *records])
    with rc_context({"font.family": fonts, "text.parse_math": False}):
        drawing, (axes,) = sheet(
            (8.0, 1.9 + len(names) * max(0.21, 0.0 if many else 0.1 * len(records)))
        )
        key_of = dict[int, Line2D]()
        for level, name in enumerate(names if many else ()):
            key_of |= _draw_spread(axes, lines[lines["name"] == name], level)
        one_by_one = lines[lines["name"].isin(() if many else names)]
        for line in one_by_one.to_dict("records"):
            place = records.index(line["record"])
            shift = 0.6 * ((place + 0.5) / len(records) - 0.5)
            found = _draw_line(axes, line, names.index(line["name"]) + shift, place)
            key_of.setdefault(place, found)
        for scale in scales:
            asked = axes.axvline(scale, label="scale asked for", zorder=0.5, color="#666666",
                                 linewidth=0.8, linestyle=(0, (5, 4)))  # fmt: skip
        axes.set(xscale="log", ylim=(len(names) - 0.4, -0.6), xlabel="factor on the record  [–]")
        _name_factors(axes)
        axes.set_yticks(range(len(names)), map(_short, names), fontsize=8)
        axes.grid(axis="y", alpha=0.2)
        axes.set_title(title + kept, fontsize=10, wrap=True)
        handles = [key_of[place] for place in sorted(key_of)]
        key(drawing, [*handles, asked], min(len(handles) + 1, 2 if many else 4), 10.0)
    return drawing


def _draw_spread(axes: Axes, lines: pd.DataFrame, level: int) -> dict[int, Line2D]:
    """Draw the factors that overturn a block under many records; return what the key says."""
    margins, colour = lines["margin"].dropna(), look_at(0)[0]
    finite = np.sort(margins[np.isfinite(margins)])
    counts = lines["no_margin"].value_counts().drop("", errors="ignore").to_dict()
    counts |= {"none found": len(margins) - len(finite)}
    texts = [f"{word}: {count} of {len(lines)}" for word, count in counts.items() if count]
    axes.annotate("; ".join(texts) + " ", (1.0, level - 0.3), xycoords=("axes fraction", "data"),
                  ha="right", va="center", fontsize=6, color="#666666")  # fmt: skip
    looks: tuple[dict[str, Any], ...] = (
        {"linewidth": 0.8, "label": "least to largest factor that overturns"},
        {"linewidth": 3.0, "alpha": 0.5, "label": "16 to 84 % of the records"},
        {"linestyle": "none", "marker": "o", "markersize": 4.5, "label": "median"},
    )
    ends = ([0.0, 1.0], [0.16, 0.84], [0.5])
    if len(finite):
        for parts, look in zip(ends, looks, strict=True):
            places = np.quantile(finite, parts)
            axes.plot(places, [level] * len(places), color=colour, **look)
    return {at: Line2D([], [], color=colour, **look) for at, look in enumerate(looks)}


def draw_fragility(fits: pd.DataFrame, lines: pd.DataFrame) -> Figure:
    """Draw the part of the records that overturns each block, by their factor."""
    fits = fits[(fits["measure"] == "factor") & fits["theta"].notna()]
    drawing, (axes,) = sheet((8.0, 4.2))
    with rc_context({"font.family": families(fits["name"].tolist()), "text.parse_math": False}):
        for place, fit in enumerate(fits.to_dict("records")):
            whole = place == len(fits) - 1
            factors = fit["theta"] * np.exp(np.linspace(-3.0, 3.0, 121) * max(fit["beta"], 1e-3))
            chance = norm.cdf(np.log(factors / fit["theta"]) / max(fit["beta"], 1e-3))
            colour, width = ("black", 2.2) if whole else (look_at(place)[0], 0.9)
            count = f"{_short(fit['name'])}, {fit['records']} records"
            label = count if whole or place < MOST_NAMED else None
            axes.plot(factors, chance, color=colour, linewidth=width, label=label)
        ends = [fit["theta_low"], fit["theta_high"]]
        axes.plot(ends, [0.5, 0.5], color="black", linewidth=5.0, alpha=0.4,
                  label="its median, 90 % interval")  # fmt: skip
        least = np.sort(lines.groupby("record")["margin"].min().dropna())
        parts = (np.arange(len(least)) + 0.5) / len(least)
        axes.plot(least[np.isfinite(least)], parts[np.isfinite(least)], ".", color="black",
                  label="least factor of each record")  # fmt: skip
        axes.legend(fontsize=8, frameon=False, loc="lower right")
        axes.set(xscale="log", ylim=(0.0, 1.0), xlabel="factor on the record  [–]",
                 ylabel="part of the records that overturn")  # fmt: skip
        _name_factors(axes)
        axes.grid(alpha=0.2)
    return drawing


def _name_factors(axes: Axes) -> None:
    """Name the powers of ten, and between them only what leaves room."""
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(lambda x, _: f"{x:g}" if f"{x:e}"[0] in "23457" else "")
    axes.tick_params(axis="x", which="both", labelsize=9)


def _draw_line(axes: Axes, line: dict[Any, Any], level: float, place: int) -> Line2D:
    """Draw the factors of a block under a record, and return what stands for that in the key."""
    colour, marker = look_at(place)
    look: dict[str, Any] = {"color": colour, "marker": marker, "markersize": 4.5, "linewidth": 1.2}
    if words := line["no_margin"] or ("none found" if np.isinf(line["margin"]) else ""):
        axes.annotate(f"{words} ", (1.0, level), xycoords=("axes fraction", "data"), ha="right",
                      va="center", fontsize=7, color=colour)  # fmt: skip
    else:
        axes.plot([line["lifts"], line["margin"]], [level] * 2, markevery=[1], **look)
    label = f"{_short(line['record'])}: lifts to overturns"
    return Line2D([], [], label=label, **look)


def _short(name: str) -> str:
    return name if len(name) <= 24 else f"{name[:23]}…"


def families(words: Iterable[str]) -> list[str]:
    """Return the fonts that such words are drawn in, as rcParams["font.family"] takes them."""
    usual: list[str] = mpl.rcParams["font.family"]
    there = set(fontManager.get_font_names())
    return usual if all(map(str.isascii, words)) else [name for name in FONTS if name in there]
