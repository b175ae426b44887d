"""Box2D: the traps that it sets without a word."""

import pytest
from uses import BLOCK, HERE, error, pulse, rocked

from analytic import RigidBlock, SinePulse, simulate
from engines.parts import imported

pytestmark = pytest.mark.skipif("box2d" not in HERE, reason="Box2D is not installed")

SLENDER = RigidBlock(width=0.5, height=5.5)


def slender_error(half_cycles, **settings):
    motion = pulse(1.5, 5.8, half_cycles, SLENDER)
    return error("box2d", motion, system=SLENDER, settings=settings)


def test_a_slender_block_takes_more_iterations():
    """On two corners of H/B = 11 each iteration takes some 6 % off an impulse's error."""
    assert slender_error(1) < 1e-5
    assert slender_error(1, iterations=100) > 1e-3


def test_small_swings_are_seen_near_the_origin():
    """Between its impacts the block rises by a few roundings of its height."""
    assert slender_error(3) < 5e-5
    assert slender_error(3, centred=False) > 1e-4


def test_speed_is_clamped_to_two_units_in_a_step():
    box2d = imported("Box2D")
    world = box2d.b2World(gravity=(0.0, 0.0))
    body = world.CreateDynamicBody(position=(0.0, 0.0), linearVelocity=(500.0, 0.0))
    body.CreateCircleFixture(radius=1.0, density=1.0)
    world.Step(1.0 / 60.0, 6, 2)
    assert body.position.x == pytest.approx(box2d.b2_maxTranslation, rel=1e-6)
    assert body.linearVelocity.x == pytest.approx(120.0, rel=1e-6)
    world.DestroyBody(body)


@pytest.mark.parametrize("accuracy", ["loose", "standard"])
def test_blocks_of_any_size_move_alike(accuracy):
    """Lengths count in heights of the block, so that nothing of it is clamped or lost."""
    peaks = []
    for width in (0.02, 0.5, 60.0):
        block = RigidBlock(width=width, height=3.0 * width)
        motion = pulse(1.3, 3.0, 2, block)
        peaks.append(rocked("box2d", motion, system=block, accuracy=accuracy).peak_ratio)
    assert peaks == pytest.approx([peaks[1]] * 3, rel=1e-4)


def test_a_large_block_is_slowed_where_a_step_is_too_long_for_its_units():
    """200 units a height, at p dt = 0.05: the centre would move further than two of them."""
    motion = pulse(2.0, 1.0)
    right, slowed = (
        rocked("box2d", motion, step=0.05, settings={"units": units}) for units in (20.0, 2000.0)
    )
    assert right.outcome is simulate(BLOCK, motion).outcome
    assert slowed.peak_ratio != pytest.approx(right.peak_ratio, rel=0.1)


def test_a_box_acts_from_its_skin_on():
    """0.01 units a polygon, 1e-3 of the height at 20 units: at it, the corners are round."""
    box = {"geometry": "box", "units": 20.0}
    assert error("box2d", settings={**box, "skins_below": True}) < 3e-2
    assert error("box2d", settings={**box, "skins_below": False}) > 0.2


def test_a_block_that_its_skins_hold_leaning_is_at_rest():
    """After a pulse of 1.01 onsets it stays 6e-6 of alpha off upright, 1e-5 of p alpha slow, for
    ever: taken for a swing, it took all the steps there are."""
    block = RigidBlock(width=0.5, height=1.0424795067181944)
    motion = SinePulse(amplitude=4.752179748449666, omega=6.671202601062823, half_cycles=1)
    assert error("box2d", motion, system=block, preset="fixed", max_steps=10_000) < 1e-3
