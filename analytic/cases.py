"""Many cases of pulses at once: broadcast, checked, and solved part by part on all cores."""

import math
import os
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.checks import MOST_HALF_CYCLES, whole
from analytic.kernels.compiled import form_for, inner, kernel
from analytic.kernels.law import FloatArray, Law
from analytic.models import Model, find_model

PART = 4096
"""Cases that a core takes at a time: enough that handing them over costs nothing, and few enough
that no core is left with much to do when the others are done."""

MOST_THREADS = 1024

SolvePart = Callable[[slice, bool, FloatArray, FloatArray], None]
"""Solves a part of the cases, a slice of all: given whether the model is linear, its constants
(shape (5, n), `Model.constants`) and the cases (shape (5, n)): alpha, amplitude, omega/p, half
cycles, restitution."""


@dataclass(frozen=True, slots=True)
class Cases:
    """Cases of a model, each parameter in the broadcast shape; without a restitution Housner's."""

    model: Model
    columns: tuple[NDArray[Any], ...]
    restitution: bool

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the cases."""
        return self.columns[0].shape

    @property
    def size(self) -> int:
        """Number of cases."""
        return self.columns[0].size

    def solve(self, solve: SolvePart, threads: int | None = None) -> None:
        """Hand all cases to a compiled solver in parts, which needs no more memory than they do.

        Raises
        ------
        ValueError
            If a parameter is outside its range.
        """
        count = os.cpu_count() if threads is None else whole("threads", threads, MOST_THREADS)

        def one(start: int) -> None:
            part = slice(start, min(start + PART, self.size))
            cases = np.array([column.flat[part] for column in self.columns], dtype=np.float64)
            if not self.restitution:
                form_for(self.size, fill_restitution)(cases[0], cases[4])
            check_cases(cases)
            solve(part, self.model.linear, np.stack(self.model.constants(cases[0])), cases)

        starts = range(0, self.size, PART)
        if len(starts) <= 1:
            for start in starts:
                one(start)
            return
        with ThreadPoolExecutor(count) as pool:
            for _ in pool.map(one, starts):
                pass


def pose(
    alpha: ArrayLike,
    amplitude_g: ArrayLike,
    omega_over_p: ArrayLike,
    half_cycles: ArrayLike,
    model: str | Model,
    restitution: ArrayLike | None,
) -> Cases:
    """Return the cases that the arguments of `peak_ratios` name.

    Parameters
    ----------
    alpha, amplitude_g, omega_over_p, half_cycles, model, restitution
        As for `analytic.simulate.peak_ratios`.

    Raises
    ------
    ValueError
        If there is no such model, or the shapes do not broadcast.
    """
    declared, eta = find_model(model), 0.0 if restitution is None else restitution
    columns = np.broadcast_arrays(alpha, amplitude_g, omega_over_p, half_cycles, eta)
    return Cases(declared, tuple(columns), restitution is not None)


@kernel
def fill_restitution(alpha: FloatArray, eta: FloatArray) -> None:
    """Write Housner's velocity ratio, or 0 where it is negative, for each slenderness.

    See `analytic.block.housner_restitution`.
    """
    for i in range(len(alpha)):
        sine = math.sin(alpha[i])
        eta[i] = max(1.0 - 1.5 * (sine * sine), 0.0)


def housner_restitutions(alpha: ArrayLike) -> FloatArray:
    """Return what a case has without a restitution of its own, in the shape of the slenderness."""
    slender = np.array(alpha, dtype=np.float64)
    found = np.empty(slender.size)
    form_for(found.size, fill_restitution)(slender.ravel(), found)
    return found.reshape(slender.shape)


@inner
def law_of(linear: bool, constants: FloatArray, cases: FloatArray, i: int) -> Law:
    """Return the law of a case.

    Parameters
    ----------
    linear : bool, whether the model is
    constants : ndarray (5, n), of `Model.constants`
    cases : ndarray (5, n), alpha [rad], amplitude [g], omega/p, half cycles, restitution
    i : int, column of the case
    """
    k, saddle, factor = constants[0][i], constants[1][i], constants[2][i]
    return Law(linear, k, saddle, factor, constants[3][i], constants[4][i], cases[4][i])


@inner
def write_pulse(cases: FloatArray, i: int, segment: FloatArray) -> None:
    """Write the pulse of a case into a segment, in units of 1/p and g.

    Parameters
    ----------
    cases : ndarray (5, n), as for `law_of`
    i : int, column of the case
    segment : ndarray (7,), a row of `motion.SEGMENT_COLUMNS`; zero but for what is written
    """
    omega = cases[2][i]
    segment[1] = cases[3][i] * math.pi / omega
    segment[2] = cases[1][i]
    segment[3] = omega


def check_cases(cases: FloatArray) -> None:
    """Raise ValueError unless every column of (alpha, amplitude, omega, n, eta) is in range."""
    alpha, _, omega, half_cycles, eta = cases
    whole = (half_cycles >= 1.0) & (half_cycles == np.floor(half_cycles))
    whole &= half_cycles <= MOST_HALF_CYCLES
    rules = {
        "alpha": (alpha, (alpha > 0.0) & (alpha < 0.5 * math.pi), "in (0, pi/2)"),
        "amplitude_g": (cases[1], np.isfinite(cases[1]), "finite"),
        "omega_over_p": (omega, (omega > 0.0) & np.isfinite(omega), "positive and finite"),
        "half_cycles": (half_cycles, whole, f"a whole number from 1 to {MOST_HALF_CYCLES:g}"),
        "restitution": (eta, (eta >= 0.0) & (eta <= 1.0), "between 0 and 1"),
    }
    for name, (column, allowed, words) in rules.items():
        if not np.all(allowed):
            raise ValueError(f"{name} is {column[~allowed][0]}; it must be {words}")
