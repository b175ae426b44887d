"""Pictures with a row for each engine: presets, contact settings, extreme and random cases."""

from itertools import pairwise
from math import inf
from textwrap import fill

import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from engines.declaration import AT_REST
from engines.factors import BEST, DEFAULT
from studies.drawing.facets import dot, error_scale, key, panels, preset_dots, rows, sheet
from studies.drawing.styles import LOWEST, full_name, style_of, title_of
from studies.kit.say import part
from studies.measures.differences import sensitivity_of
from studies.measures.presets import in_order, look_of

MOST = 3
"""Settings of an engine that are drawn."""
END = 10.0
"""End of the scale of errors, to which a setting is drawn with which a case fails."""
DIFFER = 6
"""How many cases are drawn: those that the last preset predicts most often beyond the first."""
BANDS = (0.0, 3.0, 10.0, 100.0, inf)
"""Where bands of the sensitivity S end."""


def draw_overview(table: pd.DataFrame) -> Figure:
    """Draw errors and run times of presets: engines as rows, presets as dots."""
    table = table[table["preset"] != AT_REST]  # a variant, which the table has
    engines, presets = list(dict.fromkeys(table["engine"])), in_order(table["preset"])
    size = (8.6, 1.9 + 0.125 * len(presets) * len(engines))
    drawing, (errors, times) = sheet(size, 1, 2, sharey=True, width_ratios=(1.7, 1.0))
    for line in table.to_dict("records"):
        place = presets.index(str(line["preset"])) - 0.5 * (len(presets) - 1)
        y = engines.index(str(line["engine"])) + 0.76 * place / len(presets)
        colour = look_of(str(line["preset"])).colour
        errors.plot([line["median"], line["max"]], [y, y], color=colour, lw=2.4, alpha=0.45)
        errors.plot(line["median"], y, "|", color=colour, markersize=7)
        errors.plot(line["max"], y, "o", color=colour, markersize=5.5)
        times.plot(line["ms"], y, "o", color=colour, markersize=5.5)
        if line["wrong"]:
            errors.annotate(f"{line['wrong']:.0f} wrong", (line["max"], y), (6, 0), color=colour,
                            textcoords="offset points", fontsize=8.5, va="center")  # fmt: skip
    for axes in (errors, times):
        rows(axes, [title_of(name) for name in engines], 11.0)
        axes.set(xscale="log")
        axes.grid(axis="y", visible=False)
        for place in range(1, len(engines)):
            axes.axhline(place - 0.5, color="#cccccc", linewidth=0.8)
    low, high = errors.get_xlim()
    errors.set_xlim(low, 8.0 * high)  # for the words
    error_scale(errors.xaxis, low, max(high, 1.0))
    errors.set_xlabel("error of the largest rotation:\nmedian (bar) to largest (dot)", fontsize=10)
    times.xaxis.set_major_formatter("{x:g}")
    times.set_xlabel("run time of a case  [ms]", fontsize=10)
    most = {name: part(table.loc[table["preset"] == name, "max"].max()) for name in presets}
    words = [f"by up to {most[name]} {look_of(name).words}" for name in (presets[0], presets[-1])]
    head = f"In {table['cases'].max():.0f} cases peaks are off {words[0]},\n{words[1]}"
    drawing.suptitle(head, fontsize=12)
    key(drawing, preset_dots(presets), 5, fontsize=10, handletextpad=0.2, columnspacing=1.2)
    return drawing


