"""Without friction a block's corner slides away under it: a start that anchors the engines."""

import math

import pytest
from uses import BLOCK, HERE, every_landing_use

from analytic import RigidBlock, Still
from analytic.criteria import frictionless_fall
from engines import Scene
from engines.run.drive import run

STILL = Still()
FLAT = RigidBlock(width=1.0, height=0.5)


@pytest.mark.parametrize("side", [1.0, -1.0])
@every_landing_use
def test_a_slide_is_no_failure_where_it_is_meant(engine, preset, side):
    """The centre falls straight down, so that the corner slides by half of what the width loses."""
    theta = 0.3
    time, rate = frictionless_fall(FLAT, theta)
    start, until = (side * theta, 0.0), 1.05 * time
    response = run(
        engine,
        Scene(system=FLAT, motion=STILL, start=start, preset=preset, duration=until, friction=0.0),
    )
    strike = response.impacts[0]
    # steps of p dt = 1/200 are of second order; the pivot is helped as if it stood
    assert strike.time == pytest.approx(time, rel=2e-4)
    assert strike.velocity_before == pytest.approx(-side * rate, rel=1e-3)
    corner = 0.5 * (FLAT.width * math.cos(theta) - FLAT.height * math.sin(theta))
    assert response.slip_m == pytest.approx(abs(corner - 0.5 * FLAT.width), rel=0.05)


@pytest.mark.parametrize("engine", HERE)
def test_a_slide_is_a_failure_where_there_is_friction(engine):
    response = run(engine, Scene(system=FLAT, motion=STILL, start=(0.9, 0.0), friction=1e-6))
    assert "slid" in response.message


def test_friction_is_not_negative():
    with pytest.raises(ValueError, match=r"friction is -0\.1; it must not be negative"):
        Scene(system=BLOCK, motion=STILL, friction=-0.1)
