"""Steady rolling against a rigid body in space whose lowest rim point does not slide."""

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analytic import RollingCylinder

G = 9.81
UP = np.array([0.0, 0.0, 1.0])
FAT = RollingCylinder(radius=0.5, height=0.5, tilt=0.2)
TALL = RollingCylinder(radius=0.5, height=2.0, tilt=0.1)
STEEP = RollingCylinder(radius=0.5, height=2.0, tilt=1.2)
DISK = RollingCylinder(radius=1.0, height=1e-9, tilt=0.3)


def cross(a):
    """Return the matrix of a cross product."""
    return np.array([[0.0, -a[2], a[1]], [a[2], 0.0, -a[0]], [-a[1], a[0], 0.0]])


def foot_of(cylinder, axis, rates):
    """Return the lowest point of the lower rim from the centre, and its derivative."""
    turning = np.cross(rates, axis)
    flat = UP - axis[2] * axis
    size = np.linalg.norm(flat)
    slope = flat / size
    change = -turning[2] * axis - axis[2] * turning
    bend = (change - slope * (slope @ change)) / size
    half = 0.5 * cylinder.height
    return -half * axis - cylinder.radius * slope, -half * turning - cylinder.radius * bend


def flow(cylinder, state):
    """Return the derivative of (centre, axis, velocity, rates), with the contact's force solved.

    V' = F/m - g, I w' + w x I w = c x F, and d/dt (V + w x c) = 0.
    """
    axis, velocity, rates = state[3:6], state[6:9], state[9:12]
    across = 0.25 * cylinder.radius**2 + cylinder.height**2 / 12.0
    along = 0.5 * cylinder.radius**2
    inertia = across * np.eye(3) + (along - across) * np.outer(axis, axis)
    c, moved = foot_of(cylinder, axis, rates)
    matrix = np.zeros((9, 9))
    matrix[:3, :3], matrix[:3, 6:] = np.eye(3), -np.eye(3)
    matrix[3:6, 3:6], matrix[3:6, 6:] = inertia, -cross(c)
    matrix[6:, :3], matrix[6:, 3:6] = np.eye(3), -cross(c)
    known = np.concatenate((-G * UP, -np.cross(rates, inertia @ rates), -np.cross(rates, moved)))
    found = np.linalg.solve(matrix, known)
    return np.concatenate((velocity, np.cross(rates, axis), found[:6]))


def rolled(cylinder, state, times):
    """Return the states (times, 12) by SciPy at 1e-13 a step."""
    path = solve_ivp(
        lambda _, now: flow(cylinder, now), (0.0, times[-1]), state, "DOP853",
        times, rtol=1e-13, atol=1e-15,
    )  # fmt: skip
    return path.y.T


def start(cylinder):
    begin = cylinder.at(0.0)
    centre = cylinder.centre_height * UP
    return np.concatenate((centre, begin.axis[0], np.zeros(3), begin.rates[0]))


@pytest.mark.parametrize(
    ("cylinder", "precession"), [(FAT, 17.719407), (TALL, 10.292109), (DISK, 11.523142)]
)
def test_precession(cylinder, precession):
    """Printed to six decimals; the thin disk by its closed forms, too."""
    assert cylinder.precession == pytest.approx(precession, abs=5.1e-7)
    if cylinder is DISK:
        square = 4.0 * G / (cylinder.radius * math.sin(cylinder.tilt))
        assert cylinder.precession**2 == pytest.approx(square, rel=1e-8)
        swing = (3.0 + math.sin(cylinder.tilt) ** 2) / 5.0
        assert cylinder.wobble == pytest.approx(swing * square, rel=1e-8)


@pytest.mark.parametrize("cylinder", [FAT, TALL, DISK])
def test_it_rolls_as_a_rigid_body_without_sliding_does(cylinder):
    """Five turns, solved to 1e-12 a step, some hundred steps: to 1e-9."""
    times = np.linspace(0.0, 5.0 * cylinder.turn, 41)
    found = rolled(cylinder, start(cylinder), times)
    exact = cylinder.at(times)
    assert found[:, :3] == pytest.approx(np.tile(start(cylinder)[:3], (41, 1)), abs=1e-9)
    assert found[:, 3:6] == pytest.approx(exact.axis, abs=1e-9)
    assert found[:, 6:9] == pytest.approx(0.0, abs=1e-9)
    assert found[:, 9:12] == pytest.approx(exact.rates, abs=1e-9 * cylinder.precession)
    tilt = np.arccos(found[:, 5])
    assert tilt == pytest.approx(np.full(41, cylinder.tilt), abs=1e-9)