def draw_contact(left: pd.DataFrame) -> Figure:
    """Draw the largest error as tuned, and with one setting alone left at its default."""
    drawn = left.groupby("engine", sort=False).head(MOST).reset_index(drop=True)
    drawing, (axes,) = sheet((8.6, 1.6 + 0.24 * len(drawn)))
    tuned, default = look_of(BEST).colour, look_of(DEFAULT).colour
    rows(axes, list(drawn["factor"]))
    least = 0.05 * float(drawn[["as_tuned", "max_error"]].min().min())  # left of it are names
    axes.set(xscale="log", xlim=(least, END), xlabel="largest error of typical peaks")
    error_scale(axes.xaxis, max(least, 1e-3), 1.0, 1)
    for place, line in enumerate(drawn.to_dict("records")):
        lost = int(line["failed"] + line["wrong"]) if line["worse"] else 0
        error = END if line["failed"] else min(line["max_error"], END)
        axes.plot([line["as_tuned"], error], [place] * 2, color=default, lw=2.4, alpha=0.5)
        axes.plot(line["as_tuned"], place, "|", color=tuned, markersize=9, markeredgewidth=2)
        axes.plot(error, place, "o" if error < END else ">", color=default, clip_on=False)
        if lost:
            kind = "without result" if line["failed"] else "wrong"
            axes.annotate(f"{lost} {kind}", (error, place), (-8, 0), fontsize=8.5, ha="right",
                          va="bottom", textcoords="offset points")  # fmt: skip
    for engine, of in drawn.groupby("engine", sort=False):
        axes.axhline(of.index[0] - 0.5, color="#aaaaaa", linewidth=0.8)
        axes.text(0.01, of.index.to_numpy().mean(), title_of(str(engine)), va="center",
                  fontsize=11, fontweight="bold", transform=axes.get_yaxis_transform())  # fmt: skip
    drawing.suptitle("Errors with a tuned contact, and with one setting left at its default")
    handles = [dot("as tuned", "|", tuned, markersize=9, markeredgewidth=2)]
    key(drawing, [*handles, dot("this setting at its default", "o", default)], 2)
    return drawing


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


def draw_conditioning(errors: pd.DataFrame) -> Figure:
    """Draw the errors of cases by how far small errors move their peaks."""
    sizes = errors.assign(s=sensitivity_of(errors), size=errors["error"].abs())
    sizes = sizes[sizes["size"].notna() & sizes["s"].notna()]
    sources = list(errors["source"].unique())
    bands = {ends: sizes[sizes["s"].between(*ends, inclusive="left")] for ends in pairwise(BANDS)}
    bands = {ends: cases for ends, cases in bands.items() if len(cases)} or {BANDS[:2]: sizes}
    each = (10.4 / len(bands), 0.9 + 0.26 * len(sources))
    drawing, grid = panels(len(bands), len(bands), each, 1.1, sharex=True, sharey=True)
    low, high = sizes["size"].clip(lower=LOWEST).agg(["min", "max"]).fillna(1.0)
    grid[0].set(xscale="log", xlim=(0.5 * low, 2.0 * max(high, 1.0)))
    error_scale(grid[0].xaxis, *grid[0].get_xlim())
    for axes, ((start, end), cases) in zip(grid, bands.items(), strict=True):
        rows(axes, [full_name(source) for source in sources], 10.0)
        for source, size in cases.groupby("source")["size"]:
            look = {"color": style_of(str(source)).colour}
            axes.boxplot(
                size.clip(lower=LOWEST), positions=[sources.index(source)], widths=0.55,
                orientation="horizontal", whis=(0, 100), patch_artist=True, manage_ticks=False,
                medianprops={"color": "black"}, whiskerprops=look, capprops=look,
                boxprops={"facecolor": look["color"], "alpha": 0.6, "edgecolor": look["color"]},
            )  # fmt: skip
        words = f"from {start:g}" if end == inf else f"{start:g} to {end:g}" if start else "below 3"
        axes.set_title(f"S {words}: {cases['case'].nunique()} cases", fontsize=10)
        axes.tick_params("x", labelsize=8.0)
    drawing.supxlabel(
        "relative error of the peak;  S: by how many per cent a peak moves for 1 % of the pulse "
        "or of an impact's velocity ratio",
        fontsize=10,
    )
    drawing.suptitle("Errors of the peak grow with the sensitivity S of a case", fontsize=12)
    return drawing
