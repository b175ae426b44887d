"""The block on a cart against Newton-Euler bodies with a contact that is solved for."""

import itertools
import math

import numpy as np
import pytest
from given import BLOCK, FULL_SINE, G
from independent import Bodies

from analytic import CartBlock, Outcome, Record, SinePulse, Still, cart_demands, simulate
from analytic.response import Reason


class Cart(Bodies):
    """A block (x, z, angle) and its cart's place, whole mass 1, in the frame of the shaken base."""

    def __init__(self, cart, motion=None):
        self.cart, self.motion, m = cart, motion or Still(), cart.mass_ratio
        inertia = m * (cart.width**2 + cart.height**2) / 12.0
        self.masses = np.array([m, m, inertia, 1.0 - m])

    def loads(self, q, time):
        push = float(self.motion.acceleration(time)) - self.cart.stiffness * q[3]
        return np.array([0.0, -self.cart.mass_ratio * G, 0.0, push])

    def contacts(self, q, side):
        jacobian, bent = self.held(q, (0, self.foot(side), 1.0))
        jacobian[0, 3] = -1.0
        return jacobian, bent

    def foot(self, side):
        return side * 0.5 * self.cart.width, -0.5 * self.cart.height


def solve(cart, motion, begin, end, times):
    """Return impacts (time, theta' before, after) and samples (theta, theta', cart, its rate)."""
    theta, rate = begin
    side, bodies = math.copysign(1.0, theta if theta else rate), Cart(cart, motion)
    q = np.array([0.0, 0.0, theta, 0.0])
    forward, up = bodies.contacts(q, side)[1][:, 2]  # what turning leaves of both
    q[:2] = side * 0.5 * cart.width + forward, up
    v = np.array([up * rate, -forward * rate, rate, 0.0])
    impacts, samples = [], []
    for path, _, impact in bodies.follow(
        q, v, side, 0.0, (*motion.breakpoints[1:], end), dense_output=True, rtol=1e-13, atol=1e-14
    ):
        at = times[(times > path.t[0]) & (times <= path.t[-1])]
        samples += [path.sol(s)[[2, 6, 3, 7]] for s in at]
        impacts += [(impact.time, impact.before[2], impact.after[2])] if impact else []
    return np.array(impacts), np.array(samples)


@pytest.mark.parametrize(("mass_ratio", "eta"), [(0.1, 0.905063), (0.5, 0.863636)])
def test_restitution(mass_ratio, eta):
    """Printed to six decimals; by the bodies' own impact to rounding."""
    cart = CartBlock(width=0.5, height=2.0, mass_ratio=mass_ratio)
    before = np.array([-1.0, -0.25, -1.0, 0.0])
    assert cart.restitution == pytest.approx(eta, abs=5e-7)
    after, _ = Cart(cart).struck(np.zeros(4), before, -1.0)
    assert after[2] == pytest.approx(-cart.restitution, rel=1e-13)


@pytest.mark.parametrize("stiffness", [0.0, 2.0, 40.0])
@pytest.mark.parametrize("mass_ratio", [0.05, 0.4, 0.8])
@pytest.mark.parametrize("seed", [1, 2])
def test_a_shaken_cart_moves_as_bodies_do(mass_ratio, stiffness, seed):
    """To 1e-9: DOP853 at 1e-13 a step, magnified by exp(p t) = 400 at the most.

    Of one that comes to rest, until the excursions are so small that SciPy steps over them.
    """
    draw = np.random.default_rng(seed)
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=mass_ratio, stiffness=stiffness)
    begin = (draw.choice([-1, 1]) * draw.uniform(0.2, 0.5) * cart.alpha, 0.0)
    motion = (
        Record(dt=0.25, samples=draw.normal(0.0, 1.0, 7))
        if seed == 1
        else SinePulse(amplitude=1.0, omega=6.0, half_cycles=2, phase=0.4)
    )
    times = np.linspace(0.05, 2.0, 40)
    impacts, samples = solve(cart, motion, begin, 2.0, times)
    response = simulate(cart, motion, start=begin, duration=2.0, times=times)
    found = np.array(response.impacts)
    seen = response.history.time.size
    assert seen == 40 or response.outcome is Outcome.OVERTURNED
    assert len(found) >= 1
    loud, heard = (np.array(rows)[np.abs(rows)[:, 1] > 0.05] for rows in (found, impacts))
    assert loud == pytest.approx(heard, abs=1e-9)
    if len(loud) < len(found):
        seen = int(np.searchsorted(times, loud[-1, 0]))
    ours = np.array([response.history.theta, response.history.velocity, *response.history.base]).T
    assert ours[:seen] == pytest.approx(samples[:seen], abs=1e-9)