@pytest.mark.parametrize("cylinder", [FAT, TALL, DISK])
def test_states_are_those_of_one_motion(cylinder):
    """Central differences err by (Omega dt)^2/6 and rounding over Omega dt: 1e-8 in all."""
    dt = 1e-5 / cylinder.precession
    before, now, after = (cylinder.at(0.7 + n * dt) for n in (-1, 0, 1))
    change = (after.turned[0] - before.turned[0]) / (2.0 * dt)
    assert change == pytest.approx(cross(now.rates[0]) @ now.turned[0], abs=1e-8 * 20.0)
    assert now.turned[0] @ now.turned[0].T == pytest.approx(np.eye(3), abs=1e-14)
    assert now.turned[0] @ UP == pytest.approx(now.axis[0], abs=1e-14)
    foot = now.foot[0] - cylinder.centre_height * UP
    assert foot == pytest.approx(foot_of(cylinder, now.axis[0], now.rates[0])[0], abs=1e-12)
    # the centre is at rest: the material at the foot is, too
    assert np.cross(now.rates[0], foot) == pytest.approx(0.0, abs=1e-13 * cylinder.precession)


def test_energy_is_that_of_the_body():
    state = FAT.at(0.3)
    turned, rates = state.turned[0], state.rates[0]
    across, along = 0.25 * 0.25 + 0.25 / 12.0, 0.125
    inertia = turned @ np.diag([across, across, along]) @ turned.T
    energy = G * FAT.centre_height + 0.5 * rates @ inertia @ rates
    assert energy == pytest.approx(FAT.energy, rel=1e-14)


@pytest.mark.parametrize("cylinder", [FAT, TALL, DISK, STEEP])
def test_growth_is_what_disturbances_become(cylinder):
    """Each of four is put into the rates or the tilt, 1e-6 of it, for a turn and a half."""
    time, rate = 1.5 * cylinder.turn, cylinder.precession
    axis, nod = start(cylinder)[3:6], np.array([0.0, 1.0, 0.0])
    up_face = (UP - axis[2] * axis) / math.sin(cylinder.tilt)
    ends = []
    for lean, change in ((1.0, 0.0 * nod), (0.0, up_face), (0.0, nod), (0.0, axis)):
        state = start(cylinder)
        c, s = math.cos(1e-6 * lean), math.sin(1e-6 * lean)
        turn = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        # the axis leans to +x: a tilt is a turn about y, with which the rates go
        state[3:6], state[9:12] = turn @ state[3:6], turn @ state[9:12] + 1e-6 * rate * change
        state[6:9] = -np.cross(state[9:12], foot_of(cylinder, state[3:6], state[9:12])[0])
        found = rolled(cylinder, state, [time])[-1]
        tilt = math.atan2(math.hypot(found[3], found[4]), found[5]) - cylinder.tilt
        phase = math.remainder(math.atan2(found[4], found[3]) - rate * time, 2.0 * math.pi)
        ends.append((1e6 * tilt, 1e6 * phase))
    assert np.linalg.norm(ends, axis=0) == pytest.approx(cylinder.growth(time), rel=1e-3)


def test_a_disturbance_grows_only_near_the_edge_of_the_gap():
    """At the edge where the weight has little moment, by exp(sqrt(-wobble) t)."""
    edge = math.atan(0.5) - 1e-3
    slow = RollingCylinder(radius=0.5, height=2.0, tilt=edge)
    assert slow.wobble < 0.0
    pace, time = math.sqrt(-slow.wobble), 10.0 / math.sqrt(-slow.wobble)
    first, later = slow.growth(time)[0], slow.growth(time + 1.0 / pace)[0]
    assert later / first == pytest.approx(math.e, rel=1e-3)
    assert FAT.growth(0.0) == (1.0, 0.0)
    assert max(FAT.growth(turns * FAT.turn)[0] for turns in (5, 50, 500)) < 3.0


def test_p_is_that_of_a_block_on_its_rim():
    """Square of m g R over the moment about a tangent: 9.81 * 0.5590 / 0.3958 = 13.854."""
    assert FAT.p**2 == pytest.approx(9.81 * math.hypot(0.5, 0.25) / (0.0625 + 0.0625 / 3 + 0.3125))
