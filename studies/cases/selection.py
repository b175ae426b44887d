"""Cases chosen from the sweep for studies that cannot afford all of it."""

from functools import cache

import numpy as np

from analytic import peak_ratios
from studies.cases.paper import ASPECTS, Case, sweep_cases

COMPARED_IMPACTS = 3
"""Impacts of each that are compared."""


@cache
def chosen_cases(quick: bool) -> dict[str, list[Case]]:
    """Return the cases of each set: "typical", with peaks near 0.3, and "near overturning".

    Of each of the paper's figures and aspect ratios one case each; quick takes two figures.
    """
    chosen: dict[str, list[Case]] = {"typical": [], "near overturning": []}
    for figure in (6, 8) if quick else (6, 7, 8, 9):
        known = [case for case in sweep_cases([figure]) if case.width_m == 0.5]
        posed = [
            (case.block.alpha, case.amplitude_g, case.omega_over_p, case.motion.half_cycles)
            for case in known
        ]
        peaks, _ = peak_ratios(*np.array(posed, np.float64).T)
        for aspect in ASPECTS:
            mine = np.isfinite(peaks) & np.array([case.aspect == aspect for case in known])
            survivors = np.where(mine, peaks, -np.inf)
            chosen["typical"].append(known[int(np.argmin(np.abs(survivors - 0.3)))])
            chosen["near overturning"].append(known[int(np.argmax(survivors))])
    return chosen
