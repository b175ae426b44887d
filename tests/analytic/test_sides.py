"""A mass off the middle, and a base that moves vertically too: by SciPy, limits and mirrors."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.optimize import brentq

from analytic import Outcome, Record, RigidBlock, SinePulse, Still, conditioning, simulate
from analytic.motion import BothWays

BLOCK = RigidBlock(width=0.6, height=1.8, offset=0.12)
EVEN = RigidBlock(width=0.5, height=1.5)
PULSE = SinePulse.in_g(0.36, omega=6.2832, half_cycles=2)
UPWARD = SinePulse.in_g(0.3, omega=11.0, half_cycles=5)


def impulse_ratio(block, sign):
    """Return the velocity ratio of an impact by the impulse at the corner that strikes."""
    square, down = (block.width**2 + block.height**2) / 12.0, -0.5 * block.height
    old, new = (np.array([way * 0.5 * block.width - block.offset, down]) for way in (sign, -sign))
    # unknown: the rate after, and the impulse; known: momentum, and its moment about the mass
    matrix = np.array([[new[1], -1.0, 0.0], [-new[0], 0.0, -1.0], [square, new[1], -new[0]]])
    return max(np.linalg.solve(matrix, [old[1], -old[0], square])[0], 0.0)


def excess(block, motion, upward, side, t):
    """Return by how much the ground exceeds what lifts the block onto a side, over g."""
    slope, heavy = math.tan(block.sides[side < 0].alpha), 1.0 + upward.acceleration(t) / 9.81
    return -side * motion.acceleration(t) / 9.81 - slope * heavy


def lifted(block, motion, upward, since):
    """Return when and onto which side a block at rest lifts, sought on a fine grid."""
    found = []
    for side in (1, -1):
        times = np.linspace(since, motion.duration, 4001)
        above = np.flatnonzero(excess(block, motion, upward, side, times) > 0.0)
        for at in above[above > 0][:1]:
            bracket, args = times[at - 1 : at + 1], (block, motion, upward, side)
            found.append((brentq(lambda t, a=args: excess(*a, t), *bracket, xtol=1e-15), side))
    return min(found, default=(math.inf, 0))


def solved(block, motion, upward):
    """Return the peaks of both sides by SciPy with events, inf on the side of a fall."""
    (t, side), theta, rate = lifted(block, motion, upward, 0.0), 0.0, 0.0
    sides, peaks = block.sides, [0.0, 0.0]
    knots = [*BothWays(motion, upward).breakpoints, math.inf]

    def moving(t, x):
        one, now = sides[side < 0], min(max(t, begin), end)
        a, heavy = motion.acceleration(now) / 9.81, 1.0 + upward.acceleration(now) / 9.81
        z = one.alpha - side * x[0]
        return x[1], -side * one.p**2 * (heavy * math.sin(z) + side * a * math.cos(z))

    def strikes(t, x):
        return side * x[0]

    def lies(t, x):
        return abs(x[0]) - 0.5 * math.pi

    strikes.terminal, strikes.direction, lies.terminal = True, -1, True
    while t < math.inf and (t < knots[-2] or abs(rate) > 1e-3):
        begin, end = t + 1e-13, next(knot for knot in knots if knot > t + 1e-12) - 1e-13
        path = solve_ivp(
            *(moving, (t, min(end + 1e-13, t + 60.0 / block.p)), (theta, rate), "DOP853"),
            events=[strikes, lies, lambda t, x: x[1]],
            **{"rtol": 1e-12, "atol": 1e-14, "first_step": None if theta else 1e-5},
        )
        tops = [path.y[0][-1], *(x[0] for x in path.y_events[2])]
        peaks[side < 0] = max(peaks[side < 0], *np.abs(tops) / sides[side < 0].alpha)
        t, (theta, rate) = path.t[-1], path.y[:, -1]
        if len(path.t_events[1]) or (end == math.inf and not len(path.t_events[0])):
            peaks[side < 0] = math.inf
            break
        if len(path.t_events[0]):
            theta, rate, side = 0.0, rate * impulse_ratio(block, side), -side
            if abs(rate) < 1e-9:
                rate, (t, side) = 0.0, lifted(block, motion, upward, t)
    return peaks


def drawn(count, seed):
    """Yield blocks, every third one even, and pulses both ways of ends of their own."""
    rng = np.random.default_rng(seed)
    for number in range(count):
        height = rng.uniform(0.5, 3.0)
        width = height * rng.uniform(0.2, 0.5)
        offset = width * rng.uniform(-0.3, 0.3) * (number % 3 > 0)
        block = RigidBlock(width=width, height=height, offset=offset)
        level = rng.choice([-1, 1]) * rng.uniform(1.05, 4.0) * math.tan(block.alpha)
        pulses = []
        for size in (level, rng.uniform(-0.9, 0.9)):
            omega, cycles = block.p * rng.uniform(1.5, 8.0), int(rng.integers(1, 5))
            pulses.append(SinePulse.in_g(size, omega=omega, half_cycles=cycles))
        yield block, *pulses


SLOW = pytest.param(200, True, 1, marks=pytest.mark.slow)


@pytest.mark.parametrize(
    ("count", "heavy", "seed"), [*((50, False, seed) for seed in range(4)), (10, True, 4), SLOW]
)
def test_random_blocks_do_what_scipy_finds(count, heavy, seed):
    overturned = 0
    for block, pulse, upward in drawn(count, seed):
        upward = upward if heavy else Still()
        found, expected = simulate(block, pulse, vertical=upward), solved(block, pulse, upward)
        assert (found.outcome is Outcome.OVERTURNED) == (max(expected) == math.inf), (block, pulse)
        if found.outcome is Outcome.OVERTURNED:
            overturned += 1
        elif not heavy or conditioning(block, BothWays(pulse, upward))[0] < 100.0:
            rel, small = (1e-9, 1e-9 * max(expected)) if heavy else (1e-8, 1e-9)
            assert found.peak_sides == pytest.approx(expected, rel=rel, abs=small), (block, pulse)
            assert found.peak_ratio == max(found.peak_sides)
    assert 0.1 * count < overturned < 0.9 * count


def test_a_mirrored_block_has_the_mirrored_response():
    for block, pulse, upward in drawn(20, 9):
        other = replace(block, restitution=None, offset=-block.offset)
        found = simulate(block, pulse, vertical=upward)
        turned = simulate(other, replace(pulse, amplitude=-pulse.amplitude), vertical=upward)
        assert found.peak_sides == turned.peak_sides[::-1]
        assert found.outcome is turned.outcome


def test_a_block_released_on_its_strong_side_falls_over_the_weak_one():
    """From where the energy after the impact is that of the weak side's barrier."""
    weak, strong = BLOCK.sides
    barrier = weak.p**2 * (1.0 - math.cos(weak.alpha)) / (strong.restitution * strong.p) ** 2
    theta = strong.alpha - math.acos(math.cos(strong.alpha) + barrier)
    more, less = (simulate(BLOCK, Still(), start=(-theta * x, 0.0)) for x in (1 + 1e-9, 1 - 1e-9))
    assert (more.outcome, less.outcome) == (Outcome.OVERTURNED, Outcome.ROCKED)
    assert less.peak_sides == pytest.approx((1.0, theta / strong.alpha), abs=1e-3)
    assert theta < 0.3 * strong.alpha


