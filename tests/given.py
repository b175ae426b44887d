"""What tests of many kinds begin with: a block, its onset, and pulses counted in both."""

import math
from dataclasses import asdict

import numpy as np

from analytic import Record, RigidBlock, SinePulse
from engines.world import Moment

BLOCK = RigidBlock(width=0.5, height=1.5)
G = BLOCK.gravity
FULL_SINE = SinePulse.in_g(0.4, omega=2.0 * math.pi, half_cycles=2)
PULSE = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
"""As `commanding.CASE` asks for it, who writes out what omega is."""
WANDERING = Record(dt=0.3, samples=[1.0, -2.0, 0.5, 3.0, 3.0, -1.0, 0.25])


def onset_of(block):
    """Return the acceleration [m/s2] at which a block lifts, g tan(alpha)."""
    return block.gravity * math.tan(block.alpha)


ONSET = onset_of(BLOCK)


def pulse(onsets, omega_over_p, half_cycles=1, block=BLOCK, phase=0.0):
    """Return a pulse whose amplitude counts in onsets of a block, and its frequency in p."""
    return SinePulse(
        amplitude=onsets * onset_of(block),
        omega=omega_over_p * block.p,
        half_cycles=half_cycles,
        phase=phase,
    )


def noise(seed, count, dt, peak, width=0.12):
    """Return a smooth random record of a seed or a generator, correlated over `width` [s]."""
    draw = np.random.default_rng(seed).normal(size=count)
    kernel = np.exp(-0.5 * (np.arange(-3 * width, 3 * width, dt) / width) ** 2)
    shaken = np.convolve(draw, kernel, mode="same") * np.sin(np.linspace(0, math.pi, count))
    return Record(dt=dt, samples=shaken).scaled_to(peak)


class Bare:
    """What every world must answer, and nothing more."""

    moment = Moment.END

    def step(self, step):
        pass

    def fault(self):
        return ""

    def close(self):
        pass


def all_but_times(response):
    """Return all fields of a response to the bit, but run times."""
    found = asdict(response)
    history = found.pop("history")
    kept = [] if history is None else [part for part in history.values() if part is not None]
    parts = [part.tolist() for part in kept]
    return repr({**found, "wall_s": 0.0, "setup_s": 0.0}) + repr(parts)
