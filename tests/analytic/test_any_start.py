"""Any start and any phase, through every source of this storey, by independent routes."""

import itertools
import math
from dataclasses import replace

import numpy as np
import pytest
from given import BLOCK, ONSET, pulse
from independent import peak_and_impacts

from analytic import (
    MODELS,
    Impact,
    Outcome,
    Record,
    RigidBlock,
    Still,
    conditioning,
    simulate,
)
from analytic.criteria import free_amplitude, quarter_period
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


@pytest.mark.parametrize("source", SOURCES)
def test_free_rocking_is_followed_for_the_duration(source):
    start, times = (0.6 * BLOCK.alpha, 0.0), np.linspace(0.0, 3.0, 301)
    exact = simulate(BLOCK, Still(), start=start, duration=3.0, times=times)
    response = respond(source, BLOCK, Still(), start=start, duration=3.0, times=times)
    assert response.history.time[-1] == 3.0
    assert response.history.theta[0] == start[0]
    assert len(response.impacts) == len(exact.impacts)
    # the paper's contact tolerance ends each swing 1e-6 rad early or late
    assert np.abs(response.history.theta - exact.history.theta).max() < 2e-3 * BLOCK.alpha
    assert respond(source, BLOCK, Still(), start=start).peak_ratio == pytest.approx(0.6, rel=1e-9)
    none = respond(source, BLOCK, Still(), duration=2.0)
    assert (none.outcome, none.peak_ratio) == (Outcome.AT_REST, 0.0)


def test_a_response_may_be_taken_up_where_it_was_left():
    """The state after half a record, and the rest of the record, make the same response."""
    samples = ONSET * np.array([0.0, 1.6, 0.4, -1.9, -0.3, 1.2, 0.2, -0.4, 0.1, 0.0])
    whole = Record(dt=0.2, samples=samples)
    times = np.linspace(0.0, 3.0, 16)
    for model in MODELS:
        expected = simulate(BLOCK, whole, model, duration=3.0, times=times).history
        theta, rate = expected.theta[4], expected.velocity[4]
        rest = Record(dt=0.2, samples=samples[4:])
        found = simulate(
            BLOCK, rest, model, (theta, rate), duration=2.2, times=np.linspace(0.0, 2.2, 12)
        ).history
        assert theta != 0.0
        # the state left is one of some twenty roundings, amplified by a few impacts
        np.testing.assert_allclose(found.theta, expected.theta[4:], rtol=0, atol=1e-12)


@pytest.mark.parametrize("model", MODELS)
def test_beyond_the_critical_rotation_a_push_may_bring_it_back(model):
    saddle = MODELS[model].law(BLOCK.alpha, 0.5).saddle
    tilted = (1.1 * saddle, 0.0)
    falling = simulate(BLOCK, Still(), model, tilted)
    assert falling.outcome is Outcome.OVERTURNED
    push = Record(dt=0.3, samples=[0.5 * ONSET, 0.5 * ONSET])
    response = simulate(BLOCK, push, model, tilted)
    assert response.outcome is Outcome.ROCKED
    assert response.crossed
    assert response.peak_ratio == pytest.approx(1.1 * saddle / BLOCK.alpha, rel=1e-14)
    assert simulate(BLOCK, push.scaled(-1.0), model, tilted).outcome is Outcome.OVERTURNED
    returning = simulate(BLOCK, Still(), model, (1.1 * saddle, -0.5 * BLOCK.alpha * BLOCK.p))
    assert returning.outcome is Outcome.ROCKED


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
    assert response.history.velocity.tolist()[:2] == [0.2, 0.2]
    assert response.impacts == followed.impacts != ()
    only = simulate(BLOCK, Still(), model, **asked | {"times": [0.0]})
    assert only.history.theta.tolist() == [-0.1]
    assert only.peak_ratio == pytest.approx(response.peak_ratio, rel=1e-12)


def test_a_jump_beyond_the_onset_lifts_at_once():
    for phase in (0.5 * math.pi, -0.5 * math.pi, 2.0):
        lifted = abs(math.sin(phase)) > 1.0 / 1.2
        response = simulate(BLOCK, pulse(1.2, 1.5, 2, phase=phase), times=[0.05])
        assert (response.uplifts[0] == 0.0) == lifted
        if lifted:
            assert math.copysign(1.0, response.history.theta[0]) == -math.copysign(1.0, phase)


@pytest.mark.parametrize("source", SOURCES)
@pytest.mark.parametrize("omega_over_p", [6.0, 8.0])
def test_a_block_that_does_not_rebound_is_lifted_again_at_once(source, omega_over_p):
    """A squat block stops dead, and the ground, which is beyond the onset, turns it about the same
    corner as before: the other one does not strike."""
    block = RigidBlock(width=1.5, height=1.0)
    assert block.restitution == 0.0
    motion = pulse(5.0, omega_over_p, 3, block)
    exact, found = simulate(block, motion), respond(source, block, motion)
    assert [i.velocity_after for i in exact.impacts] == [0.0]
    assert [i.time for i in found.impacts] == pytest.approx([exact.impacts[0].time], abs=1e-4)
    # average acceleration is of second order in its step, 1e-3 of 1/p, and omega is eight times p
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-4)
    assert type(found.peak_ratio) is float
