"""The rocking frame against rigid bodies: Newton-Euler with every contact as a constraint."""

import math
from itertools import product

import numpy as np
import pytest
from given import FULL_SINE as PULSE
from given import G
from scipy.integrate import solve_ivp

from analytic import MODELS, Record, RigidBlock, RockingFrame, Still, conditioning, simulate
from analytic.frame import frame_restitution
from analytic.frame_forces import frame_demands

SIZES = [(0.5, 1.5), (0.5, 2.0), (1.0, 6.0)]
SPACING, DEPTH = 3.0, 0.3


class Frame:
    """N columns and a beam, which is the last body, relative to a base that may be shaken.

    Of each body the coordinates q are x, z and the angle clockwise, and v are their velocities.
    """

    def __init__(self, frame, motion=None):
        n, self.frame, self.motion = frame.columns, frame, motion or Still()
        inertia = (frame.width**2 + frame.height**2) / 12.0
        long, beam = (n - 1) * SPACING + frame.width, n * frame.load
        columns = [1.0, 1.0, inertia] * n
        self.masses = np.array([*columns, beam, beam, beam * (long**2 + DEPTH**2) / 12.0])
        self.places = (np.arange(n) - 0.5 * (n - 1)) * SPACING
        standing = [number for x in self.places for number in (x, 0.5 * frame.height, 0.0)]
        self.upright = np.array([*standing, 0.0, frame.height + 0.5 * DEPTH, 0.0])

    def held(self, q, *points):
        """Return both for points (first coordinate of a body, place on it, sign), which add up."""
        jacobian, bent = np.zeros((2, 2, len(q)))
        for first, (u, w), sign in points:
            c, s = math.cos(q[first + 2]), math.sin(q[first + 2])
            arm = np.array([c * u + s * w, -s * u + c * w])
            jacobian[:, first : first + 2] = sign * np.eye(2)
            jacobian[:, first + 2] = sign * np.array([arm[1], -arm[0]])
            bent[:, first + 2] = -sign * arm
        return jacobian, bent

    def contacts(self, q, side):
        """Return their Jacobian, two rows each, and what is left of an acceleration times v**2.

        Clockwise, on side +1, a column stands on its right foot; its head's rows come after.
        """
        half, beam = side * 0.5 * self.frame.width, 3 * self.frame.columns
        foot, rows = np.array([half, -0.5 * self.frame.height]), []
        for i, place in enumerate(self.places):
            carried = beam, (place - half, -0.5 * DEPTH), -1.0
            rows += [self.held(q, (3 * i, foot, 1.0))]
            rows += [self.held(q, (3 * i, -foot, 1.0), carried)]
        return map(np.concatenate, zip(*rows, strict=True))

    def accelerations(self, q, v, side, time):
        """Return the accelerations, and the forces (x, z) by contact."""
        (jacobian, bent), mass = self.contacts(q, side), self.masses
        whole = np.block([[np.diag(mass), -jacobian.T], [jacobian, np.zeros((len(bent),) * 2)]])
        pulls = [-float(self.motion.acceleration(time)), -G, 0.0]
        known = np.concatenate((mass * np.tile(pulls, self.frame.columns + 1), -bent @ v**2))
        found = np.linalg.lstsq(whole, known, rcond=1e-12)[0]
        return found[: mass.size], found[mass.size :].reshape(-1, 2)

    def struck(self, q, v, side):
        """Return the velocities and impulses of an ideally inelastic impact of a side."""
        jacobian, _ = self.contacts(q, side)
        by_mass = jacobian / self.masses
        impulse = np.linalg.lstsq(by_mass @ jacobian.T, -jacobian @ v, rcond=1e-12)[0]
        return v + by_mass.T @ impulse, impulse.reshape(-1, 2)


