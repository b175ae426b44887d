"""A block whose mass stands off its middle: both peaks are near the exact ones, and mirrored."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest
from declared import NUISANCE, equal_to
from uses import CORE, HERE, agreed, rocked, scene

from analytic import RigidBlock, SinePulse, Still, conditioning
from engines.run.run import build
from studies.cases.drawn import draw

UNEVEN = RigidBlock(width=0.6, height=1.8, offset=0.08)
SHAKEN = SinePulse(amplitude=4.0, omega=6.0, half_cycles=2)
HOLDING = [name for name, engine in HERE.items() if engine.offsets]


def drawn(count):
    """Return unlike blocks with pulses that they survive, and to which their peaks are calm."""
    rng = np.random.default_rng(65)
    offsets = (0.5 * case.block.width * rng.uniform(-0.3, 0.3) for case in draw(65))
    cases = (
        (replace(case.block, restitution=None, offset=offset), case.motion)
        for case, offset in zip(draw(65), offsets, strict=True)
    )
    return islice((each for each in cases if abs(conditioning(*each)[0]) < 10.0), count)


@pytest.mark.slow
@pytest.mark.parametrize("engine", CORE)
def test_random_blocks_come_within_a_hundredth(engine):
    for block, motion in drawn(10):
        exact, found = agreed(engine, motion, system=block, preset="tuned")
        assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-2), (block, motion)


@pytest.mark.parametrize("engine", HOLDING)
def test_a_mirrored_block_has_the_mirrored_response(engine):
    other = replace(UNEVEN, restitution=None, offset=-UNEVEN.offset)
    right = rocked(engine, SHAKEN, system=UNEVEN, preset="tuned").peak_sides
    left = rocked(engine, replace(SHAKEN, amplitude=-4.0), system=other, preset="tuned").peak_sides
    within = max(equal_to(engine), NUISANCE.get(engine, 0.0))
    assert right == pytest.approx(left[::-1], rel=within)
    assert min(right) > 0.05


@pytest.mark.parametrize("engine", HOLDING)
def test_a_block_that_turns_on_its_strong_side_falls_over_the_weak_one(engine):
    """It sets out from where an even one would, though its mass is elsewhere and as fast."""
    block = replace(UNEVEN, restitution=None, offset=-0.1)
    start = (0.6 * block.sides[0].alpha, 0.3)
    asked = scene(Still(), system=block, start=start, preset="tuned")
    even = replace(asked, system=RigidBlock(width=0.6, height=1.8))
    worlds = [build(HERE[engine].use(each)) for each in (asked, even)]
    states = [np.array(world.state()) for world in worlds]
    assert states[0] == pytest.approx(states[1], abs=equal_to(engine, 1e-6))
    exact, found = agreed(engine, Still(), system=block, preset="tuned", start=start)
    within = max(1e-4, NUISANCE.get(engine, 0.0))
    assert found.peak_sides == pytest.approx(exact.peak_sides, rel=within)
