"""A history as a table."""

from __future__ import annotations

from typing import Any

import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import Motion
from analytic.response import Response


def samples(
    response: Response, block: RigidBlock, motion: Motion, labels: dict[str, Any]
) -> pd.DataFrame:
    """Return the history of a response as a tidy table, with the ground acceleration.

    Parameters
    ----------
    response : Response
        With a history.
    block, motion
        Whose response it is.
    labels : dict
        The first columns, the same in every row.

    Returns
    -------
    DataFrame
        A row for each sample: the labels, outcome, time_s [s], ground_g [g], theta_ratio
        (theta/alpha) and velocity_rad_s [rad/s].

    Raises
    ------
    ValueError
        If no history was asked for, or the response failed before it had one.
    """
    history = response.history
    if history is None:
        raise ValueError("the response has no history")
    return pd.DataFrame(
        {
            **labels,
            "outcome": response.outcome.value,
            "time_s": history.time,
            "ground_g": motion.acceleration(history.time) / block.gravity,
            "theta_ratio": history.theta / block.alpha,
            "velocity_rad_s": history.velocity,
        }
    )
