"""Steps that land, given poses that are known: where they end, what for, what cannot be known."""

import itertools
import math

import numpy as np
import pytest
from given import WANDERING
from known import ScriptedWorld, exactly, watched
from uses import BLOCK, pulse, scene

from analytic import simulate
from engines.declaration import Stepping
from engines.run.ground import mean_velocity_of
from engines.world import ContactPhase, Moment

MOTION = pulse(1.3, 3.0, 2)
SEEN_S = 2.0
LOOSE = 1.0 / (40.0 * BLOCK.p)
"""The ordinary step [s]."""
EXACT = simulate(BLOCK, MOTION, duration=SEEN_S)


@pytest.fixture(scope="module", params=Moment)
def steps(request):
    """The steps through three impacts."""
    asked = scene(MOTION, duration=SEEN_S, accuracy="loose")
    return exactly(asked, request.param, Stepping.LANDING)[1]


def test_steps_end_on_what_the_motion_does_and_on_the_uplift(steps):
    ends = [step.end_s for step in steps]
    corners = [EXACT.uplifts[0], *MOTION.breakpoints[1:], SEEN_S]
    for corner in corners:
        assert min(abs(end - corner) for end in ends) < 1e-12
    assert ends == sorted(ends)
    aloft = [step for step in steps if step.phase is not ContactPhase.REST]
    assert all(step.dt_s <= LOOSE * (1.0 + 1e-9) for step in aloft)


def test_steps_end_on_impacts_and_an_approach_halves_what_is_left(steps):
    approaches = [
        list(group)
        for phase, group in itertools.groupby(steps, key=lambda step: step.phase)
        if phase is ContactPhase.APPROACH
    ]
    assert len(approaches) == len(EXACT.impacts)
    for approach, impact in zip(approaches, EXACT.impacts, strict=True):
        # what is left when an impact is near, of which the next step covers all
        assert min(abs(step.end_s - impact.time) for step in steps) < 1e-6 * LOOSE
        assert len(approach) > 10
        for before, after in itertools.pairwise(approach):
            assert after.dt_s == pytest.approx(0.5 * before.dt_s, rel=1e-2)
        assert all(step.end_s < impact.time for step in approach)


def test_through_an_impact_the_contact_alone_acts(steps):
    strikes = [step for step in steps if step.phase is ContactPhase.STRIKE]
    # four at least, and an exact velocity is settled by then
    assert len(strikes) == 4 * len(EXACT.impacts)
    # gravity turns the block by less than a millionth of what the impact does
    assert max(step.dt_s for step in strikes) < 1e-6 / BLOCK.p


class Bounces(ScriptedWorld):
    """Falls evenly, and is thrown back as fast, twice as soon as it would meet the base."""

    period, rate = 0.4, 0.5

    def script(self, time, rate_s):
        phase, _ = math.modf(rate_s / self.period)
        height = abs(math.modf(time / self.period)[0] - 0.5) + 0.1
        return height * self.period * self.rate, math.copysign(self.rate, phase - 0.5)


def test_a_block_that_cannot_lift_is_asked_seldom():
    """The farther off the onset is, the longer the steps are, and none is far from the next."""
    slow = pulse(1.3, 0.02)
    asked = scene(slow)
    world = ScriptedWorld(asked)
    watched(world, asked, Stepping.LANDING)
    onset, ordinary = math.asin(1.0 / 1.3) / slow.omega, 5e-3 / BLOCK.p
    calm = [step for step in world.steps if step.end_s < onset - ordinary]
    assert len(calm) < 0.16 * onset / ordinary
    assert max(step.dt_s for step in calm) == pytest.approx(8.0 * ordinary)
    for step in calm:
        left = onset - (step.end_s - step.dt_s)
        assert step.dt_s <= max(left / 32.0, ordinary) * (1.0 + 1e-9)
    for before, after in itertools.pairwise(calm):
        assert 0.96 <= after.dt_s / before.dt_s <= 1.04
    # while the base can lift it, it is asked as often as a block that rocks
    loaded = [step for step in world.steps if onset < step.end_s < slow.duration - onset]
    assert max(step.dt_s for step in loaded) <= ordinary


@pytest.mark.parametrize("count", range(2, 33))
def test_no_ordinary_step_ends_on_the_onset(count):
    """Not even where a whole number of them leads there, give or take a rounding."""
    onset = math.asin(1.0 / 1.3) / MOTION.omega
    asked = scene(MOTION, step=onset / count * BLOCK.p)
    world = ScriptedWorld(asked)
    watched(world, asked, Stepping.LANDING)
    last = min(world.steps, key=lambda step: abs(step.end_s - onset))
    assert last.dt_s < 0.01 * onset / count


def test_an_impact_that_comes_before_the_base_is_met_is_no_impact():
    """It turns back in the air: an approach at most, and steps as long as before after it."""
    asked = scene(pulse(1.3, 3.0), accuracy="loose", start=(0.1, 0.0), duration=3.0)
    world = Bounces(asked)
    response = watched(world, asked, Stepping.LANDING)
    assert response.impacts == ()
    assert ContactPhase.STRIKE not in {step.phase for step in world.steps}
    assert len(world.steps) < 4 * 3.0 / LOOSE


def test_the_mean_velocity_of_the_base_is_its_displacement_over_time():
    """Also over steps longer than a sample, past both ends, from corner to corner."""
    mean_velocity = mean_velocity_of(WANDERING.segments())
    draw = np.random.default_rng(4)
    for begin, finish in [*np.sort(draw.uniform(0, 2.5, (40, 2))).tolist(), (0.0, 1.8), (0.3, 0.6)]:
        moved = WANDERING.displacement(finish) - WANDERING.displacement(begin)
        expected = float(moved) / (finish - begin)
        assert mean_velocity(begin, finish) == pytest.approx(expected, abs=1e-12)
