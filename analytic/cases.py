"""Many responses to pulses at once: broadcast, checked, and solved part by part on all cores."""

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.checks import MOST_HALF_CYCLES, whole
from analytic.kernels.excursions import BROKEN, OVERTURNED, TOO_LONG, march, workspace
from analytic.kernels.forms import Kernel
from analytic.kernels.law import UPRIGHT, FloatArray, Law, Notes
from analytic.kernels.taylor import TOLERANCE, Accuracy, accuracy
from analytic.models import Model, find_model
from analytic.simulate import OUTCOMES

PART = 4096
"""Cases that a core takes at a time: handing them over costs nothing, and all end together."""
MOST_THREADS = 1024


def solve_cases(
    given: tuple[ArrayLike, ArrayLike, ArrayLike, ArrayLike],
    model: str | Model,
    restitution: ArrayLike | None,
    threads: int | None,
    outputs: tuple[Any, ...],
    take: Callable[..., None],
    above: float = 0.0,
) -> list[NDArray[Any]]:
    """Solve the cases of `peak_ratios` part by part; return arrays of the types in `outputs`.

    `take` writes them, given cases (5, n): alpha, amplitude, omega/p, half cycles, eta; constants
    (5, n) of `Model.constants`; ends (8, n), as in `End`, but for the peak of both sides, which is
    sought `above` a rotation [rad].
    """
    declared, eta = find_model(model), 0.0 if restitution is None else restitution
    columns = np.broadcast_arrays(*given, eta)
    size, shape = columns[0].size, columns[0].shape
    count = os.cpu_count() if threads is None else whole("threads", threads, MOST_THREADS)
    written = [np.empty(size, kind) for kind in outputs]

    def one(start: int) -> None:
        where = slice(start, min(start + PART, size))
        cases = np.array([column.flat[where] for column in columns], dtype=np.float64)
        if restitution is None:
            # where all are of one slenderness, of one block
            first = cases[0, :1]
            cases[4] = housner_restitutions(cases[0] if np.any(cases[0] != first) else first)
        check_cases(cases)
        constants = np.stack(declared.constants(cases[0]))
        omega, half_cycles = cases[2], cases[3]
        steps = np.max(half_cycles * (1.0 + math.pi / omega), initial=0.0)
        solve = PULSES.few(size, steps)
        known = declared.linear and above > 0.0
        exactly = Accuracy(0, TOLERANCE) if known else accuracy(TOLERANCE)
        pulse = np.zeros((2, 7))
        ends = solve(declared.linear, exactly, constants, cases, above, pulse, workspace())
        take(cases, constants, ends, *(array[where] for array in written))

    if size <= PART:
        one(0)
    else:
        with ThreadPoolExecutor(count) as pool:
            list(pool.map(one, range(0, size, PART)))
    return [array.reshape(shape) for array in written]


def housner_restitutions(alpha: ArrayLike) -> FloatArray:
    """Return `block.housner_restitution`, or 0 where it is negative, for each slenderness."""
    slender = np.asarray(alpha, dtype=np.float64)
    sines = map(math.sin, slender.ravel().tolist())
    found = np.array([max(1.0 - 1.5 * (sine * sine), 0.0) for sine in sines])
    return found.reshape(slender.shape)


def check_cases(cases: FloatArray) -> None:
    """Raise ValueError unless every column of (alpha, amplitude, omega, n, eta) is in range."""
    alpha, amplitude, omega, half_cycles, eta = cases
    whole = (half_cycles >= 1.0) & (half_cycles == np.floor(half_cycles))
    whole &= half_cycles <= MOST_HALF_CYCLES
    rules = {
        "alpha": (alpha, (alpha > 0.0) & (alpha < 0.5 * math.pi), "in (0, pi/2)"),
        "amplitude_g": (amplitude, np.isfinite(amplitude), "finite"),
        "omega_over_p": (omega, (omega > 0.0) & np.isfinite(omega), "positive and finite"),
        "half_cycles": (half_cycles, whole, f"a whole number from 1 to {MOST_HALF_CYCLES:g}"),
        "restitution": (eta, (eta >= 0.0) & (eta <= 1.0), "between 0 and 1"),
    }
    for name, (column, allowed, words) in rules.items():
        if not np.all(allowed):
            raise ValueError(f"{name} is {column[~allowed][0]}; it must be {words}")


def solve_pulses(
    linear: bool,
    exactly: Accuracy,
    constants: FloatArray,
    cases: FloatArray,
    above: float,
    pulse: FloatArray,
    work: FloatArray,
) -> FloatArray:
    """Return the ends of cases; all is as in `solve_cases` or `march`, pulse (2, 7) is zero."""
    count = len(cases[0])
    ends = np.zeros((8, count))
    ends[0, :] = BROKEN
    notes = Notes(np.empty(0), np.empty((2, 0)), np.empty((0, 4)), np.empty(0))
    for i in range(count):
        k, saddle, factor = constants[0][i], constants[1][i], constants[2][i]
        law = Law(linear, k, saddle, factor, constants[3][i], constants[4][i], cases[4][i])
        amplitude, omega = cases[1][i], cases[2][i]
        over = cases[3][i] * math.pi / omega
        pulse[0][1], pulse[0][2], pulse[0][3] = over, amplitude, omega
        pulse[1][0] = pulse[1][1] = over
        if abs(over) < math.inf:
            outcome, right, left, steps, impacts, events, tau, y, v = march(
                (law, law), exactly, pulse, UPRIGHT, above, notes, work
            )
            ends[0, i], ends[1, i], ends[2, i] = outcome, max(right, left), steps
            ends[3, i], ends[4, i], ends[5, i], ends[6, i], ends[7, i] = impacts, events, tau, y, v
    return ends


PULSES = Kernel(solve_pulses)


def peak_ratios(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str | Model = "exact",
    restitution: ArrayLike | None = None,
    threads: int | None = None,
) -> tuple[FloatArray, NDArray[np.object_]]:
    """Solve many responses to sine pulses, on all cores.

    By similarity a case has no more parameters than these, which are broadcast.

    Parameters
    ----------
    alpha : array_like
        Slenderness [rad], in (0, pi/2).
    amplitude_g, omega_over_p, half_cycles : array_like
        Amplitude of the pulse [g], its circular frequency over the frequency parameter of the
        block, and its length.
    model : {"exact", "housner", "modified", "onset-matched"}
    restitution : array_like, optional
        Velocity ratio at impacts, in [0, 1]; Housner's value by default.
    threads : int, optional
        At most 1024; by default the number of cores.

    Returns
    -------
    peak_ratio : ndarray
        Largest abs(theta)/alpha; inf when overturned, 0 at rest.
    outcome : ndarray of Outcome

    Examples
    --------
    >>> peak, outcome = peak_ratios(0.32, [0.3, 0.4, 0.9], 2.0, 1)
    >>> peak.round(4), [one.value for one in outcome]
    (array([0.    , 0.0446,    inf]), ['at rest', 'rocked', 'overturned'])
    """

    def take(
        cases: FloatArray, _: FloatArray, ends: FloatArray, peaks: FloatArray, codes: Any
    ) -> None:
        codes[:], peaks[:] = ends[0], ends[1] / cases[0]
        peaks[codes == OVERTURNED] = math.inf
        peaks[(codes == TOO_LONG) | (codes == BROKEN)] = math.nan

    given = (alpha, amplitude_g, omega_over_p, half_cycles)
    peaks, codes = solve_cases(given, model, restitution, threads, (np.float64, np.int8), take)
    return peaks, np.array(OUTCOMES, dtype=object)[codes]
