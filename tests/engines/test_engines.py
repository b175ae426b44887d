"""Every engine under every preset, by what must hold of any engine.

What rounding may tell apart is held to the declared precision, the rest to the method's order.
With its defaults an engine may not feel the base: that is a finding, and not asked here.
"""

import math
import re

import numpy as np
import pytest
import uses
from declared import NUISANCE, equal_to
from given import BLOCK, all_but_times, pulse
from uses import CORE, HERE, SHAKEN, TUNED_IN_FRAMES, agreed, error, rocked, scene, take_a_step

from analytic import RigidBlock, SinePulse, simulate
from analytic.motion import BothWays
from analytic.response import Outcome, Reason
from engines import FRAMES
from engines.declaration import UNTUNED, Stepping
from engines.run.run import LAG, build, simulate_world


@pytest.mark.parametrize(
    ("engine", "preset", "frame"),
    [pytest.param(*use, marks=[pytest.mark.slow] * (use[2] == "world")) for use in TUNED_IN_FRAMES],
)
def test_onset(engine, preset, frame):
    """Below g tan(alpha) nothing lifts and above it something does, or the base is not felt."""
    below, above = (
        rocked(engine, pulse(onsets, 1.0), preset=preset, frame=frame) for onsets in (0.95, 1.05)
    )
    assert below.outcome is Outcome.AT_REST
    assert 0.0 <= below.peak_ratio < 1e-3
    assert above.outcome is Outcome.ROCKED
    assert above.peak_ratio > 0.0


@pytest.mark.parametrize(("engine", "preset"), uses.MIRRORED)
def test_mirror(engine, preset):
    """Shaking the other way leans the block the other way."""
    times = [0.1 * i for i in range(1, 20)]
    there, back = (
        rocked(engine, pulse(onsets, 3.0, 2), preset=preset, times=times) for onsets in (1.3, -1.3)
    )
    # as it comes, a solver ends its iterations early, and visits the corners in one order
    tolerance = 1e-3 if preset in UNTUNED else equal_to(engine)
    assert there.history.theta == pytest.approx(-back.history.theta, abs=tolerance)
    assert there.peak_ratio > 0.01


@uses.every_tuned_use
def test_rest_stays_rest(engine, preset):
    response = rocked(engine, pulse(0.5, 1.0), preset=preset, duration=3.0, times=[1.0, 3.0])
    assert response.outcome is Outcome.AT_REST
    # the contact may settle, by less than a thousandth of what would topple the block
    assert abs(response.history.theta).max() < 1e-3 * BLOCK.alpha


@uses.every_landing_use
def test_how_a_block_lies_does_not_depend_on_the_steps(engine, preset):
    """Not up to the longest ones that the engine declares for a block at rest."""
    block, declared = RigidBlock(width=0.5, height=3.0), HERE[engine]
    asked = scene(pulse(1.2, 2.0, 1, block), system=block, preset=preset)
    use = declared.use(asked)
    dt_s, resolved = use.dt_s, use.resolution
    peaks = []
    for rest_factor in (1.0, resolved.rest_factor):
        world = build(use)
        try:
            within = resolved._replace(rest_factor=rest_factor)
            peaks.append(simulate_world(world, asked, dt_s, Stepping.LANDING, within).peak_ratio)
        finally:
            world.close()
    assert peaks[0] == pytest.approx(
        peaks[1], rel=max(equal_to(engine, 1e-6), NUISANCE.get(engine, 0.0))
    )


@uses.every_landing_use
def test_the_size_of_a_block_does_not_matter(engine, preset):
    """Nothing of it is clamped, lost or rounded away: single precision keeps 1e-4 of the peak."""
    within = 1e-6 if engine in CORE else 1e-4
    blocks = [RigidBlock(width=width, height=3.0 * width) for width in (0.02, 0.5, 20.0)]
    asked = {"preset": preset, "accuracy": "loose"}
    peaks = [rocked(engine, pulse(1.3, 3.0, 2, it), system=it, **asked).peak_ratio for it in blocks]
    assert peaks == pytest.approx([peaks[1]] * 3, rel=within)


@pytest.mark.parametrize(("engine", "preset"), uses.BOTH_FRAMES)
def test_frames_agree(engine, preset):
    """A moving base is a body force, upwards too: the two differ by rounding and slip alone."""
    motion = BothWays(SHAKEN, SHAKEN) if (engine, preset) == ("pybullet", "tuned") else SHAKEN
    base, world = (rocked(engine, motion, preset=preset, frame=frame) for frame in FRAMES)
    within = max(equal_to(engine, 1e-6), NUISANCE.get(engine, 0.0))
    assert base.peak_ratio == pytest.approx(world.peak_ratio, rel=within)
    assert base.peak_ratio > 0.1
    assert world.observables.get(LAG, 0.0) < 1e-6


@uses.every_fixed_use
def test_first_order(engine):
    """A quarter of the step makes about a quarter of the error, in the mean over some cases."""
    motions = [pulse(1.3, 3.0 + 0.13 * i, 2) for i in range(8)]
    coarse, fine = (
        sum(error(engine, motion, preset="tuned", step=step) for motion in motions)
        for step in (4e-3, 1e-3)
    )
    assert 0.6 < math.log(coarse / fine, 4.0) < 1.6


