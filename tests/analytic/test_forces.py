"""The contact forces that the reference needs: bounds, not samples."""

import math
from itertools import product

import numpy as np
import pytest
from given import BLOCK, G, pulse

from analytic import Outcome, Record, RigidBlock, SinePulse, Still, simulate


def sampled_forces(block, motion, history):
    """Return N/mg and abs(horizontal)/mg at the samples of a history, from its state."""
    theta, rate = history.theta, history.velocity / block.p
    a, s = motion.acceleration(history.time) / G, np.where(history.theta < 0, -1.0, 1.0)
    z = block.alpha - np.abs(theta)
    turning = -(np.sin(block.alpha * s - theta) + a * np.cos(block.alpha * s - theta))
    normal = 1.0 + 0.75 * (s * turning * np.sin(z) - rate**2 * np.cos(z))
    return normal, np.abs(a + 0.75 * (s * rate**2 * np.sin(z) + turning * np.cos(z)))


@pytest.mark.parametrize("seed", range(40))
def test_no_sample_of_a_response_is_beyond_the_limits(seed):
    """And come close; of a block that falls only those count before it is beyond θcr for good."""
    draw = np.random.default_rng(seed)
    block = RigidBlock(width=0.5, height=0.5 * draw.uniform(1.2, 8.0))
    motion = pulse(draw.uniform(1.05, 2.0), draw.uniform(0.5, 8.0), 3, block)
    times = np.linspace(0.0, motion.duration + 6.0 / block.p, 40_001)
    response = simulate(block, motion, duration=times[-1], times=times)
    normal, horizontal = sampled_forces(block, motion, response.history)
    rotation = np.abs(response.history.theta)
    counted = np.arange(rotation.size)
    if response.outcome is Outcome.OVERTURNED:
        counted = counted[: np.flatnonzero(rotation < block.alpha)[-1] + 1]
    here = counted[rotation[counted] > 1e-9]
    least, ratio = normal[here].min(), (horizontal / normal)[here].max()
    assert response.min_normal <= least + 1e-12
    assert response.min_normal == pytest.approx(least, abs=1e-3)
    if response.min_normal > 0.0:
        assert response.friction_needed >= ratio * (1 - 1e-12)
        assert response.friction_needed == pytest.approx(ratio, rel=2e-3)
    else:
        assert response.friction_needed == math.inf


SAMPLES = Record(dt=0.1, samples=0.225 * G * np.array([0.0, 0.4, -1.0, 0.2, 0.0]))


@pytest.mark.parametrize(
    "motion", [SAMPLES, *(SinePulse.in_g(0.225, omega=6.0, half_cycles=n) for n in (1, 40, 1000))]
)
def test_a_block_at_rest_needs_the_strongest_acceleration_there_is(motion):
    response = simulate(BLOCK, motion)
    assert response.outcome is Outcome.AT_REST
    assert response.friction_needed == pytest.approx(0.225, rel=1e-14)
    assert response.min_normal == 1.0


def test_the_forces_of_impacts_that_are_summed_count():
    """A block that hardly rebounds is pressed down on its other corner: N = 1 - 3/4 y'' sin a."""
    block = RigidBlock(width=1.0, height=8.2, restitution=0.001)
    motion = pulse(1.02, 5.0, 2, block)
    response = simulate(block, motion)
    a = float(motion.acceleration(response.rests[0])) / G
    # on the corner that the ground presses down
    pressed = math.sin(block.alpha) + abs(a) * math.cos(block.alpha)
    assert abs(a) < math.tan(block.alpha)
    least = 1.0 - 0.75 * pressed * math.sin(block.alpha)
    assert least < 0.98
    assert response.min_normal <= least + 1e-6


SQUAT, MIDDLE = (RigidBlock(width=0.5, height=height) for height in (0.75, 1.0))
SOME = (1.5, 2.0, 3.0, 5.0, 8.0)
FREE = {
    "rocks on": (SQUAT, pulse(40.0, 100.0, 1, SQUAT), (0.0, 0.0), 1e-12),
    # it comes down with more energy than it takes to overturn, and rebounds with less
    "saved by its impact": (SQUAT, Still(), (0.9 * SQUAT.alpha, -0.4 * SQUAT.p), 1e-9),
    **{it: (MIDDLE, pulse(*it, MIDDLE), (0.0, 0.0), 1e-9) for it in product(SOME, SOME, (1, 2))},
}
"""Block, motion and start of what may rock or fall later, and within what its forces are known."""


def test_free_rocking_is_watched_to_its_rest_or_until_it_passes_the_critical_rotation():
    """By the closed form of a response that is not followed as by the steps of one that is."""
    ends = {}
    for name, (block, motion, start, within) in FREE.items():
        early = simulate(block, motion, start=start, times=[motion.duration])
        late = simulate(block, motion, start=start, duration=motion.duration + 12.0 / block.p)
        assert early.min_normal == pytest.approx(late.min_normal, rel=within)
        assert early.friction_needed == pytest.approx(late.friction_needed, rel=within)
        free = bool((np.abs(early.history.theta) < block.alpha).any())
        ends[name] = early.outcome if free else None
    assert ends["rocks on"] is ends["saved by its impact"] is Outcome.ROCKED
    assert list(ends.values()).count(Outcome.OVERTURNED) >= 5
