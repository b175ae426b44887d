"""Solve the extreme cases of `rocking stability` with 30 digits and write extreme.csv beside this.

The numbers of the cases are the package's, the solution is that of make_exact_table.py, which knows
nothing of the package. A case that its scan cannot follow (an excursion shorter than the scan, a
rest between impacts) is left out, and named on the way, and so are pulses of hundreds of 1/p.

Run: python tests/analytic/reference/make_extreme_table.py
"""

import csv
import math
import sys
from pathlib import Path

import make_exact_table as exact
import mpmath as mp

from studies.cases.extreme import extremes

COLUMNS = [
    *("case", "width", "height", "amplitude", "omega", "half_cycles", "restitution"),
    "peak_ratio",
]


SLOWEST = 0.1
"""Pulses of a lower ω/p take hours at 30 digits."""


def posed(case):
    """Return the arguments of `solve` for an extreme case."""
    block, motion = case.block, case.motion
    return (
        *(block.width, block.height, motion.amplitude, motion.omega, motion.half_cycles),
        None if math.isnan(case.restitution) else case.restitution,
    )


def main():
    with (Path(__file__).parent / "extreme.csv").open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(COLUMNS)
        for case in extremes(False):
            if not case.applies("exact"):
                continue
            if case.omega_over_p < SLOWEST:
                print(f"{case.name}: left out, too long a pulse", file=sys.stderr, flush=True)
                continue
            try:
                peak, impacts = exact.solve(*posed(case))
            except ValueError as error:
                print(f"{case.name}: left out, {error}", file=sys.stderr, flush=True)
                continue
            rows.writerow([case.name, *posed(case), mp.nstr(peak, 25)])
            file.flush()
            print(case.name, mp.nstr(peak, 25), len(impacts), flush=True)


if __name__ == "__main__":
    main()
