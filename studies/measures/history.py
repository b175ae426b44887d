"""A history as a table, and its energy of free rocking: what a method loses or adds by itself."""

from __future__ import annotations

import itertools
import math
from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from analytic import History, Response, Rocker
from analytic.motion import FloatArray, Motion
from engines.scene import System

SAMPLES = 400
"""Samples of a history from which energies are read."""
NEAR = 0.15
"""Part of a flight at either end in which a coarse step may still feel the impact."""


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


def energy(block: Rocker, history: History) -> FloatArray:
    """Return the exact model's energy of each sample, over m g R."""
    y = np.abs(history.theta)
    kinetic: FloatArray = 0.5 * (history.velocity / block.p) ** 2
    return kinetic + 2.0 * np.sin(block.alpha - 0.5 * y) * np.sin(0.5 * y)


def growth(block: Rocker, motion: Motion, response: Response) -> float:
    """Return by how much energy rises in free rocking, which can only lose it, over its largest."""
    history = response.history
    if history is None or len(history.time) < 2:
        return math.nan
    every = energy(block, history)
    edges = [motion.duration, *(i.time for i in response.impacts if i.time >= motion.duration)]
    margin = 2.0 * float(history.time[1] - history.time[0])
    parts = []
    for start, end in itertools.pairwise(edges):
        apart = max(margin, NEAR * (end - start))
        inside = (history.time > start + apart) & (history.time < end - apart)
        if np.count_nonzero(inside) > 1:
            parts.append(every[inside])
    if not parts:
        return math.nan
    energies = np.concatenate(parts)
    rise = float((energies - np.minimum.accumulate(energies)).max())
    return rise / float(energies.max()) if rise > 0.0 else 0.0
