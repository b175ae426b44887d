"""A history as a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from analytic.motion import Motion
from analytic.response import Response
from engines.layouts import System


def samples(
    response: Response, system: System, motion: Motion, labels: Mapping[str, Any]
) -> pd.DataFrame:
    """Return the history of a response as a tidy table, with the ground acceleration.

    A row for each sample: the labels, outcome, time_s [s], ground_g [g], theta_ratio (theta/alpha)
    and velocity_rad_s [rad/s]; ValueError if the response has no history.
    """
    history = response.history
    if history is None:
        raise ValueError("the response has no history")
    return pd.DataFrame(
        {
            **labels,
            "outcome": response.outcome.value,
            "time_s": history.time,
            "ground_g": motion.acceleration(history.time) / system.gravity,
            "theta_ratio": history.theta / system.alpha,
            "velocity_rad_s": history.velocity,
        }
    )