SQUAT = RigidBlock(width=1.0, height=1.5)
CLOSE = {
    # a fixed step is of first order only where the uplift falls in a step, at most p dt late, which
    # at the cube root of the excess is a part 1e-3 of the peak
    "a peak before any impact": (BLOCK, pulse(1.3, 2.0), {}, 1e-3),
    # the second half of a pulse brings back a block that the first took past alpha
    "crossed and not overturned": (BLOCK, pulse(3.5, 3.0, 2), {}, 1e-2),
    # it loses its speed by Housner's ratio at each impact; the time of rest is the sum of a
    # geometric series whose ratio carries the error of the step
    "impacts and rest": (SQUAT, pulse(1.5, 3.0, 1, SQUAT), {"duration": 2.0}, 1e-2),
}
"""Block, motion, what else is asked, and by how much a peak at a fixed step may be missed."""


@pytest.mark.parametrize("case", CLOSE)
@uses.every_fixed_use
def test_a_fixed_step_is_close_to_the_exact_solution(engine, case):
    block, motion, asked, within = CLOSE[case]
    exact, response = agreed(engine, motion, system=block, preset="tuned", **asked)
    assert response.crossed == exact.crossed == (case == "crossed and not overturned")
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=within)
    if asked:
        assert len(response.uplifts) == len(exact.rests) == 1
        assert response.rests == pytest.approx(exact.rests, abs=0.05)


@uses.every_use
def test_overturning(engine, preset):
    """A history ends with the response."""
    response = rocked(engine, pulse(2.0, 0.5), preset=preset, times=[0.1, 0.5, 1e3])
    assert response.outcome is Outcome.OVERTURNED
    assert response.crossed
    assert response.peak_ratio == math.inf
    assert list(response.history.time) == [0.1, 0.5]


@uses.every_use
def test_repeats_bit_by_bit(engine, preset):
    """Whatever was simulated in between, in whichever process."""
    asked = {"preset": preset, "times": [0.1 * i for i in range(10)]}
    first = all_but_times(rocked(engine, **asked))
    rocked(engine, pulse(1.5, 1.0), system=RigidBlock(width=2.0, height=3.0), max_steps=300)
    assert all_but_times(rocked(engine, **asked)) == first


@pytest.mark.parametrize("engine", HERE)
def test_worlds_at_once_do_not_disturb_each_other(engine):
    """Nor take both what an earlier one gave back."""
    asked = scene(preset="tuned")
    build(HERE[engine].use(asked)).close()
    first, second = (build(HERE[engine].use(asked)) for _ in range(2))
    before = np.array(second.state())
    take_a_step(first, asked, engine)
    assert (np.array(first.state()) != before).any()
    assert (np.array(second.state()) == before).all()
    for world in (first, second):
        world.close()


@uses.every_tuned_use
def test_a_sliding_block_is_no_rocking_block(engine, preset):
    response = rocked(engine, pulse(1.3, 1.0), preset=preset, friction=0.05)
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.SLID)
    assert math.isnan(response.peak_ratio)


FREEZER = RigidBlock(width=0.6, height=1.8)
"""With a friction of 0.3 it slides flat: it would rock from B/H = 1/3 on."""


@uses.every_landing_use
@pytest.mark.parametrize("shaken", [(0.35, 6.28), (0.8, 9.0)])
def test_steps_that_land_fail_by_name_once_their_pivot_slides(engine, preset, shaken):
    """Both in a slide of 1.4 % of B, and in one in which MuJoCo's block would overturn."""
    motion = SinePulse.in_g(shaken[0], omega=shaken[1])
    found = rocked(engine, motion, system=FREEZER, preset=preset, friction=0.3)
    assert (found.outcome, found.reason) == (Outcome.FAILED, Reason.SLID)
    named = re.search(r"the pivot slid (\S+) m along the base.* at most (\S+) m", found.message)
    slid, allowed = map(float, named.groups())
    assert allowed == pytest.approx(0.01 * FREEZER.width)
    assert allowed <= slid < 2.0 * allowed


@pytest.mark.parametrize("engine", CORE)
@pytest.mark.parametrize(
    ("aspect", "onsets", "omega_over_p", "stays"),
    [(1.0, 1.2, 4.0, True), (3.0, 2.4, 8.0, True), (1.0, 2.0, 3.0, False), (1.5, 2.4, 1.0, False)],
)
def test_a_pivot_lifts_off_where_the_exact_motion_would_have_to_pull(
    engine, aspect, onsets, omega_over_p, stays
):
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    motion = pulse(onsets, omega_over_p, 2, block)
    assert (simulate(block, motion).min_normal > 0.0) is stays
    found = rocked(engine, motion, system=block, preset="tuned")
    assert (found.hop_m < 3e-5 * block.width) is stays


@pytest.mark.parametrize("engine", CORE)
def test_a_pivot_slides_where_the_exact_motion_needs_more_friction(engine):
    block = RigidBlock(width=0.5, height=1.0)
    motion = pulse(1.2, 4.0, 2, block)
    needed = simulate(block, motion).friction_needed
    enough, short = (
        rocked(engine, motion, system=block, preset="tuned", friction=k * needed)
        for k in (1.2, 0.8)
    )
    assert enough.slip_m < 3e-4 * block.width < short.slip_m


@uses.every_fixed_use
@pytest.mark.parametrize("limit", [{"time_limit_s": 1e-6}, {"max_steps": 9}])
def test_limits(engine, limit):
    response = rocked(engine, pulse(1.3, 1.0), preset="tuned", **limit)
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNDECIDED)
    assert f"{next(iter(limit.values()))}" in response.message
