"""Box2D: the traps that it sets without a word."""

import pytest
from uses import HERE, error, pulse, rocked

from analytic import RigidBlock
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