def solve(frame, motion, end, longest=0.02):
    """Return peaks over alpha of the columns, ratios of impacts, contact forces and impulses."""
    bodies, angles = Frame(frame, motion), slice(2, 3 * frame.columns, 3)
    t = math.asin(G * math.tan(frame.alpha) / motion.amplitude) / motion.omega
    q, v, side = bodies.upright, 0.0 * bodies.upright, -1.0
    peaks, ratios, forces, impulses = [], [], [], []

    def flow(t, state, side):
        q, v = np.split(state, 2)
        return np.concatenate((v, bodies.accelerations(q, v, side, t)[0]))

    def lands(t, state, side):
        return side * state[2]

    def turns(t, state, side):
        return side * state[len(q) + 2]

    lands.terminal, lands.direction, turns.direction = True, -1, -1
    while t < end:
        until = min(stop for stop in (motion.duration, end) if stop > t * (1.0 + 1e-14))
        path = solve_ivp(
            flow, (t, until), np.concatenate((q, v)), "DOP853", events=(lands, turns),
            args=(side,), rtol=1e-12, atol=1e-14, max_step=longest,
        )  # fmt: skip
        for time, state in zip(path.t, path.y.T, strict=True):
            forces.append(bodies.accelerations(*np.split(state, 2), side, time)[1])
        peaks += [state[angles] for state in path.y_events[1]]
        t, (q, v) = path.t[-1], np.split(path.y[:, -1], 2)
        if path.status == 1:
            after, impulse = bodies.struck(q, v, -side)
            ratios.append(after[2] / v[2])
            impulses.append(impulse)
            side, v = -side, after
    return np.abs(peaks).max(axis=0) / frame.alpha, ratios, np.array(forces), np.array(impulses)


@pytest.mark.parametrize("columns", [2, 3])
@pytest.mark.parametrize("load", [0.5, 2.0, 4.0])
def test_a_frame_moves_as_rigid_bodies_in_contact_do(load, columns):
    """Solved to 1e-12 a step, of which kappa = 25 and some hundred steps make 1e-8 of the peak."""
    frame = RockingFrame(width=0.5, height=1.5, columns=columns, load=load)
    peaks, ratios, _, _ = solve(frame, PULSE, 2.0)
    exact = simulate(frame, PULSE)
    assert peaks == pytest.approx(np.full(columns, exact.peak_ratio), rel=1e-8)
    assert ratios == pytest.approx([frame.restitution] * len(ratios), abs=1e-9)
    assert exact.peak_ratio == pytest.approx({0.5: 0.25013, 2: 0.20566, 4: 0.19524}[load], abs=6e-6)


@pytest.mark.parametrize(("width", "height"), SIZES)
def test_frequency_and_restitution_of_the_tables(width, height):
    """Makris and Vassiliou (2013): rounded to six decimals."""
    tables = {
        (0.5, 1.5): "2.728602 2.641957 2.578286 2.538310 0.820000 0.812500 0.807143 0.803846",
        (0.5, 2.0): "2.389615 2.313735 2.257974 2.222964 0.894118 0.889706 0.886555 0.884615",
        (1.0, 6.0): "1.391152 1.346977 1.314515 1.294134 0.951351 0.949324 0.947876 0.946985",
    }
    frames = [RockingFrame(width=width, height=height, load=load) for load in (0.5, 1, 2, 4)]
    found = [frame.p for frame in frames] + [frame.restitution for frame in frames]
    printed = [float(number) for number in tables[width, height].split()]
    assert found == pytest.approx(printed, abs=5.1e-7)


