"""How a run begins: released from a tilt, turning upright, sliding away, or after a rest.

`uses.band` says how near landing steps come; fixed ones carry the p dt of the impact's step.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
import uses
from closed_forms import free_amplitude, quarter_period
from declared import rounding, run
from known import ScriptedWorld, standing
from uses import BLOCK, CORE, HERE, agreed, band, every_use, pulse, rocked, scene, speed_band

from analytic import Delayed, Outcome, RigidBlock, SinePulse, SlidingBlock, Still, simulate
from engines.declaration import REST_S, UNTUNED, Stepping
from engines.run.run import build, simulate_world
from engines.scene import ACCURACIES
from engines.world import Moment, Pose

STILL = Still()
TILT = 0.4 * BLOCK.alpha
ANY_START = [
    pytest.param(*use, frame, side, marks=[pytest.mark.slow] * (frame == "world" or side < 0.0))
    for use in uses.LANDING
    for frame in HERE[use[0]].frames
    for side in (1.0, -1.0)
]
LIFTING = SinePulse(amplitude=4.0, omega=8.0, half_cycles=2, phase=0.5 * math.pi)


STARTS = {
    # the first impact comes after a quarter period, the next after two of what energy leaves
    "released": (STILL, (0.4, 0.0), 1.0, 0.0),
    # the rate says about which corner: the block rises as far as its energy carries it
    "turning while upright": (STILL, (0.0, 0.5), 1.0, 1e-3),
    # the start is the peak before the impact, and what it leaves comes after
    "inward": (STILL, (0.4, -0.55), 1.0, 1e-3),
    # a pulse shakes it on
    "then a pulse": (pulse(-0.9, 2.0, 2), (0.2, 0.1), 2.0, 1e-3),
    # a cosine lifts the block with the first step, in which it must have its own inertia
    "lifted at once": (LIFTING, (0.0, 0.0), 1.0, 1e-3),
}
"""Motion, start in units of alpha and p alpha, how many bands the peak, the times between impacts
and the history may be off, and by what part at least the first impact's velocities."""


@pytest.mark.parametrize("case", STARTS)
@pytest.mark.parametrize(("engine", "preset", "frame", "side"), ANY_START)
def test_any_start(engine, preset, frame, case, side):
    motion, (tilt, rate), bands, part = STARTS[case]
    start = (side * tilt * BLOCK.alpha, side * rate * BLOCK.p * BLOCK.alpha)
    shaken = motion if motion is STILL else replace(motion, amplitude=side * motion.amplitude)
    end = 8.0 / BLOCK.p
    times = np.linspace(0.0, motion.duration or end, 200).tolist()
    asked = {"start": start, "duration": end, "times": times}
    exact, found = agreed(engine, shaken, preset=preset, frame=frame, **asked)
    nearly, coarsely = bands * band(engine), max(part, speed_band(engine))
    # a peak that is the start is where it was put, as the engine's numbers have it
    within = rounding(engine) if math.isclose(exact.peak_ratio, tilt) else nearly
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=within)
    assert found.crossed == exact.crossed
    assert found.uplifts == pytest.approx(exact.uplifts, abs=1e-9)
    gaps, known = (np.diff([0.0, *(i.time for i in it.impacts[:5])]) for it in (found, exact))
    assert gaps == pytest.approx(known, rel=nearly)
    first, true = found.impacts[0], exact.impacts[0]
    assert first.velocity_before == pytest.approx(true.velocity_before, rel=coarsely)
    assert first.ratio == pytest.approx(true.ratio, rel=coarsely)
    assert found.history.theta == pytest.approx(exact.history.theta, abs=nearly * BLOCK.alpha)


@pytest.mark.parametrize("aspect", [1.5, 10.0])
@pytest.mark.parametrize("engine", CORE)
def test_twenty_impacts_of_a_release_come_when_the_closed_forms_say(engine, aspect):
    """Each impact adds an error of at most (p dt)^2 / 2 to the time, in units of 1/p."""
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    tops = [0.9 * block.alpha]
    while len(tops) < 20 and tops[-1] >= 1e-3 * block.alpha:
        tops.append(free_amplitude(block, tops[0], len(tops)))
    quarters = np.array([quarter_period(block, top) for top in tops[:-1]])
    known = np.cumsum(2.0 * quarters) - quarters[0]
    found = rocked(engine, STILL, system=block, start=(tops[0], 0.0), duration=1.01 * known[-1])
    times = np.array([impact.time for impact in found.impacts])[: len(known)]
    assert len(known) > 4
    within = 0.5 / ACCURACIES["standard"] ** 2 * np.arange(1, len(known) + 1)
    assert (abs(times - known) * block.p < within).all()


PAST = 1.2
BARRIER = math.sqrt(2.0 * (1.0 - math.cos((PAST - 1.0) * BLOCK.alpha))) / BLOCK.alpha
"""Rate, in p alpha, that just brings a block back from there."""


@pytest.mark.parametrize(
    ("tilt", "rate"), [(PAST, -1.1 * BARRIER), (PAST, -0.9 * BARRIER), (PAST, 0.0), (1e-3, 0.0)]
)
@pytest.mark.parametrize("engine", HERE)
def test_beyond_alpha_and_hardly_tilted(engine, tilt, rate):
    """A block past its balance that moves inward fast enough comes back; one at rest falls."""
    start = (tilt * BLOCK.alpha, rate * BLOCK.p * BLOCK.alpha)
    exact, found = agreed(engine, STILL, start=start, duration=8.0 / BLOCK.p)
    assert (found.crossed, found.uplifts) == (exact.crossed, ())
    if exact.outcome is Outcome.ROCKED:
        assert found.peak_ratio == pytest.approx(tilt, rel=rounding(engine))


@every_use
def test_a_block_sets_out_from_where_it_should(engine, preset):
    """On the corner on the side of its lean, whatever was tried before so that it is compiled."""
    asked = scene(start=(-TILT, 0.2 * BLOCK.p * BLOCK.alpha), preset=preset)
    world = build(HERE[engine].use(asked))
    assert world.state()[0] == pytest.approx(standing(asked, *asked.start), rel=1e-6)
    world.close()


FLAT = RigidBlock(width=1.0, height=0.5)
DROP = 0.3, 0.2073875297042, 2.7508178239809
"""A tilt [rad], when [s] it strikes its base from there and its rate [rad/s], by a quadrature of
theta'^2 (B^2 + H^2)/12 + z'^2 = 2 g (z0 - z), which gives all that Siconos prints of a drop from
pi/3: 0.587477974574 s and 4.130760093380 rad/s."""


@pytest.mark.parametrize("side", [1.0, -1.0])
@uses.every_landing_use
def test_a_slide_is_no_failure_where_it_is_meant(engine, preset, side):
    """The centre falls straight down, so that the corner slides by half of what the width loses."""
    theta, time, rate = DROP
    start, until = (side * theta, 0.0), 1.05 * time
    asked = {"system": FLAT, "start": start, "preset": preset, "duration": until}
    response = rocked(engine, STILL, **asked, friction=0.0)
    strike = response.impacts[0]
    # steps of p dt = 1/200 are of second order; the pivot is helped as if it stood
    assert strike.time == pytest.approx(time, rel=2e-4)
    assert strike.velocity_before == pytest.approx(-side * rate, rel=1e-3)
    corner = 0.5 * (FLAT.width * math.cos(theta) - FLAT.height * math.sin(theta))
    assert response.slip_m == pytest.approx(abs(corner - 0.5 * FLAT.width), rel=0.05)


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