@pytest.mark.parametrize("mass_ratio", [0.1, 0.5, 0.9])
def test_momentum_and_energy_of_a_free_cart(mass_ratio):
    """Nothing pushes: momentum is kept to rounding, and only impacts take energy."""
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=mass_ratio)
    times = np.linspace(0.0, 1.5, 301)
    start = (0.3 * cart.alpha, 0.3)
    response = simulate(cart, Still(), start=start, duration=1.5, times=times)
    history, r = response.history, cart.R
    theta, rate, (x, u) = history.theta, history.velocity, history.base
    z, side = cart.alpha - np.abs(theta), np.sign(theta)
    forward = r * np.cos(z) * rate
    momentum = u + mass_ratio * forward
    assert len(response.impacts) > 1
    assert momentum == pytest.approx(np.full(301, momentum[0]), abs=1e-12)
    centre = x + mass_ratio * r * (side * np.sin(cart.alpha) - side * np.sin(z))
    drift = centre[0] + momentum[0] * times
    assert centre == pytest.approx(drift, abs=1e-12)
    energy = 0.5 * u**2 + mass_ratio * (
        u * forward + 2.0 / 3.0 * (r * rate) ** 2 + G * r * np.cos(z)
    )
    struck_at = [0.0, *(impact.time for impact in response.impacts)]
    for begin, end in itertools.pairwise(struck_at):
        within = energy[(times > begin) & (times < end)]
        assert within == pytest.approx(np.full(within.size, within[:1]), rel=1e-13)


@pytest.mark.parametrize(
    "motion", [FULL_SINE, Record(dt=0.1, samples=3.0 * np.sin(np.arange(25.0)))]
)
def test_a_heavy_cart_gives_the_block_back(motion):
    """The cart's part is 1e-11: kappa = 25 and as much from eta make 1e-9 of the peak."""
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=1e-11)
    times = np.linspace(0.0, 3.0, 31)
    ours, its = (simulate(b, motion, times=times, duration=3.0) for b in (cart, BLOCK))
    assert ours.outcome is its.outcome
    assert ours.peak_ratio == pytest.approx(its.peak_ratio, rel=1e-8)
    assert ours.uplifts == pytest.approx(its.uplifts, rel=1e-9)
    assert ours.history.theta == pytest.approx(its.history.theta, abs=1e-9)
    assert ours.history.base[0] == pytest.approx(motion.displacement(times), abs=1e-9)
    short = min(len(ours.impacts), len(its.impacts), 8)
    assert np.array(ours.impacts[:short]) == pytest.approx(np.array(its.impacts[:short]), abs=1e-8)


def test_rest_and_uplift_again():
    """A block released at a hair's tilt comes to rest; the second pulse of the record lifts it."""
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=0.3, stiffness=5.0)
    samples = np.zeros(80)
    samples[60:70] = 4.5
    record = Record(dt=0.05, samples=samples)
    response = simulate(cart, record, start=(1e-4, 0.0), duration=record.duration)
    assert len(response.rests) >= 1
    assert response.rests[0] < 2.95 <= response.uplifts[0] <= 3.0
    still = simulate(cart, SinePulse(amplitude=1.0, omega=6.0))
    assert (still.outcome, still.peak_ratio) == (Outcome.AT_REST, 0.0)


