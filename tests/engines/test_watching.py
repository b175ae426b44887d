"""What is made of exact poses: times, velocities, uplift, rest, peak, and their order in dt."""

import math

import numpy as np
import pytest
from known import KnownWorld, ScriptedWorld, SelfSteppingWorld, exactly, watched
from uses import BLOCK, pulse, scene

from analytic import Outcome, simulate
from engines.declaration import Precision, Stepping
from engines.world import Moment

MOTION = pulse(1.3, 3.0, 2)
SEEN_S = 2.0
"""Three impacts, and most of the swing after the third."""
TIMES = tuple(np.linspace(0.0, SEEN_S, 81).tolist())
EXACT = simulate(BLOCK, MOTION, duration=SEEN_S, times=TIMES)
FEW, MANY = 100, 400
"""Steps in 1/p."""
ODD = (1.0, 1.09, 1.17, 1.26, 1.38)
"""Parts by which steps are changed, so that impacts fall into different parts of a step."""


def errors_of(response):
    """Return the errors of what was seen: times in 1/p, velocities and the peak by their part."""
    assert len(response.impacts) == len(EXACT.impacts) == 3
    pairs = list(zip(response.impacts, EXACT.impacts, strict=True))
    apart = np.abs(response.history.theta - EXACT.history.theta).max()
    # the largest are of the steps in which the impacts are
    faster = np.median(np.abs(response.history.velocity - EXACT.history.velocity))
    return {
        "time": max(abs(i.time - e.time) for i, e in pairs) * BLOCK.p,
        "before": max(abs(i.velocity_before / e.velocity_before - 1.0) for i, e in pairs),
        "after": max(abs(i.velocity_after / e.velocity_after - 1.0) for i, e in pairs),
        "ratio": max(abs(i.ratio / e.ratio - 1.0) for i, e in pairs),
        "uplift": abs(response.uplifts[0] - EXACT.uplifts[0]) * BLOCK.p,
        "peak": abs(response.peak_ratio / EXACT.peak_ratio - 1.0),
        "history": float(apart) / BLOCK.alpha,
        "velocity": float(faster) / (BLOCK.p * BLOCK.alpha),
    }


def largest(moment, steps):
    """Return the largest errors over some equal steps of about 1/p over `steps`."""
    found = []
    for part in ODD:
        asked = scene(MOTION, duration=SEEN_S, times=TIMES, step=1.0 / (steps * part))
        response, _ = exactly(asked, moment, Stepping.FIXED)
        found.append(errors_of(response))
    return {name: max(errors[name] for errors in found) for name in found[0]}


@pytest.mark.parametrize("moment", Moment)
def test_order_of_what_is_seen_in_equal_steps(moment):
    coarse, fine = (largest(moment, steps) for steps in (FEW, MANY))
    order = {name: math.log(coarse[name] / fine[name], MANY / FEW) for name in coarse}
    # an impact is met by a straight line from the last end of a step before it, half of p dt^2
    # times acceleration over velocity off, and the velocities are taken at that time; those of
    # swings of a few steps bend by the next power
    for name in ("time", "before", "after", "ratio"):
        assert 1.7 < order[name] < 2.7, (name, order)
    # theta grows as the cube of the time since uplift, so that the threshold of some g dt^2 is
    # passed dt^(2/3) late; the rates there, and some steps later, bend off their square law by that
    # time, squared: between dt^(4/3) and dt^2
    assert 4.0 / 3.0 < order["uplift"] < 2.0
    # a parabola through the rates on both sides of a maximum
    assert order["peak"] > 3.0
    # parabolas between ends, whose curvature is that of the step before or after
    assert order["history"] > 1.7
    assert order["velocity"] > 1.7
    # some p dt^2 = 1.6e5 times ten for a first swing as short as a twelfth of 1/p
    assert fine["time"] < 2e-5
    assert fine["ratio"] < 2e-4
    assert fine["peak"] < 1e-11


@pytest.mark.parametrize("moment", Moment)
def test_steps_that_land_see_impacts_to_their_shortest_step(moment):
    asked = scene(MOTION, duration=SEEN_S, times=TIMES, accuracy="loose")
    response, _ = exactly(asked, moment, Stepping.LANDING)
    errors = errors_of(response)
    # a millionth of the ordinary step is left when the impact is near
    assert errors["time"] < 1e-6 / 40.0
    # velocities are still read from some ordinary steps before and after, to their third power:
    # 1/40^3 = 1.6e-5 times as much as a swing of a few steps bends
    assert errors["ratio"] < 2e-3
    assert errors["peak"] < 1e-7


@pytest.mark.parametrize("moment", Moment)
def test_rest_begins_where_swings_are_shorter_than_steps(moment):
    exact = simulate(BLOCK, MOTION, duration=6.0)
    late = []
    for steps in (FEW, MANY):
        asked = scene(MOTION, duration=6.0, step=1.0 / steps)
        response, _ = exactly(asked, moment, Stepping.FIXED)
        assert len(response.rests) == len(exact.rests) == 1
        late.append((response.rests[0] - exact.rests[0]) * BLOCK.p)
    # swings of some steps are not seen; of 0.79 of each swing's velocity what is left lasts as
    # long as 1/(1 - 0.79) of the last one that was
    assert -0.03 < late[0] < late[1] < 0.0
    assert late[1] > -0.01


