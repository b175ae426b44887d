"""A history as a table."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import pandas as pd

from analytic.motion import Motion
from analytic.response import Response
from engines.scene import System


def samples(
    response: Response, system: System, motion: Motion, labels: Mapping[str, Any]
) -> pd.DataFrame:
    """Return the history of a response as a table: labels, outcome, motion of ground and block."""
    history = response.history
    assert history is not None
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
