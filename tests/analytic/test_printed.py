"""Numbers printed in the literature: steady shaking, and thresholds of overturning.

Sources: Hogan, 10th World Conference on Earthquake Engineering 1992; Makris and Roussos 2000;
Zhang and Makris 2001; PEER report 2001/07.
"""

import math

import numpy as np
import pytest
from independent import peak_and_impacts

from analytic import Outcome, RigidBlock, SinePulse, simulate

G = 9.81
COSINE = 0.5 * math.pi


def block_of(alpha, p, restitution=math.nan):
    """Return the block of a slenderness and a frequency parameter [rad/s]."""
    diagonal = 1.5 * G / p**2
    return RigidBlock(
        width=diagonal * math.sin(alpha),
        height=diagonal * math.cos(alpha),
        restitution=restitution,
    )


HOGAN = block_of(0.18, 3.0, restitution=0.88)
TABLE = {
    "A": (3.07, (0.3, 0.0), (3.2, 3.2)),
    "B": (1.9, (0.5, 0.0), (8.2, 6.0)),
    "C": (4.9, (0.4, 0.3), (3.8, 3.8)),
    "D": (4.14, (0.5, 0.3), (5.6, 4.0)),
}
"""Omega/p, the start in units of alpha and alpha p, the maxima in degrees, of Table 1."""


def shaken(point, half_cycles, model="exact", **options):
    """Return the response of Hogan's block under 2 alpha g cos(Omega t)."""
    omega, (tilt, rate), _ = TABLE[point]
    motion = SinePulse(
        amplitude=2.0 * HOGAN.alpha * G,
        omega=omega * HOGAN.p,
        half_cycles=half_cycles,
        phase=COSINE,
    )
    start = (tilt * HOGAN.alpha, rate * HOGAN.alpha * HOGAN.p)
    return motion, simulate(HOGAN, motion, model, start, **options)


def maxima(point, model="exact"):
    """Return the largest rotations [deg] to both sides in the last of a thousand periods."""
    motion, _ = shaken(point, 2000)
    times = np.linspace(motion.duration - 8.0 * math.pi / motion.omega, motion.duration, 20_001)
    theta = np.degrees(shaken(point, 2000, model, times=times)[1].history.theta)
    return sorted([theta.max(), -theta.min()], reverse=True)


@pytest.mark.parametrize("point", TABLE)
def test_steady_maxima_are_those_of_the_table(point):
    assert [round(float(top), 1) for top in maxima(point)] == list(TABLE[point][2])


def test_the_linear_model_does_not_make_the_table():
    assert maxima("B", "housner") == pytest.approx([9.1138, 4.9767], abs=1e-4)


@pytest.mark.parametrize("point", TABLE)
def test_long_shaking_is_the_sum_of_its_periods(point):
    """A period at a time, from the state that the last one left: nothing drifts with time."""
    periods = 600
    motion, _ = shaken(point, 2 * periods)
    whole = shaken(point, 2 * periods, times=[motion.duration])[1].history
    one = SinePulse(amplitude=motion.amplitude, omega=motion.omega, half_cycles=2, phase=COSINE)
    _, (tilt, rate), _ = TABLE[point]
    state = (tilt * HOGAN.alpha, rate * HOGAN.alpha * HOGAN.p)
    for _ in range(periods):
        history = simulate(HOGAN, one, start=state, times=[one.duration]).history
        state = (float(history.theta[0]), float(history.velocity[0]))
    # the phase of a time keeps 1e-16 of it, here some 4e-13 rad of a period
    assert float(whole.theta[0]) == pytest.approx(state[0], abs=1e-11)


def test_a_half_cycle_costs_the_same_however_many_there_were():
    steps = [shaken("B", count)[1].steps for count in (1000, 2000, 4000, 8000)]
    assert np.diff(steps) / [1000, 2000, 4000] == pytest.approx([4.5] * 3, rel=1e-2)


def threshold(block, motion, model, low, high):
    """Return the amplitude [g] between two at which the outcome changes, and the one at `high`."""
    outcomes = [simulate(block, motion(a), model).outcome for a in (low, high)]
    assert outcomes[0] is not outcomes[1]
    beyond = outcomes[1]
    while high - low > 1e-9 * high:
        middle = 0.5 * (low + high)
        if simulate(block, motion(middle), model).outcome is beyond:
            high = middle
        else:
            low = middle
    return high, beyond


def pulses(omega, half_cycles, phase=0.0):
    """Return the pulses of an amplitude in g."""
    return lambda a: SinePulse(amplitude=a * G, omega=omega, half_cycles=half_cycles, phase=phase)


ZHANG = block_of(0.25, 2.14, restitution=0.9)
THRESHOLDS = {
    "Makris and Roussos, half-sine, linear": (
        RigidBlock(width=0.4, height=1.2), pulses(2.0 * math.pi, 1), "housner",
        0.5535, 0.5545, 1e-4,
    ),
    "Makris and Roussos, one sine, linear": (
        RigidBlock(width=1.0, height=3.0), pulses(2.0 * math.pi, 2), "housner",
        0.4513, 0.4514, 2e-4,
    ),
    "Makris and Roussos, one cosine": (
        RigidBlock(width=1.0, height=3.0), pulses(2.0 * math.pi, 2, COSINE), "exact",
        0.6245, 0.6255, 4e-4,
    ),
    "PEER, p = 2": (
        block_of(math.radians(15.0), 2.0), pulses(math.pi, 2, COSINE), "exact", 0.315, 0.316, 0.0,
    ),
    "PEER, p = 1": (
        block_of(math.radians(15.0), 1.0), pulses(math.pi, 2, COSINE), "exact", 0.531, 0.532, 3e-4,
    ),
    "Zhang and Makris, begins": (
        ZHANG, pulses(5.0 * 2.14, 2), "housner", 3.00 * 0.25, 3.01 * 0.25, 0.01 * 0.25,
    ),
    "Zhang and Makris, ends": (
        ZHANG, pulses(5.0 * 2.14, 2), "housner", 6.32 * 0.25, 6.33 * 0.25, 0.01 * 0.25,
    ),
    "Zhang and Makris, begins again": (
        ZHANG, pulses(5.0 * 2.14, 2), "housner", 7.17 * 0.25, 7.18 * 0.25, 0.01 * 0.25,
    ),
    "Zhang and Makris, nonlinear": (ZHANG, pulses(15.7, 2), "exact", 2.21, 2.22, 4e-3),
    "Zhang and Makris, linear": (ZHANG, pulses(15.7, 2), "housner", 3.23, 3.24, 0.0),
}  # fmt: skip
"""Block, pulse of an amplitude [g], model, printed bracket [g], and by how much the print misses
the threshold, rounded up: a second integrator has it where it is found here."""


@pytest.mark.parametrize("name", THRESHOLDS)
def test_a_printed_threshold(name):
    block, motion, model, low, high, miss = THRESHOLDS[name]
    found, beyond = threshold(block, motion, model, low - miss, high + miss)
    for factor, same in ((1.0 - 1e-6, False), (1.0 + 1e-6, True)):
        peak, _ = peak_and_impacts(model, block, motion(factor * found))
        assert (math.isinf(peak) == (beyond is Outcome.OVERTURNED)) == same
