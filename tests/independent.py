"""A second, slow route to every response: SciPy's DOP853 with its own event location.

A block's is from the equations as the paper prints them (corrected), the free rocking integrated,
not decided by energy; that of several bodies is by Newton and Euler, contacts being constraints.
"""

import itertools
import math
from typing import NamedTuple

import numpy as np
from scipy.integrate import solve_ivp


def angular_acceleration(model, block, s, theta, a_g):
    alpha, p, u = block.alpha, block.p, a_g / block.gravity
    if model == "exact":
        return -(p**2) * (math.sin(alpha * s - theta) + u * math.cos(alpha * s - theta))
    if model == "modified":
        return -(p**2) * math.cos(alpha) * (s * math.tan(alpha) - theta + u)
    if model == "onset-matched":
        u *= alpha / math.tan(alpha)
    return -(p**2) * (alpha * s - theta + u)


MOST_IMPACTS = 12


def swing(model, block, ground, side, span, state, **options):
    """Return SciPy's path of a swing; its events are the impact, turning points and lying down."""

    def equation(time, x):
        return [x[1], angular_acceleration(model, block, side, x[0], ground(time))]

    def contact(time, x):
        return side * x[0]

    def turning(time, x):
        return side * x[1]

    def lying(time, x):
        return side * x[0] - 0.5 * math.pi

    contact.terminal, contact.direction = True, -1
    lying.terminal, turning.direction = True, -1
    events = (contact, turning, lying)
    return solve_ivp(
        equation, span, state, "DOP853", rtol=1e-12, atol=1e-16, events=events, **options
    )


def first_uplift(block, pulse, onset):
    """Return when the pulse first exceeds the onset, and the side it lifts to; or (inf, 0)."""
    if abs(pulse.amplitude) <= onset * block.gravity:
        return math.inf, 0
    level = math.asin(onset * block.gravity / abs(pulse.amplitude))
    within = pulse.phase % math.pi
    t = 0.0
    if not level < within < math.pi - level:
        t = ((level - within) % math.pi) / pulse.omega
    ahead = math.sin(pulse.omega * t + pulse.phase + 1e-9)
    return (t if t < pulse.duration else math.inf), -int(math.copysign(1, pulse.amplitude * ahead))


def peak_and_impacts(model, block, pulse, start=(0.0, 0.0), most=MOST_IMPACTS):
    """Return (peak/alpha or inf, impact times) up to 15/p past the pulse, or after `most` impacts.

    The peak is None if the pulse is not over by then.
    """
    saddle = math.tan(block.alpha) if model == "modified" else block.alpha
    onset = math.tan(block.alpha) if model != "housner" else block.alpha
    t, s = first_uplift(block, pulse, onset)
    if any(start):
        t, s = 0.0, int(math.copysign(1, start[0] or start[1]))
    if t == math.inf:
        return 0.0, []

    def shaken(time):
        return pulse.amplitude * math.sin(pulse.omega * time + pulse.phase)

    state, peak, impacts = list(start), abs(start[0]), []
    ends = {pulse.duration: shaken, pulse.duration + 15.0 / block.p: lambda _: 0.0}
    for stop, ground in ends.items():
        while t < stop:
            path = swing(model, block, ground, s, (t, stop), state, max_step=0.05 / block.p)
            peak = max([peak, abs(path.y[0, -1]), *(abs(x[0]) for x in path.y_events[1])])
            if path.t_events[2].size:
                return math.inf, impacts
            t, state = path.t[-1], path.y[:, -1]
            if path.t_events[0].size:
                impacts.append(t)
                s, state = -s, [0.0, block.restitution * state[1]]
                if len(impacts) == most:
                    return (peak / block.alpha if t > pulse.duration else None), impacts
    return (math.inf if abs(state[0]) > saddle else peak / block.alpha), impacts


AT_REST = 1e-7
"""Angular velocity [rad/s] below which a block pressed down after an impact counts as at rest."""


