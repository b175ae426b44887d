"""Any start and any phase, through every source of this storey, by independent routes."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from closed_forms import free_amplitude, quarter_period
from given import BLOCK, pulse
from independent import peak_and_impacts

from analytic import MODELS, Impact, Outcome, RigidBlock, Still, conditioning, simulate
from studies import respond

SOURCES = ("exact", "rk4", "average-acceleration", "rk45", "dop853", "radau", "lsoda")


def drawn(seed):
    """Return a block, a pulse with a phase and a start: tilted, upright but turning, or at rest."""
    draw = np.random.default_rng(seed)
    block = RigidBlock(width=draw.uniform(0.1, 2), height=draw.uniform(2.2, 10))
    onsets = draw.uniform(0.5, 2) * draw.choice([-1, 1])
    omega_over_p, half_cycles = draw.uniform(1, 6), int(draw.integers(1, 4))
    motion = pulse(onsets, omega_over_p, half_cycles, block, phase=draw.uniform(-4, 8))
    tilt = draw.uniform(-1.3, 1.3) * block.alpha
    rate = draw.uniform(-0.8, 0.8) * block.alpha * block.p
    return block, motion, [(0.0, 0.0), (tilt, 0.0), (0.0, rate), (tilt, rate)][seed % 4]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("seed", range(24))
def test_every_model_against_scipy(model, seed):
    block, motion, start = drawn(seed)
    peak, impacts = peak_and_impacts(model, block, motion, start=start)
    end = motion.duration + 15.0 / block.p
    response = simulate(block, motion, model, start, duration=end)
    # as without a start: DOP853 at rtol 1e-12 with a dense output of order 7 for the events
    if peak is not None:
        assert response.peak_ratio == pytest.approx(peak, rel=2e-9)
        assert simulate(block, motion, model, start).peak_ratio == pytest.approx(peak, rel=2e-9)
    times = [i.time for i in response.impacts][: len(impacts)]
    assert times == pytest.approx(impacts, rel=2e-9, abs=1e-10)
    other_way = replace(motion, amplitude=-motion.amplitude), model, (-start[0], -start[1])
    assert simulate(block, *other_way, duration=end).impacts == tuple(
        Impact(time, -before, -after) for time, before, after in response.impacts
    )


@pytest.mark.parametrize("source", SOURCES[1:])
@pytest.mark.parametrize("seed", range(12))
def test_solvers_and_peers_take_the_start(source, seed):
    """To what their default settings leave, times the condition number of the peak."""
    block, motion, start = drawn(seed)
    exact = simulate(block, motion, start=start)
    response = respond(source, block, motion, start=start)
    assert response.outcome is exact.outcome
    if exact.outcome is Outcome.ROCKED:
        worst = max(10.0, *map(abs, conditioning(block, motion, start=start)))
        bound = {"rk4": 2e-5, "average-acceleration": 2e-4}.get(source, 1e-6)
        assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=bound * worst)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("tilt", [0.1, 0.5, 0.9, -0.5])
def test_a_released_block_falls_in_its_quarter_period_and_decays(model, tilt):
    theta = tilt * BLOCK.alpha
    response = simulate(BLOCK, Still(), model, (theta, 0.0), duration=15.0)
    quarter = quarter_period(BLOCK, abs(theta), model)
    assert response.impacts[0].time == pytest.approx(quarter, rel=1e-13)
    assert math.copysign(1.0, response.impacts[0].velocity_before) == -math.copysign(1.0, tilt)
    assert response.peak_ratio == pytest.approx(abs(tilt), rel=1e-14)
    assert response.outcome is Outcome.ROCKED
    assert len(response.rests) == 1
    assert len(response.impacts) > 20
    for impact in response.impacts[:12]:
        assert impact.ratio == pytest.approx(BLOCK.restitution, rel=1e-14)
    if model == "exact":
        for n, (one, next_one) in enumerate(itertools.pairwise(response.impacts[:12])):
            period = 2 * quarter_period(BLOCK, free_amplitude(BLOCK, abs(theta), n + 1))
            assert next_one.time - one.time == pytest.approx(period, abs=1e-11)


@pytest.mark.parametrize("model", MODELS)
def test_free_energy_decides_at_the_separatrix(model):
    """Upright, the rate that just overturns is that of the barrier."""
    law = MODELS[model].law(BLOCK.alpha, BLOCK.restitution)
    barrier = law.k * law.saddle if law.linear else math.sqrt(2 * (1 - math.cos(BLOCK.alpha)))
    for factor, outcome in ((1 - 1e-12, Outcome.ROCKED), (1 + 1e-12, Outcome.OVERTURNED)):
        start = (0.0, factor * barrier * BLOCK.p)
        assert simulate(BLOCK, Still(), model, start).outcome is outcome
        assert simulate(BLOCK, Still(), model, start, duration=25.0).outcome is outcome


@pytest.mark.parametrize("model", MODELS)
def test_a_motion_without_length_is_sampled_from_its_start_to_the_last_of_the_times(model):
    asked = {"start": (-0.1, 0.2), "times": [0.0, 0.0, 1.0]}
    response = simulate(BLOCK, Still(), model, **asked)
    followed = simulate(BLOCK, Still(), model, **asked, duration=1.0)
    assert response.history.time.tolist() == [0.0, 0.0, 1.0]
    assert response.history.theta.tolist() == followed.history.theta.tolist()
    assert response.history.theta.tolist()[:2] == [-0.1, -0.1]
    assert response.impacts == followed.impacts != ()


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("omega_over_p", [6.0, 8.0])
def test_a_block_that_does_not_rebound_is_lifted_again_at_once(source, omega_over_p):
    """A squat block stops dead; the ground turns it about the same corner: no other one strikes."""
    block = RigidBlock(width=1.5, height=1.0)
    assert block.restitution == 0.0
    motion = pulse(5.0, omega_over_p, 3, block)
    exact, found = simulate(block, motion), respond(source, block, motion)
    assert [i.velocity_after for i in exact.impacts] == [0.0]
    assert [i.time for i in found.impacts] == pytest.approx([exact.impacts[0].time], abs=1e-4)
    # average acceleration is of second order in its step, 1e-3 of 1/p, and omega is eight times p
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-4)
    assert type(found.peak_ratio) is float
