"""The error with one tuned setting left at its default: the three that matter most an engine."""

import pandas as pd
from matplotlib.figure import Figure

from engines.factors import BEST, DEFAULT
from studies.drawing.facets import dot, error_scale, key, rows, sheet
from studies.drawing.styles import title_of
from studies.measures.presets import look_of

MOST = 3
"""Settings of an engine that are drawn."""
END = 10.0
"""End of the scale of errors, to which a setting is drawn with which a case fails."""


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
