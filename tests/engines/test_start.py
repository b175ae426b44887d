"""A run that begins aloft: released from a tilt, set turning upright, or sliding away under it.

`uses.band` says how near landing steps come; fixed ones carry the p dt of the impact's step.
"""

import math
from dataclasses import replace

import numpy as np
import pytest
import uses
from closed_forms import free_amplitude, quarter_period
from declared import rounding
from known import standing
from uses import BLOCK, CORE, HERE, agreed, band, pulse, rocked, scene, speed_band

from analytic import RigidBlock
from analytic.motion import SinePulse, Still
from analytic.response import Outcome
from engines.run.run import build
from engines.scene import ACCURACIES

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


@uses.every_use
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
