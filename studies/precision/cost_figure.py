"""What each thing put back into a scene costs and changes."""

from __future__ import annotations

import numpy as np
import pandas as pd
from matplotlib.figure import Figure

from studies.drawing.styles import LOWEST, style_of, title_of


def draw_scenes(scenes: pd.DataFrame) -> Figure:
    """Draw what each thing put back into a scene costs and changes, a dot for each engine.

    Parameters
    ----------
    scenes : DataFrame
        The columns of scenes.csv.
    """
    names = list(scenes["scene"].unique())
    engines = list(scenes["engine"].unique())
    drawing = Figure(figsize=(9.6, 1.4 + 0.4 * len(names)), layout="constrained")
    costs, errors = drawing.subplots(1, 2, sharey=True)
    for number, engine in enumerate(engines):
        rows = scenes[scenes["engine"] == engine].set_index("scene").loc[names]
        places = np.arange(len(names)) + 0.7 * ((number + 0.5) / len(engines) - 0.5)
        # what an engine has not takes no time
        taken, look = rows["wall_s"].where(rows["error"].notna()), style_of(engine).points(6.5)
        factor = taken / taken.iloc[0]
        costs.hlines(places, 1.0, factor, color=look["color"], linewidth=1.2)
        costs.plot(factor, places, **look)
        errors.plot(rows["error"].abs().clip(lower=LOWEST), places, **look, label=title_of(engine))
    costs.set_yticks(range(len(names)), names)
    costs.invert_yaxis()
    costs.set(xscale="log", xlabel="run time over the scene as it is  [–]")
    costs.axvline(1.0, color="#555555", linewidth=0.8)
    costs.set_xticks([0.5, 1, 2, 5, 10, 20], ["½", "1", "2", "5", "10", "20"])
    costs.set_xticks([], minor=True)
    errors.set(xscale="log", xlabel="relative error of the peak  [–]")
    for axes in (costs, errors):
        axes.grid(alpha=0.25)
    drawing.legend(loc="outside lower center", ncols=len(engines), frameon=False)
    return drawing