def test_contact_forces_are_those_of_a_homogeneous_block_alone():
    sizes, pulse = {"width": 0.6, "height": 1.8}, SinePulse(amplitude=4.0, omega=6.0)
    blocks = [RigidBlock(**sizes, inertia=each) for each in (None, 0.3)]
    needed = [simulate(block, pulse).friction_needed for block in blocks]
    assert [math.isnan(each) for each in needed] == [False, True]


def test_limits():
    """No acceleration upwards changes no bit; a constant one is another g."""
    plain = simulate(EVEN, PULSE)
    for none in (Still(), SinePulse(amplitude=0.0, omega=1.0), Record(dt=9.0, samples=[0.0, 0.0])):
        assert replace(simulate(EVEN, PULSE, vertical=none), wall_s=plain.wall_s) == plain
    for up, phase in ((3.0, 0.0), (-3.0, 1.0)):  # of the latter the ground lifts it at once
        pulse, constant = replace(PULSE, phase=phase), Record(dt=1.0, samples=[up] * 9)
        more = simulate(EVEN, pulse, vertical=constant)
        other = simulate(replace(EVEN, gravity=9.81 + up), pulse)
        for name in ("peak_ratio", "friction_needed", "uplifts"):
            assert getattr(more, name) == pytest.approx(getattr(other, name), rel=1e-9), name
    assert more.uplifts == (0.0,)
    assert more.min_normal == pytest.approx(other.min_normal * 6.81 / 9.81, rel=1e-9)


def test_records_both_ways_are_the_pulses_that_they_sample():
    """Each has a step and an end of its own."""
    level, upward = (
        Record(dt=dt, samples=pulse.acceleration(dt * np.arange(round(pulse.duration / dt) + 1)))
        for pulse, dt in ((PULSE, 1e-3), (UPWARD, UPWARD.duration / 700.0))
    )
    found = simulate(EVEN, level, vertical=upward)
    expected = simulate(EVEN, PULSE, vertical=UPWARD)
    assert found.peak_ratio == pytest.approx(expected.peak_ratio, rel=1e-3)
    assert found.min_normal == pytest.approx(expected.min_normal, rel=1e-3)