@pytest.mark.parametrize(("width", "height"), SIZES)
@pytest.mark.parametrize("columns", [2, 3, 5])
def test_an_inelastic_impact_of_all_contacts(width, height, columns):
    """The bodies' own impact: linear equations of condition 1e3, solved to 1e-13 or better."""
    frame = RockingFrame(width=width, height=height, columns=columns, load=1.7)
    bodies = Frame(frame)
    q = bodies.upright
    v = np.array([-0.5 * height, -0.5 * width, -1.0] * columns + [-height, -width, 0.0])
    jacobian, _ = bodies.contacts(q, 1.0)
    assert jacobian @ v == pytest.approx(0.0, abs=1e-14)
    after, impulse = bodies.struck(q, v, -1.0)
    assert after[2 : 3 * columns : 3] == pytest.approx(
        np.full(columns, -frame.restitution), rel=1e-12
    )
    assert np.all(impulse[::2, 1] > 0.0)
    parting = jacobian[1::2] @ after
    assert np.all(parting[::2] > 0.0)
    assert np.all(parting[1::2] < 0.0)
    leaning = (1.0 - frame.restitution) / (1.0 + frame.restitution) / math.tan(frame.alpha)
    for ends in (impulse[::2], impulse[1::2]):
        across, along = np.abs(ends.sum(axis=0))
        assert across / along == pytest.approx(leaning, rel=1e-12)


def test_a_frame_moves_as_a_block_that_is_as_large_as_its_load_says():
    """The same alpha, p and eta: equal to rounding, of which kappa = 25 makes 1e-13."""
    frame, growth = RockingFrame(width=0.5, height=1.5, columns=3, load=2.0), 7.0 / 5.0
    sizes = {"width": growth * 0.5, "height": growth * 1.5, "restitution": frame.restitution}
    block = RigidBlock(**sizes)
    assert (block.alpha, block.p) == pytest.approx((frame.alpha, frame.p), rel=1e-15)
    record = Record(dt=0.1, samples=np.random.default_rng(1).normal(0.0, 2.0, 30))
    for model, motion in product(MODELS, (PULSE, record)):
        ours, its = (simulate(body, motion, model, (0.1, 0.2)) for body in (frame, block))
        assert (ours.outcome, len(ours.impacts)) == (its.outcome, len(its.impacts))
        assert ours.peak_ratio == pytest.approx(its.peak_ratio, rel=1e-10)
    assert conditioning(frame, PULSE) == pytest.approx(conditioning(block, PULSE), rel=1e-8)
    assert math.isnan(simulate(frame, PULSE).friction_needed)


@pytest.mark.parametrize("load", [0.5, 4.0])
def test_demands_are_the_forces_of_the_rigid_bodies(load):
    """States some ms apart miss an extreme by (dt p)^2, some 1e-5; the last swing is put beside."""
    frame = RockingFrame(width=0.5, height=1.5, load=load)
    _, _, forces, impulses = solve(frame, PULSE, 2.0, longest=0.004)
    q = Frame(frame).upright
    least = Frame(frame).accelerations(q, 0.0 * q, 1.0, 0.0)[1]
    forces = np.concatenate((forces, [least]))
    pushes = np.concatenate((forces, impulses))
    needs = frame_demands(frame, PULSE, spacing=SPACING, depth=DEPTH)
    ratio = np.abs(pushes[:, :, 0] / pushes[:, :, 1])
    assert len(impulses)
    assert needs.base == pytest.approx(ratio[:, ::2].max(), rel=1e-4)
    assert needs.top == pytest.approx(ratio[:, 1::2].max(), rel=1e-4)
    # heads are pressed down by the beam
    pressing = min(
        (forces[:, ::2, 1] / (G * (1.0 + load))).min(), (-forces[:, 1::2, 1] / (G * load)).min()
    )
    assert needs.pressing == pytest.approx(pressing, rel=1e-4)
    across, along = pushes[:, 1::2].sum(axis=1).T
    assert needs.spacing == pytest.approx(0.5 + np.abs(across / along).max() * DEPTH, rel=1e-4)


def test_a_squat_frame_comes_to_rest_at_its_first_impact():
    frame = RockingFrame(width=1.0, height=1.0, load=3.0)
    assert frame_restitution(frame.alpha, 3.0) < 0.1
    squat = RockingFrame(width=2.0, height=1.0, load=3.0)
    assert frame_restitution(squat.alpha, 3.0) < 0.0
    assert squat.restitution == 0.0
