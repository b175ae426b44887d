"""What is held against the exact solution of a block on a cart, beside the block's peak."""

import math

import numpy as np

from analytic.response import Response

FASTEST = 0.5
"""Impacts count whose velocity is at least this part of the fastest: those after it are few steps
apart, and tell more of the step than of the impact."""


def place_error(response: Response, exact: Response) -> float:
    """Return the largest difference of a cart's place, while both responses last.

    Parameters
    ----------
    response, exact : Response
        With histories at the same times, of which one may end before the other.

    Returns
    -------
    float
        [m]; nan where one has no history of its base.
    """
    if response.history is None or exact.history is None:
        return math.nan
    ours, its = response.history.base, exact.history.base
    if ours is None or its is None or not min(ours.shape[1], its.shape[1]):
        return math.nan
    both = min(ours.shape[1], its.shape[1])
    return float(np.abs(ours[0, :both] - its[0, :both]).max())


def impact_ratio(response: Response) -> float:
    """Return the median velocity ratio of the fast impacts of a response; nan without any."""
    struck = [impact for impact in response.impacts if impact.velocity_before]
    fastest = max((abs(impact.velocity_before) for impact in struck), default=0.0)
    fast = [one.ratio for one in struck if abs(one.velocity_before) >= FASTEST * fastest]
    return float(np.median(fast)) if fast else math.nan
