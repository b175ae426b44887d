"""Error against run time in sentences, each made from the lines of work-precision.csv."""

import pandas as pd

from studies.measures.costs import LOOPS
from studies.measures.words import duration, listed, times
from studies.precision.choices import (
    TYPICAL,
    cheapest_below,
    choices,
    exact_cost,
)

PAPERS, STRICT = "RK4, contact to 1e-6", "RK4"
"""The paper's solver, with its criterion for contact and with a strict one."""


def first_claim(table: pd.DataFrame) -> str:
    """Say what the smallest of the targets costs with an engine, and with the paper's solver."""
    reached = [chosen for chosen in choices(table) if chosen.typical is not None]
    if not reached:
        return "No engine setting reaches any of the errors asked for on every typical case."
    last = reached[-1]
    engines = [
        f"{times(chosen.over_exact)} that {words}, {LOOPS[chosen.loop]}"
        for chosen, words in (
            (last.typical, "on typical cases"),
            (last.everywhere, "with those near overturning"),
        )
        if chosen is not None
    ]
    typical = table[table["set"] == TYPICAL]
    own = exact_cost(typical)
    best = cheapest_below(typical[typical["method"] == STRICT], last.target)
    rival = "" if best is None else f", and RK4 {times(best['wall_s'] / own)} it"
    return (
        f"The exact solution takes {duration(own)} a case; an error below {last.target:g} costs "
        f"an engine {listed(engines)}{rival}."
    )
