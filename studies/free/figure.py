"""The errors of period, decay and drift in free rocking, over the tilt of the release."""

from __future__ import annotations

import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.labels import Name, beside
from studies.drawing.styles import LOWEST, line_of, name_of, style_of


def draw_free(rows: pd.DataFrame) -> Figure:
    """Draw the errors of period and decay and the drift over the tilt, a line for each source."""
    drawing = Figure(figsize=(9.2, 4.2), layout="constrained")
    panels = drawing.subplots(1, 3, sharex=True, sharey=True)
    titles = {
        "period_error": "time between two impacts",
        "decay_error": "rotation after an impact",
        "drift_p": "drift over 20 impacts  [1/p]",
    }
    for axes, (column, title) in zip(panels, titles.items(), strict=True):
        ends = []
        for source, part in rows.groupby("source", sort=False):
            style = style_of(str(source))
            worst = part[column].abs().groupby(part["tilt"]).max().clip(lower=LOWEST)
            look = {**style.points(), "linestyle": line_of(str(source)), "linewidth": style.width}
            axes.plot(worst.index, worst, **look)
            ends.append(
                Name(name_of(str(source)), worst.index[-1], float(worst.iloc[-1]), style.colour)
            )
        axes.set(yscale="log")
        axes.set_title(title, fontsize=10)
        axes.set_xlabel("released from  θ0/α  [–]")
        axes.grid(alpha=0.25)
    panels[0].set_ylabel("error, relative but for the drift")
    beside(panels[-1], ends)
    drawing.suptitle("Off from the closed form of each one's equations, the largest over all H/B",
                     fontsize=11)  # fmt: skip
    return drawing
