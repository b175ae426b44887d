"""A block whose mass stands off the middle: against SciPy, by its mirror, and by closed forms."""

import math
from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic import RigidBlock, SinePulse, Still, simulate
from analytic.response import Outcome

BLOCK = RigidBlock(width=0.6, height=1.8, offset=0.12)


def impulse_ratio(block, sign):
    """Return the velocity ratio of an impact by the impulse at the corner that strikes."""
    square, down = (block.width**2 + block.height**2) / 12.0, -0.5 * block.height
    old, new = (np.array([way * 0.5 * block.width - block.offset, down]) for way in (sign, -sign))
    # unknown: the rate after, and the impulse; known: momentum, and its moment about the mass
    matrix = np.array([[new[1], -1.0, 0.0], [-new[0], 0.0, -1.0], [square, new[1], -new[0]]])
    return max(np.linalg.solve(matrix, [old[1], -old[0], square])[0], 0.0)


def uplift(block, pulse, since):
    """Return when a block at rest lifts, and onto which side, 1 or -1; inf and 0 if never."""
    for number in range(pulse.half_cycles):
        side = -math.copysign(1.0, pulse.amplitude) * (-1) ** number
        onset = block.gravity * math.tan(block.sides[side < 0].alpha) / abs(pulse.amplitude)
        begin, end = number * math.pi, (number + 1) * math.pi
        if onset < 1.0 and end - math.asin(onset) > pulse.omega * since:
            return max((begin + math.asin(onset)) / pulse.omega, since), side
    return math.inf, 0


def fallen(block, pulse):
    """Return peak ratios of both sides by SciPy with events; inf on the side of a fall."""
    peaks, end, sides = [0.0, 0.0], pulse.duration, block.sides
    t, side = uplift(block, pulse, 0.0)
    theta = rate = 0.0

    def moving(t, x):
        one, a = sides[side < 0], pulse.acceleration(t) / block.gravity if t < end else 0.0
        z = one.alpha - side * x[0]
        return x[1], -side * one.p**2 * (math.sin(z) + side * a * math.cos(z))

    def strikes(t, x):
        return side * x[0]

    def lies(t, x):
        return abs(x[0]) - 0.5 * math.pi

    strikes.terminal, strikes.direction, lies.terminal = True, -1, True
    while t < math.inf and (t <= end or abs(rate) > 1e-3):
        path = solve_ivp(
            moving,
            (t, end if t < end else t + 60.0 / block.p),
            (theta, rate),
            "DOP853",
            events=[strikes, lies, lambda t, x: x[1]],
            rtol=1e-12,
            atol=1e-14,
            first_step=1e-4 if theta == 0.0 else None,
        )
        place = int(side < 0)
        tops = [path.y[0][-1], *(x[0] for x in path.y_events[2])]
        peaks[place] = max(peaks[place], *np.abs(tops) / sides[place].alpha)
        struck, lying, _ = map(len, path.t_events)
        if lying or (t >= end and not struck):
            peaks[place] = math.inf
            break
        t, (theta, rate) = path.t[-1], path.y[:, -1]
        if struck:
            theta, rate, side = 0.0, rate * impulse_ratio(block, side), -side
            if abs(rate) < 1e-9:
                rate, (t, side) = 0.0, uplift(block, pulse, t)
    return peaks


def drawn(count, seed):
    rng = np.random.default_rng(seed)
    for _ in range(count):
        height = rng.uniform(0.5, 3.0)
        width = height * rng.uniform(0.2, 0.5)
        offset = width * rng.uniform(-0.3, 0.3)
        block = RigidBlock(width=width, height=height, offset=offset)
        yield (
            block,
            SinePulse(
                amplitude=rng.choice([-1, 1])
                * rng.uniform(1.05, 4.0)
                * 9.81
                * math.tan(block.alpha),
                omega=block.p * rng.uniform(1.5, 8.0),
                half_cycles=int(rng.integers(1, 5)),
            ),
        )


@pytest.mark.parametrize("part", range(4))
def test_random_blocks_do_what_scipy_finds(part):
    overturned = 0
    for block, pulse in drawn(50, part):
        found, expected = simulate(block, pulse), fallen(block, pulse)
        assert (found.outcome is Outcome.OVERTURNED) == (max(expected) == math.inf), (block, pulse)
        if found.outcome is Outcome.OVERTURNED:
            overturned += 1
        else:
            assert found.peak_sides == pytest.approx(expected, rel=1e-8, abs=1e-9), (block, pulse)
            assert found.peak_ratio == max(found.peak_sides)
    assert 5 < overturned < 45


def test_a_mirrored_block_has_the_mirrored_response():
    for block, pulse in drawn(20, 9):
        other = replace(block, restitution=None, offset=-block.offset)
        found = simulate(block, pulse)
        turned = simulate(other, replace(pulse, amplitude=-pulse.amplitude))
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


@pytest.mark.parametrize("given", [{"offset": 0.3}, {"inertia": 0.0}, {"restitution": 0.5}])
def test_what_no_block_has_is_refused(given):
    with pytest.raises(ValueError, match="; it must"):
        RigidBlock(**{"width": 0.6, "height": 1.8, "offset": 0.1} | given)
