"""Outcomes and modes of many responses to pulses: what an overturning map is made of."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.cases import law_of, pose
from analytic.kernels.closed_form import work_to
from analytic.kernels.compiled import form_for, inner, kernel, listed
from analytic.kernels.excursions import MAX_STEPS
from analytic.kernels.law import Law
from analytic.kernels.rest import ANGLE_TOLERANCE, side_after, time_to_rest
from analytic.kernels.swings import (
    LANDED,
    LEFT_OVER,
    MAP_ORDER,
    TOPPLED,
    Pulse,
    parity,
    swing_exact,
    swing_linear,
    whole_half_cycles,
)
from analytic.motion import FloatArray

NOT_LIFTED, SURVIVES, FAILED = -2, -1, -3
"""Modes that are no number of impacts."""

QUIET = 5e-4
"""Velocity, over the one that just overturns a block from its base, that a map takes for rest
after the last uplift; the margin is then -1 to within twice as much."""


class Modes(NamedTuple):
    """What happens to each case of a map, in the broadcast shape.

    Attributes
    ----------
    mode : ndarray of int32
        The number of impacts before the block overturns, or SURVIVES, NOT_LIFTED, FAILED.
    margin : ndarray
        The distance from overturning, positive when overturned; -1 at rest. When the pulse ends
        the larger of two velocities, over that which just overturns a block from its base: the
        excess over the separatrix here, and after the next impact. It changes continuously with
        the amplitude, whatever the number of impacts, but where the side of a block touches the
        ground; inf when a block overturns before the pulse ends.
    steps : ndarray of int32
        Taylor steps of the exact model, evaluations of the closed form of a linear one.
    """

    mode: NDArray[np.int32]
    margin: FloatArray
    steps: NDArray[np.int32]


@inner
def next_lift(angle: float, level: float) -> tuple[int, float]:
    """Return how many half cycles on, and at which angle, the ground lifts a block at rest.

    Parameters
    ----------
    angle : float, place in the present half cycle [rad], in [0, pi]
    level : float, angle at which a half cycle reaches the onset [rad]
    """
    if angle > math.pi - level - ANGLE_TOLERANCE:
        return 1, level
    return 0, max(angle, level)


@inner
def is_quiet(law: Law, v: float, left: float) -> bool:
    """Tell whether a block that the ground lifts no more, on its base at v, is sure to survive.

    Below the onset y'' <= k^2 y, k^2 = 1/cos(alpha) for the exact model; so no velocity, of this
    swing or a later one, is above v e^(k t).
    """
    k = law.k if law.linear else 1.0 / math.sqrt(math.cos(law.alpha))
    return v * math.exp(k * left) <= QUIET * math.sqrt(2.0 * work_to(law, law.saddle))


@inner
def decide(law: Law, y: float, v: float, impacts: int) -> tuple[int, float]:
    """Return mode and margin, as in `Modes`, of a block when the pulse ends.

    The separatrix is v = k (c - y) of a linear model, v = 2 sin((alpha - y)/2) of the exact one.

    Parameters
    ----------
    law : Law
    y, v : float, its state [rad, rad p]
    impacts : int, how many there were
    """
    barrier = math.sqrt(2.0 * work_to(law, law.saddle))
    excess = y - law.saddle
    here = v + (law.k * excess if law.linear else 2.0 * math.sin(0.5 * excess))
    work = 0.5 * v * v + work_to(law, y)
    after = law.eta * math.sqrt(2.0 * max(work, 0.0)) - barrier
    if here > 0.0:
        return impacts, here / barrier
    if v < 0.0 and after > 0.0:
        return impacts + 1, after / barrier
    return SURVIVES, max(here, min(after, 0.0)) / barrier


@inner
def later(pulse: Pulse, half_cycles: int) -> Pulse:
    """Return what is left of a pulse some half cycles later.

    Parameters
    ----------
    pulse : Pulse
    half_cycles : int
    """
    return Pulse(pulse.amplitude, pulse.omega, pulse.half_cycles - half_cycles)


@inner
def ground_after(pulse: Pulse, angle: float, wait: float) -> float:
    """Return the ground acceleration [g] a time after an angle; zero after the pulse.

    Parameters
    ----------
    pulse : Pulse, of which the present half cycle counts as positive
    angle : float, place in it [rad]
    wait : float, [1/p]
    """
    phase = angle + pulse.omega * wait
    if not phase < pulse.half_cycles * math.pi:
        return 0.0
    turned, rest = whole_half_cycles(phase)
    return parity(turned) * pulse.amplitude * math.sin(rest)


@inner
def pulse_mode(
    law: Law, pulse: Pulse, work: FloatArray, segment: FloatArray
) -> tuple[int, float, int]:
    """Return mode, margin and steps of one case."""
    if pulse.amplitude <= law.onset:
        return NOT_LIFTED, -1.0, 0
    level = math.asin(law.onset / pulse.amplitude)
    angle = v = side = lifted = 0.0
    impacts = steps = 0
    while True:
        if side == 0.0:
            turned, angle = next_lift(angle, level)
            pulse = later(pulse, turned)
            if pulse.half_cycles <= 0:
                return SURVIVES, -1.0, steps
            side, lifted = -1.0, (math.pi - level - angle) / pulse.omega
        if law.linear:
            swing = swing_linear(law, pulse, angle, v, side, level, segment)
        else:
            swing = swing_exact(law, pulse, angle, v, side, lifted, work)
        steps += swing.steps
        if swing.end == TOPPLED:
            return impacts, math.inf, steps
        if swing.end == LEFT_OVER:
            mode, margin = decide(law, swing.y, swing.v, impacts)
            return mode, margin, steps
        if swing.end != LANDED or impacts == MAX_STEPS:
            return FAILED, math.nan, steps
        impacts += 1
        pulse, angle = later(pulse, swing.half_cycles), swing.angle
        side, v, lifted = -side * parity(swing.half_cycles), -law.eta * swing.v, 0.0
        left = (pulse.half_cycles * math.pi - angle) / pulse.omega
        if left * pulse.omega <= level and is_quiet(law, v, left):
            return SURVIVES, -1.0, steps
        if pulse.half_cycles <= 0:
            mode, margin = decide(law, 0.0, v, impacts)
            return mode, margin, steps
        a = pulse.amplitude * math.sin(angle)
        wait = time_to_rest(law, side, v, a)
        if side_after(law, side, v, a, ground_after(pulse, angle, wait), wait) == 0.0:
            turned, angle = whole_half_cycles(angle + pulse.omega * wait)
            pulse, side, v = later(pulse, turned), 0.0, 0.0
        elif v == 0.0:
            side = 0.0


@kernel
def solve_modes(
    linear: bool,
    constants: FloatArray,
    cases: FloatArray,
    modes: NDArray[np.int32],
    margins: FloatArray,
    steps: NDArray[np.int32],
) -> None:
    """Solve a part of `overturning_modes`, one case a column.

    linear, constants and cases are those of `analytic.cases.SolvePart`; the last arrays, (n,), are
    written.
    """
    given, held = listed(cases), listed(constants)
    work, segment = listed(np.empty((5, MAP_ORDER + 1))), listed(np.zeros(7))
    for i in range(len(given[0])):
        law = law_of(linear, held, given, i)
        omega = given[2][i]
        pulse = Pulse(abs(given[1][i]), omega, int(given[3][i]))
        segment[1], segment[2], segment[3] = math.pi / omega, pulse.amplitude, omega
        modes[i], margins[i], steps[i] = pulse_mode(law, pulse, work, segment)
        if math.isnan(margins[i]):
            modes[i] = FAILED


def overturning_modes(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str = "exact",
    restitution: ArrayLike | None = None,
    threads: int | None = None,
) -> Modes:
    """Find whether and how sine pulses overturn blocks, on all cores.

    Faster than `peak_ratios`, from other kernels: neither peaks nor what comes after the pulse are
    computed, and a step of the exact model is accurate to 1e-13. The inputs are broadcast a part
    at a time, so that beside them and the results no memory is needed.

    Parameters
    ----------
    alpha, amplitude_g, omega_over_p, half_cycles, model, restitution
        As in `peak_ratios`.
    threads : int, optional
        At most 1024; by default the number of cores.

    Returns
    -------
    Modes

    Raises
    ------
    ValueError
        If an argument is outside its range or the shapes do not broadcast.

    Examples
    --------
    >>> overturning_modes(0.32, [0.4, 0.9, 2.0], 2.0, 1).mode
    array([-1,  0,  0], dtype=int32)
    """
    cases = pose(alpha, amplitude_g, omega_over_p, half_cycles, model, restitution)
    size = cases.size
    mode, margin, steps = np.empty(size, np.int32), np.empty(size), np.empty(size, np.int32)
    solver = form_for(size, solve_modes)

    def solve(part: slice, linear: bool, constants: FloatArray, given: FloatArray) -> None:
        solver(linear, constants, given, mode[part], margin[part], steps[part])

    cases.solve(solve, threads)
    shape = cases.shape
    return Modes(mode.reshape(shape), margin.reshape(shape), steps.reshape(shape))