def test_a_spring_that_never_lets_it_rest_is_said_so():
    """An undamped cart of 1e6 times the block's mass loses nothing that counts."""
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=1e-6, stiffness=400.0)
    pulse = SinePulse(amplitude=8.0, omega=20.0, half_cycles=2)
    undecided = simulate(cart, pulse)
    assert (undecided.outcome, undecided.reason) == (Outcome.FAILED, Reason.UNDECIDED)
    assert simulate(cart, pulse, duration=1.0).outcome is Outcome.ROCKED


@pytest.mark.parametrize(
    ("mass_ratio", "stiffness", "pulse"), [(0.9, 0.0, (6.0, 20.0)), (0.3, 60.0, (9.81, 16.0))]
)
def test_what_the_contact_must_bear(mass_ratio, stiffness, pulse):
    """By differences of the block's velocity, away from impacts: to the square of their distance.

    A cart so heavy that it is a base asks what that does.
    """
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=mass_ratio, stiffness=stiffness)
    motion = SinePulse(amplitude=pulse[0], omega=pulse[1], half_cycles=2)
    times = np.linspace(0.0, 1.5, 20001)
    response = simulate(cart, motion, duration=1.5, times=times)
    theta, rate, speed = response.history.theta, response.history.velocity, response.history.base[1]
    z, side = cart.alpha - np.abs(theta), np.sign(theta)
    velocities = (speed + cart.R * np.cos(z) * rate, cart.R * np.sin(z) * side * rate)
    along, up = (np.gradient(velocity, times) for velocity in velocities)
    apart = [np.abs(times - impact.time) for impact in response.impacts]
    apart += [np.abs(times - time) for time in motion.breakpoints]
    seen = (np.min(apart, axis=0) > 3e-4) & (side != 0.0) & (np.abs(theta) < 2.0 * cart.alpha)
    found = cart_demands(cart, motion, duration=1.5, samples=20001)
    assert found.friction == pytest.approx((np.abs(along) / (G + up))[seen].max(), rel=1e-2)
    assert found.normal == pytest.approx((1.0 + up / G)[seen].min(), rel=1e-2)
    heavy = CartBlock(width=0.5, height=1.5, mass_ratio=1e-9)
    block = simulate(BLOCK, FULL_SINE)
    needs = cart_demands(heavy, FULL_SINE, duration=FULL_SINE.duration + 4.0, samples=40001)
    assert needs.normal == pytest.approx(block.min_normal, rel=1e-2)
    assert needs.friction == pytest.approx(block.friction_needed, rel=1e-2)


def test_a_block_at_rest_asks_nothing_of_a_pivot():
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=0.3)
    needs = cart_demands(cart, SinePulse(amplitude=1.0, omega=6.0), duration=2.0)
    assert np.isnan(needs.friction) and np.isnan(needs.normal)


@pytest.mark.parametrize("start", [(0.0, 0.0), (0.05, -0.1)])
@pytest.mark.parametrize("stiffness", [0.0, 20.0])
def test_a_cart_that_nothing_shakes_is_sampled_from_its_start(start, stiffness):
    cart = CartBlock(width=0.5, height=1.5, mass_ratio=0.3, stiffness=stiffness)
    first = simulate(cart, Still(), start=start, times=[0.0]).history
    more = simulate(cart, Still(), start=start, times=[0.0, 0.0, 0.3], duration=0.3).history
    assert first.time.tolist() == [0.0] and more.time.tolist() == [0.0, 0.0, 0.3]
    assert first.theta.tolist() == [start[0]] == [more.theta[0]] == [more.theta[1]]
    assert first.velocity.tolist() == [start[1]] == [more.velocity[0]]
    assert first.base.tolist() == [[0.0], [0.0]]
    assert (more.theta[2] != start[0]) == (start != (0.0, 0.0))
