"""Cases chosen from the sweep for studies that cannot afford all of it."""

import numpy as np

from analytic import peak_ratios
from studies.cases.paper import Case, sweep_cases

COMPARED_IMPACTS = 3
"""Impacts of each that are compared."""


def chosen_cases(quick: bool) -> dict[str, list[Case]]:
    """Return the cases of each set: "typical", with peaks near 0.3, and "near overturning".

    Of each of the paper's figures and aspect ratios one case each; quick takes two figures.
    """
    chosen: dict[str, list[Case]] = {"typical": [], "near overturning": []}
    for figure in (6, 8) if quick else (6, 7, 8, 9):
        for aspect in (2, 3, 4):
            cases = [
                case
                for case in sweep_cases([figure])
                if case.aspect == aspect and case.width_m == 0.5
            ]
            peaks = np.array([_exact_peak(case) for case in cases])
            survivors = np.where(np.isfinite(peaks), peaks, -1.0)
            chosen["typical"].append(cases[int(np.argmin(np.abs(survivors - 0.3)))])
            chosen["near overturning"].append(cases[int(np.argmax(survivors))])
    return chosen


def _exact_peak(case: Case) -> float:
    block = case.block
    half_cycles = case.motion.half_cycles
    peak, _ = peak_ratios(block.alpha, case.amplitude_g, case.omega_over_p, half_cycles)
    return float(peak)