def history_under_samples(model, block, dt, samples, times):
    """Return rotations at `times` and the first impact times under a sampled acceleration."""
    onset = block.gravity * (math.tan(block.alpha) if model != "housner" else block.alpha)
    instants = np.arange(len(samples)) * dt

    def ground(time):
        return float(np.interp(time, instants, samples))

    rotations, impacts, s, state = np.zeros(len(times)), [], 0, [0.0, 0.0]
    for t, stop in itertools.pairwise(instants):
        longest = 0.25 * (stop - t)
        while t < stop * (1 - 1e-14):
            if s == 0:
                a, b = ground(t), ground(stop)
                if abs(a) <= onset:
                    if abs(b) <= onset:
                        break
                    # the straight line reaches the onset of its end's sign
                    t += (stop - t) * (math.copysign(onset, b) - a) / (b - a)
                s = -int(math.copysign(1, b if abs(a) <= onset else a))
            options = {"max_step": longest, "dense_output": True}
            path = swing(model, block, ground, s, (t, stop), state, **options)
            inside = (times > t) & (times <= path.t[-1])
            if inside.any():
                rotations[inside] = path.sol(times[inside])[0]
            t, state = float(path.t[-1]), path.y[:, -1]
            if path.t_events[0].size:
                impacts.append(t)
                s, state = -s, [0.0, block.restitution * state[1]]
                if abs(state[1]) < AT_REST and abs(ground(t)) < onset:
                    s, state = 0, [0.0, 0.0]
            elif path.t_events[2].size:
                break
    return rotations, impacts[:MOST_IMPACTS]


class Struck(NamedTuple):
    """An impact of bodies: its time, their velocities, and impulses (x, z) by contact."""

    time: float
    before: np.ndarray
    after: np.ndarray
    impulses: np.ndarray


class Bodies:
    """Planar bodies with coordinates q (x, z, angle clockwise each) and velocities v.

    A scene has `masses`, `loads` by q and time, and by q and a side `contacts`: their Jacobian, two
    rows each, and what is left of an acceleration times v**2. The first body's angle says the side.
    """

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

    def accelerations(self, q, v, side, time):
        """Return the accelerations, and the forces (x, z) by contact."""
        (jacobian, bent), mass = self.contacts(q, side), self.masses
        whole = np.block([[np.diag(mass), -jacobian.T], [jacobian, np.zeros((len(bent),) * 2)]])
        known = np.concatenate((self.loads(q, time), -bent @ v**2))
        found = np.linalg.lstsq(whole, known, rcond=1e-12)[0]
        return found[: mass.size], found[mass.size :].reshape(-1, 2)

    def struck(self, q, v, side):
        """Return the velocities and impulses of an ideally inelastic impact of a side."""
        jacobian, _ = self.contacts(q, side)
        by_mass = jacobian / self.masses
        impulse = np.linalg.lstsq(by_mass @ jacobian.T, -jacobian @ v, rcond=1e-12)[0]
        return v + by_mass.T @ impulse, impulse.reshape(-1, 2)

    def follow(self, q, v, side, t, ends, **options):
        """Yield SciPy's path of each swing, its side, and its impact, None at one of `ends`."""
        size = len(q)

        def flow(t, state, side):
            q, v = state[:size], state[size:]
            return np.concatenate((v, self.accelerations(q, v, side, t)[0]))

        def lands(t, state, side):
            return side * state[2]

        def turns(t, state, side):
            return side * state[size + 2]

        lands.terminal, lands.direction, turns.direction = True, -1, -1
        while t < ends[-1]:
            until = min(end for end in ends if end > t * (1.0 + 1e-14))
            path = solve_ivp(
                flow, (t, until), np.concatenate((q, v)), "DOP853",
                events=(lands, turns), args=(side,), **options,
            )  # fmt: skip
            t, q, v, swings, impact = path.t[-1], *np.split(path.y[:, -1], 2), side, None
            if path.status == 1:
                impact = Struck(t, v, *self.struck(q, v, -side))
                side, v = -side, impact.after
            yield path, swings, impact
