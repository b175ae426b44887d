"""pymunk: the traps that it sets without a word."""

import math

import numpy as np
import pytest
from uses import HERE, agreed, pulse, rocked

from analytic import RigidBlock
from engines.parts import NO_JAM, imported

pytestmark = pytest.mark.skipif("pymunk" not in HERE, reason="pymunk is not installed")


def test_cached_impulses_are_scaled_by_the_step():
    """An impact in a step of a microsecond, and one step of a millisecond throws the body off."""
    pymunk = imported("pymunk")
    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    ball, ground = pymunk.Circle(body, 1.0), pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.0)
    body.position, body.velocity = (0.0, 1.0), (0.0, -1.0)
    space.add(body, ball, ground)
    for step in (1e-6, 1e-3):
        space.step(step)
    assert body.velocity.y > 100.0


def test_equal_steps_come_to_rest_on_both_corners():
    """Not on the margin of a corner that is not the pivot, above the base."""
    block = RigidBlock(width=1.0, height=1.5)
    motion = pulse(1.5, 3.0, 1, block)
    asked = {"system": block, "preset": "fixed", "duration": 4.0, "step": 1e-3}
    exact, response = agreed("pymunk", motion, **asked)
    assert response.rests == pytest.approx(exact.rests, abs=0.05)


@pytest.mark.parametrize("aspect", [2.0, 10.0])
def test_it_iterates_as_slender_blocks_need(aspect):
    block = RigidBlock(width=1.0, height=aspect)
    motion, needed = pulse(1.3, 3.0, 2, block), math.ceil(20.0 / math.sin(block.alpha) ** 2)
    own, same, few = (
        rocked("pymunk", motion, system=block, accuracy="loose", settings=settings).peak_ratio
        for settings in ({}, {"iterations": needed}, {"iterations": 20})
    )
    assert own == same != few


def test_corners_jam_from_four_thirds_on():
    """Painlevé: the least friction at which a corner's push turns it into the base, over all tilts.

    A push N at the corner (x, z) from the centre, with drag mu N, moves the corner up by
    1/m + x^2/I - mu x z/I, and I is m r^2/3.
    """
    tilt = np.linspace(1e-3, 0.5 * math.pi - 1e-3, 100_001)
    x, z = np.cos(tilt), np.sin(tilt)
    jamming = (1.0 + 3.0 * x**2) / (3.0 * x * z)
    assert jamming.min() == pytest.approx(4.0 / 3.0, rel=1e-8)
    assert jamming.min() > NO_JAM
