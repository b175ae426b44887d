"""Thresholds of overturning held against closed forms and against the literature.

What could be read of the literature is its formulas as later papers and `analytic.criteria` quote
them. The tables and figures of Makris and Roussos (2000) and of Zhang and Makris (2001) could not
be read, so no number of theirs stands here.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pandas as pd

from analytic.block import RigidBlock
from analytic.criteria import overturning_amplitude, overturning_velocity
from analytic.maps import overturning_modes
from analytic.models import MODELS
from studies.cases.window import Window

HOUSNER_1963 = "Housner (1963): sqrt(1 + (ω/p)²), which drops the exponential"
CRITERION = "the criterion with the exponential (Shi and others 1996, Makris and Roussos 2000)"
VELOCITY = "one velocity step, 4 R p sqrt(2 (1 - cos α)) / (3 cos α)"
RATIOS = (1.0, 2.0, 4.0, 8.0)
SHORT = 1e5
"""ω/p of a pulse that is short beside the block's own time."""


def threshold(overturns: Callable[[float], bool], low: float, high: float) -> float:
    """Return where a monotone outcome changes, by bisection to rounding."""
    while high - low > 4e-16 * high:
        middle = 0.5 * (low + high)
        if middle in (low, high):
            break
        low, high = (low, middle) if overturns(middle) else (middle, high)
    return high


def checks(window: Window) -> pd.DataFrame:
    """Return the checks: what was found, the value and the source that it is held against.

    At the slenderness of the middle of the window.
    """
    middle = np.array(0.5 * (window.low + window.high))
    alpha = float(window.alpha(middle))
    linear = [name for name, model in MODELS.items() if model.linear]
    posed = itertools.product((1, 2), linear, RATIOS)
    rows = [without_impact(model, alpha, ratio, cycles) for cycles, model, ratio in posed]
    return pd.DataFrame([*rows, *map(housner, RATIOS), short_pulse(alpha)])


def without_impact(model: str, alpha: float, ratio: float, half_cycles: int) -> dict[str, object]:
    """Return the threshold of overturning without impact, over the onset, and the criterion."""
    law = MODELS[model].law(alpha, 0.9)
    expected = overturning_amplitude(ratio / law.k, half_cycles)

    def overturns(onsets: float) -> bool:
        amplitude = onsets * law.onset
        return bool(overturning_modes(alpha, amplitude, ratio, half_cycles, model).mode == 0)

    found = threshold(overturns, expected * 0.99, expected * 1.01)
    pulse = "half-sine" if half_cycles == 1 else "full-sine"
    name = f"{model}, {pulse}, ω/p = {ratio:g}, no impact, over the onset"
    return {"check": name, "found": found, "against": CRITERION, "expected": expected}


def housner(ratio: float) -> dict[str, object]:
    """Return Housner's linearization under a half-sine, beside Housner's own formula."""
    alpha = 0.1
    expected = math.hypot(1.0, ratio)

    def overturns(onsets: float) -> bool:
        return bool(overturning_modes(alpha, onsets * alpha, ratio, 1, "housner").mode >= 0)

    found = threshold(overturns, 1.0, expected * 1.01)
    name = f"housner, half-sine, ω/p = {ratio:g}, over the onset"
    return {"check": name, "found": found, "against": HOUSNER_1963, "expected": expected}


def short_pulse(alpha: float) -> dict[str, object]:
    """Return the velocity 2 a_p/ω of the least short half-sine that overturns the exact block."""
    block = RigidBlock(width=math.sin(alpha), height=math.cos(alpha))
    expected = overturning_velocity(block)

    def overturns(velocity: float) -> bool:
        amplitude = 0.5 * velocity * SHORT * block.p / block.gravity
        return bool(overturning_modes(alpha, amplitude, SHORT, 1).mode == 0)

    found = threshold(overturns, 0.5 * expected, 2.0 * expected)
    name = f"exact, half-sine, ω/p = {SHORT:g}, its velocity [m/s]"
    return {"check": name, "found": found, "against": VELOCITY, "expected": expected}
