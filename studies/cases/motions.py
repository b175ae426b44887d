"""Families of random ground motions, each motion known by its seed."""

import math
from collections.abc import Callable, Mapping

import numpy as np

from analytic.record import Record
from analytic.synthetic import kanai_tajimi, near_fault, ricker

Family = Callable[[int], Record]


def noise(seed: int) -> Record:
    """Return 12 s of noise on firm soil, strong for 3 s."""
    return kanai_tajimi(seed, peak=1.0, duration=12.0, omega=12.0, rise=2.0, fall=5.0)


def pulses(seed: int) -> Record:
    """Return a near-fault pulse of 0.5 to 2 Hz, of 1.2 to 3 cycles and any phase."""
    draw = np.random.default_rng(seed)
    frequency = math.exp(draw.uniform(math.log(0.5), math.log(2.0)))
    gamma, phase = draw.uniform(1.2, 3.0), draw.uniform(0.0, 2.0 * math.pi)
    return near_fault(1.0, frequency, gamma, phase).scaled_to(1.0)


def wavelets(seed: int) -> Record:
    """Return a Ricker wavelet of 0.5 to 4 Hz."""
    draw = np.random.default_rng(seed)
    return ricker(1.0, math.exp(draw.uniform(math.log(0.5), math.log(4.0))))


FAMILIES: Mapping[str, Family] = {"noise": noise, "near-fault": pulses, "ricker": wavelets}
"""Name -> the motion of a seed, its largest absolute acceleration being 1 m/s2."""
