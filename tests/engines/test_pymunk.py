"""pymunk: how near it comes, and the traps that it sets without a word."""

import math

import numpy as np
import pytest
from test_landing import errors_of_sweep
from uses import HERE, pulse, scene

from analytic import simulate
from analytic.block import RigidBlock
from analytic.response import Outcome
from engines import Scene
from engines.parts.shapes import NO_JAM
from engines.run.drive import build, run

pytestmark = pytest.mark.skipif("pymunk" not in HERE, reason="pymunk is not installed")

MOTION = pulse(1.3, 3.0, 2)


def worst(**options):
    """Return the largest error over some of the paper's cases."""
    return max(errors_of_sweep("pymunk", every=96, **options))


def test_some_of_the_sweep():
    """The steps are of second order, 1/200^2 = 2.5e-5 times a factor that is below one here."""
    errors = errors_of_sweep("pymunk", every=96)
    assert np.median(errors) < 1e-5
    assert max(errors) < 1e-4


def test_cached_impulses_are_scaled_by_the_step():
    """An impact in a step of a microsecond, and one step of a millisecond throws the body off."""
    import pymunk

    space = pymunk.Space()
    body = pymunk.Body(1.0, 1.0)
    ball, ground = pymunk.Circle(body, 1.0), pymunk.Segment(space.static_body, (-9, 0), (9, 0), 0.0)
    body.position, body.velocity = (0.0, 1.0), (0.0, -1.0)
    space.add(body, ball, ground)
    for step in (1e-6, 1e-3):
        space.step(step)
    assert body.velocity.y > 100.0


@pytest.mark.parametrize(
    "left_out", [{"positions": False}, {"margin": None}, {"reflection": False}]
)
def test_what_landing_is_helped_by_matters(left_out):
    """With steps of its own the library is wrong by its scaled impulses; with a pivot out of reach,
    or one that creeps, by the order of its method."""
    assert worst(settings=left_out) > 10.0 * worst()


def test_equal_steps_come_to_rest_on_both_corners():
    """Not on the margin of a corner that is not the pivot, above the base."""
    block = RigidBlock(width=1.0, height=1.5)
    motion = pulse(1.5, 3.0, 1, block)
    exact = simulate(block, motion, duration=4.0)
    asked = Scene(system=block, motion=motion, preset="fixed", duration=4.0, step=1e-3)
    response = run("pymunk", asked)
    assert response.rests == pytest.approx(exact.rests, abs=0.05)


@pytest.mark.parametrize("aspect", [2.0, 10.0])
def test_it_iterates_as_slender_blocks_need(aspect):
    block = RigidBlock(width=1.0, height=aspect)
    world = build(HERE["pymunk"], Scene(system=block, motion=pulse(1.3, 3.0, 2, block)))
    assert world._space.iterations == pytest.approx(20.0 * (1.0 + aspect**2), abs=1)
    world.close()


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


@pytest.mark.parametrize("preset", ["naive", "landing"])
def test_a_base_moved_by_position_leaves_the_block_behind(preset):
    settings = {"floor": "position"}
    response = run("pymunk", scene(MOTION, preset=preset, frame="world", settings=settings))
    assert response.outcome in (Outcome.FAILED, Outcome.AT_REST)