DEEP = 0.1 * BLOCK.width
BASES = {
    "creeping in": lambda time, _: -DEEP * (1.0 - math.exp(-2.0 * BLOCK.p * time)),
    "sunk": lambda time, _: -DEEP,
    "on a skin": lambda time, _: 0.3 * DEEP,
}
"""Heights [m] of a contact over the base by the time, that no rotation depends on."""


def seen(motion, step=0.01, told_s=9.0 / BLOCK.p, kind=KnownWorld, **options):
    """Return what is seen in equal steps of a world that is raised, or not what it should be."""
    world = kind(scene(motion, step=step, duration=told_s), **options)
    return watched(world, scene(motion, step=step, max_steps=20_000), Stepping.FIXED)


@pytest.mark.parametrize("base", BASES)
@pytest.mark.parametrize(("onsets", "half_cycles"), [(1.1, 1), (1.3, 2), (0.95, 2), (6.0, 1)])
def test_outcome_and_peak_do_not_depend_on_how_deep_a_contact_is(base, onsets, half_cycles):
    motion = pulse(onsets, 3.0, half_cycles)
    exact, found = simulate(BLOCK, motion), seen(motion, 0.005, raised_m=BASES[base])
    assert found.outcome is exact.outcome
    # a turning point is met by a parabola through both ends of its step, as on a rigid base
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-6)


FALLING = pulse(6.0, 0.1, 2)
"""It throws the block on its side long before it ends."""


@pytest.mark.parametrize(("from_rad", "said"), [(0.95 * math.pi / 2, False), (0.5, True)])
def test_a_block_that_only_lies_deep_has_not_sunk(from_rad, said):
    found = seen(
        FALLING, 0.01, FALLING.duration, raised_m=lambda _, theta: -DEEP * (abs(theta) > from_rad)
    )
    assert found.outcome is Outcome.OVERTURNED
    assert found.sink_m == pytest.approx(DEEP, rel=1e-6)
    assert ("sank" in found.message) == said


@pytest.mark.parametrize("leans", [0.3, 1.0])
def test_a_soft_contact_that_leans_with_its_load_has_not_lifted(leans):
    """Two springs under the corners: one is pressed deeper by as much as the other is relieved."""
    deep, motion = 1e-3 * BLOCK.width, pulse(leans, 3.0, 2)
    most, omega = 2.0 * deep / BLOCK.width * leans, motion.omega

    class Springs(ScriptedWorld):
        def script(self, time, rate_s):
            inside, phase = time < motion.duration, omega * time
            return -most * math.sin(phase) * inside, -most * omega * math.cos(phase) * inside

    def level(_, theta):
        return -deep - 0.5 * BLOCK.width * abs(theta)

    found = seen(motion, kind=Springs, raised_m=level)
    assert found.outcome is Outcome.AT_REST
    assert found.peak_ratio == pytest.approx(most / BLOCK.alpha, rel=1e-3)


def test_a_contact_that_trembles_for_good_ends_a_run():
    motion, faster = pulse(0.9, 3.0, 2), 1e3 * BLOCK.p

    class Trembling(ScriptedWorld):
        def script(self, time, rate_s):
            return 1e-5 * math.sin(faster * time), 1e-5 * faster * math.cos(faster * time)

    found = seen(motion, kind=Trembling, raised_m=BASES["sunk"])
    assert found.outcome is Outcome.AT_REST
    assert found.steps == pytest.approx((motion.duration * BLOCK.p + 8.0) / 0.01, abs=2)


def test_a_block_held_just_short_of_its_side_lies():
    """What lies on a soft contact never reaches pi/2."""

    class Lying(KnownWorld):
        def script(self, time, rate_s):
            theta, rate = super().script(time, rate_s)
            return (theta, rate) if abs(theta) < 1.56 else (math.copysign(1.56, theta), 0.0)

    found = seen(FALLING, 0.01, FALLING.duration, Lying)
    assert found.outcome is Outcome.OVERTURNED
    assert found.steps < 0.5 * FALLING.duration * BLOCK.p / 0.01


@pytest.mark.parametrize(
    ("precision", "outcome"),
    [(Precision.DOUBLE, Outcome.ROCKED), (Precision.SINGLE, Outcome.AT_REST)],
)
def test_an_engine_is_judged_by_what_its_numbers_tell_apart(precision, outcome):
    """A block at rest whose height trembles by 6e-8 of it, as single precision rounds."""
    asked = scene(pulse(0.9, 1.0), duration=5.0, max_steps=20_000)
    trembling = ScriptedWorld(
        asked, lambda time, _: 6e-8 * BLOCK.height * math.sin(1e4 * BLOCK.p * time)
    )
    declared = {"precision": precision, "shortest_step": 1e-6}
    assert watched(trembling, asked, Stepping.LANDING, **declared).outcome is outcome


def test_an_engine_may_choose_its_own_steps():
    """It is told times to go to, on the corners of the motion among them."""
    asked = scene(MOTION, duration=SEEN_S, times=TIMES, accuracy="loose")
    world = SelfSteppingWorld(asked)
    response = watched(world, asked, Stepping.OWN)
    for corner in (*MOTION.breakpoints[1:], SEEN_S):
        assert min(abs(end - corner) for end in world.steps) < 1e-12
    assert response.steps == 3 * len(world.steps) > 3 * 40.0 * BLOCK.p * SEEN_S
    errors = errors_of(response)
    # by straight lines and parabolas over looks of p dt = 1/40
    assert errors["time"] < 1e-3
    assert errors["ratio"] < 2e-2
    assert errors["peak"] < 1e-7
