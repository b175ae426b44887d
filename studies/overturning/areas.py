"""A folder's map read back: its tables, its window, and the mode at any point of it."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pandas as pd

from analytic.criteria import overturning_amplitude
from analytic.models import MODELS
from analytic.motion import FloatArray
from analytic.response import Outcome
from studies.cases.window import Window
from studies.kit import provenance
from studies.measures.wrongness import FALL, kinds_of


def window_of(folder: Path) -> Window:
    """Return the window that a folder's map is of, from its provenance."""
    return Window(**provenance.record_of(folder)["settings"]["window"])


def modes_at(areas: pd.DataFrame, x: FloatArray, onsets: FloatArray) -> FloatArray:
    """Return the modes at every pair of a column's abscissa and an amplitude, (len(x), n)."""
    groups = {float(str(at)): group for at, group in areas.groupby("x")}
    known = np.array(sorted(groups))
    found = np.empty((len(x), len(onsets)))
    for i, at in enumerate(x):
        group = groups[float(known[np.argmin(abs(known - at))])]
        place = np.searchsorted(group["low"].to_numpy(), onsets, side="right") - 1
        found[i] = group["mode"].to_numpy()[np.maximum(place, 0)]
    return found


def with_verdicts(engines: pd.DataFrame, window: Window) -> pd.DataFrame:
    """Return the engines' cells with the exact mode, the verdict and the impacts."""
    mode = window.modes(engines["x"].to_numpy(), engines["onsets"].to_numpy()).mode
    # no pulse of the map is too weak to lift the block
    right = np.where(mode >= 0, Outcome.OVERTURNED.value, Outcome.ROCKED.value)
    wrong = kinds_of(engines["outcome"], right)
    verdict = np.where(wrong == FALL, np.where(mode >= 0, "missed", "false"), wrong)
    verdict = np.where(wrong == "", "right", verdict)
    return engines.assign(exact_mode=mode, verdict=verdict)


def no_impact_line(x: FloatArray, window: Window, model: str) -> FloatArray:
    """Return the closed-form amplitude of overturning without impact over g tan(alpha)."""
    line = np.full(len(x), math.nan)
    for i, (alpha, ratio) in enumerate(zip(window.alpha(x), window.ratio(x), strict=True)):
        law = MODELS[model].law(float(alpha), 0.9)
        try:
            amplitude = overturning_amplitude(float(ratio) / law.k, window.half_cycles)
        except ValueError:
            continue
        line[i] = amplitude * law.onset / math.tan(alpha)
    return line
