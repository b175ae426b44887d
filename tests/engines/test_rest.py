"""The rest before the motion, in which contacts take up their load and nothing is looked at."""

import math
from dataclasses import replace

import numpy as np
import pytest
from declared import run
from known import ScriptedWorld
from uses import BLOCK, HERE, every_use, pulse, scene

from analytic import Delayed, RigidBlock, SlidingBlock, simulate
from engines.declaration import REST_S, UNTUNED, Stepping
from engines.run.run import simulate_world
from engines.world import Moment, Pose


@pytest.mark.skipif("pymunk" not in HERE, reason="pymunk is not installed")
def test_a_block_that_was_not_left_to_settle_rocks_otherwise():
    """At README's 0.02 s it falls for a step, and is thrown up, before its contact carries it."""
    block = RigidBlock(width=0.5, height=1.0)
    motion = pulse(1.2, 2.2, 2, block)
    asked = scene(motion, system=block, preset="default", duration=3.0, times=[0.0, 1.0])
    settled, at_once = (run("pymunk", replace(asked, rest_s=rest)) for rest in (None, 0.0))
    exact = simulate(block, motion)
    errors = [abs(it.peak_ratio / exact.peak_ratio - 1.0) for it in (settled, at_once)]
    assert errors[0] < 0.1 < 1.0 < errors[1]
    # the rest counts as steps, and the clock is that of the motion
    assert settled.steps - at_once.steps == math.ceil(REST_S / 0.02)
    assert settled.history.time.tolist() == [0.0, 1.0]
    assert settled.impacts[0].time == pytest.approx(exact.impacts[0].time, abs=0.04)


@every_use
def test_the_library_s_own_presets_rest_and_no_other(engine, preset):
    def rest(**options):
        return HERE[engine].use(scene(preset=preset, **options)).scene.rest_s

    asleep = f"{engine}:{preset}" in ("box2d:default-at-rest", "rapier:default-at-rest")
    assert rest() == (REST_S if preset in UNTUNED and not asleep else 0.0)
    assert rest(rest_s=0.0) == rest(start=(0.1, 0.0)) == rest(start=(0.0, 0.1)) == 0.0


@pytest.mark.parametrize("frame", ["base", "world"])
@pytest.mark.parametrize("moment", Moment)
def test_steps_are_those_of_a_motion_that_begins_later(moment, frame):
    """Three of them, whose sum is no round number, last longer; a cosine starts at once."""
    motion, dt_s = replace(pulse(1.3, 3.0), phase=1.5), 0.36 * REST_S
    steps = []
    for shaken, rest_s in ((motion, REST_S), (Delayed(motion, 3.0 * dt_s), 0.0)):
        posed = scene(shaken, rest_s=rest_s, frame=frame, duration=shaken.duration + 0.4)
        world = ScriptedWorld(posed)
        world.moment = moment
        simulate_world(world, posed, dt_s, Stepping.FIXED)
        steps.append(np.array(world.steps))
    steps[1][:, 1] -= 3.0 * dt_s
    assert steps[0][2, 1] == 0.0
    assert steps[0] == pytest.approx(steps[1], abs=1e-13)


def test_a_box_that_creeps_before_the_motion_has_not_slid():
    posed = scene(system=SlidingBlock(width=1.0, height=0.5, friction=0.9), rest_s=0.3)
    for rest_s, slips in ((0.3, ()), (0.0, (0.03,))):
        world = ScriptedWorld(posed)
        world.state = lambda it=world: [Pose(0.01 * min(len(it.steps), 3), 0.25, 0.0, 0.0)]
        found = simulate_world(world, replace(posed, rest_s=rest_s), 0.1, Stepping.FIXED)
        assert found.slips == pytest.approx(slips)
        assert found.observables["place_m"] == 0.03


@pytest.mark.parametrize("compiled", [True, False])
def test_what_a_block_does_before_the_motion_is_no_rocking(compiled):
    posed = scene(pulse(0.5, 3.0), rest_s=REST_S, compiled=compiled)
    world = ScriptedWorld(posed)
    world.script = lambda time, _: (0.1 * BLOCK.alpha if time < -0.05 else 0.0, 0.0)
    found = simulate_world(world, posed, 1e-2, Stepping.FIXED)
    assert (found.outcome.value, found.peak_ratio, found.slip_m) == ("at rest", 0.0, 0.0)
