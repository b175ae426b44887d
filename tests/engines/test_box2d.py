"""Box2D: how near single precision comes, and the traps that it sets without a word."""

from dataclasses import replace

import numpy as np
import pytest
from test_landing import errors_of_sweep
from uses import BLOCK, HERE, pulse, scene

from analytic import simulate
from analytic.block import RigidBlock
from analytic.motion import SinePulse
from analytic.response import Outcome
from engines import Scene
from engines.run.drive import run

pytestmark = pytest.mark.skipif("box2d" not in HERE, reason="Box2D is not installed")

MOTION = pulse(1.3, 3.0, 2)


def worst(**options):
    """Return the largest error over some of the paper's cases."""
    return max(errors_of_sweep("box2d", every=96, **options))


def test_some_of_the_sweep():
    """Second order, 2.5e-5, in the median; a weak impact is landed to 1e-5 of 1/p, whose part of
    a swing that lasts some 0.1/p is 1e-4, doubled in the energy and more near overturning."""
    errors = errors_of_sweep("box2d", every=96)
    assert np.median(errors) < 1e-5
    assert max(errors) < 5e-4


SLENDER = RigidBlock(width=0.5, height=5.5)


def slender_error(half_cycles, **settings):
    motion = pulse(1.5, 5.8, half_cycles, SLENDER)
    peak = run("box2d", Scene(system=SLENDER, motion=motion, settings=settings)).peak_ratio
    return abs(peak / simulate(SLENDER, motion).peak_ratio - 1.0)


def test_a_slender_block_takes_more_iterations():
    """On two corners of H/B = 11 each iteration takes some 6 % off an impulse's error."""
    assert slender_error(1) < 1e-5
    assert slender_error(1, iterations=100) > 1e-3


def test_small_swings_are_seen_near_the_origin():
    """Between its impacts the block rises by a few roundings of its height."""
    assert slender_error(3) < 5e-5
    assert slender_error(3, centred=False) > 1e-4


def test_speed_is_clamped_to_two_units_in_a_step():
    from engines.parts.quiet import imported

    box2d = imported("Box2D")
    world = box2d.b2World(gravity=(0.0, 0.0))
    body = world.CreateDynamicBody(position=(0.0, 0.0), linearVelocity=(500.0, 0.0))
    body.CreateCircleFixture(radius=1.0, density=1.0)
    world.Step(1.0 / 60.0, 6, 2)
    assert body.position.x == pytest.approx(box2d.b2_maxTranslation, rel=1e-6)
    assert body.linearVelocity.x == pytest.approx(120.0, rel=1e-6)
    world.DestroyBody(body)


@pytest.mark.parametrize("width", [0.02, 60.0])
def test_blocks_of_any_size_move_alike(width):
    """Lengths count in heights of the block, so that nothing of it is clamped or lost."""
    block = RigidBlock(width=width, height=3.0 * width)
    motion = pulse(1.3, 3.0, 2, block)
    for accuracy in ("loose", "standard"):
        there = run("box2d", Scene(system=block, motion=motion, accuracy=accuracy)).peak_ratio
        here = run("box2d", scene(MOTION, accuracy=accuracy)).peak_ratio
        assert there == pytest.approx(here, rel=1e-4)


def test_a_large_block_is_slowed_where_a_step_is_too_long_for_its_units():
    """200 units a height, at p dt = 0.05: the centre would move further than two of them."""
    motion = pulse(2.0, 1.0)
    exact = simulate(BLOCK, motion)
    peaks = [
        run("box2d", scene(motion, step=0.05, settings={"units": units}))
        for units in (20.0, 2000.0)
    ]
    assert peaks[0].outcome is exact.outcome
    assert peaks[1].peak_ratio != pytest.approx(peaks[0].peak_ratio, rel=0.1)


@pytest.mark.parametrize("left_out", [{"margin": None}, {"reflection": False}])
def test_what_landing_is_helped_by_matters(left_out):
    assert worst(settings=left_out) > 3.0 * worst()


@pytest.mark.parametrize("preset", ["naive", "landing"])
def test_a_base_moved_by_position_leaves_the_block_behind(preset):
    settings = {"floor": "position"}
    response = run("box2d", scene(MOTION, preset=preset, frame="world", settings=settings))
    assert response.outcome in (Outcome.FAILED, Outcome.AT_REST)


def test_a_box_acts_from_its_skin_on():
    """0.01 units a polygon, 1e-3 of the height at 20 units: at it, the corners are round."""
    box = {"geometry": "box", "units": 20.0}
    peaks = [
        run("box2d", scene(MOTION, settings={**box, "skins_below": below})).peak_ratio
        for below in (True, False)
    ]
    exact = simulate(BLOCK, MOTION).peak_ratio
    assert peaks[0] == pytest.approx(exact, rel=3e-2)
    assert peaks[1] < 0.8 * exact


def test_a_world_that_does_not_sleep_still_puts_a_body_to_sleep():
    """`doSleep` is taken and read back, and does nothing; `sleepingAllowed` of the body does."""
    motion = pulse(1.3, 0.1, 2)
    asked = scene(motion, preset="naive", frame="base")
    outcomes = [
        run("box2d", replace(asked, settings={"sleeping": sleeping})).outcome
        for sleeping in (True, False)
    ]
    assert simulate(BLOCK, motion).outcome is Outcome.OVERTURNED
    assert outcomes == [Outcome.AT_REST, Outcome.OVERTURNED]


def test_a_block_that_its_skins_hold_leaning_is_at_rest():
    """After a pulse of 1.01 onsets it stays 6e-6 of alpha off upright, 1e-5 of p alpha slow, for
    ever: taken for a swing, it took all the steps there are."""
    block = RigidBlock(width=0.5, height=1.0424795067181944)
    motion = SinePulse(amplitude=4.752179748449666, omega=6.671202601062823, half_cycles=1)
    posed = Scene(system=block, motion=motion, preset="fixed", max_steps=10_000)
    response = run("box2d", posed)
    assert response.outcome is Outcome.ROCKED, response.message
    exact = simulate(block, motion).peak_ratio
    assert response.peak_ratio == pytest.approx(exact, rel=1e-3)
