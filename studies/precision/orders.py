"""The order of a method: the power of the step with which its error falls."""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from studies.precision.methods import Method


def observed_order(line: pd.DataFrame, method: Method) -> tuple[float, float]:
    """Return the order of the median error in the step with its standard error; nan if unclear.

    A line through the logarithms, over the settings whose error is above three times the floor, and
    that are coarser than the one that reaches it: beyond, rounding makes the error grow again.
    """
    usable = line[(line["failed"] == 0) & np.isfinite(line["median_error"])]
    floor = usable["median_error"].min()
    reached = usable["value"][usable["median_error"] == floor].max()
    usable = usable[(usable["median_error"] > 3.0 * floor) & (usable["value"] > reached)]
    usable = usable[usable["median_error"] < 0.3]
    if not method.stepping or len(usable) < 3:
        return math.nan, math.nan
    x, y = np.log(usable["value"]), np.log(usable["median_error"])
    (slope, _), covariance = np.polyfit(x, y, 1, cov="unscaled")
    residual = y - np.polyval(np.polyfit(x, y, 1), x)
    spread = math.sqrt(float((residual**2).sum()) / max(len(x) - 2, 1) * covariance[0, 0])
    return float(slope), spread
