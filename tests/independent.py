"""A second, slow route to a block's response: SciPy's DOP853 with its own event location.

It is from the equations as the paper prints them (corrected), the free rocking integrated, not
decided by energy.
"""

import itertools
import math

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
