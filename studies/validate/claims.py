"""What random cases say, and what was left out of them."""

from __future__ import annotations

import pandas as pd

from analytic.response import Outcome
from studies.cases.drawn import LEAST_NORMAL, everything
from studies.measures.differences import WELL_CONDITIONED, sensitivity_of
from studies.measures.words import NAMED, gathered, listed, part, right_of

LEFT_OUT = {
    "near": f"the normal force falls to {LEAST_NORMAL:g} of the weight or less",
    "lifted": "the normal force is lost: the pivot would have to be held down",
}
"""Cases that nobody was asked about -> why not."""


def census(seed: int, kept: int) -> pd.DataFrame:
    """Count what was drawn until `kept` cases had a least normal force above LEAST_NORMAL.

    Returns
    -------
    DataFrame
        Rows drawn, kept, near and lifted, the last two being those left out; the columns set,
        cases, overturned and share, both of the exact solution, and why.
    """
    counts = {name: [0, 0] for name in ("drawn", "kept", *LEFT_OUT)}
    for _, exact in everything(seed):
        if counts["kept"][0] == kept:
            break
        for name in ("drawn", _set_of(exact.min_normal)):
            counts[name][0] += 1
            counts[name][1] += exact.outcome is Outcome.OVERTURNED
    table = pd.DataFrame.from_dict(counts, orient="index", columns=["cases", "overturned"])
    table = table.assign(share=table["overturned"] / table["cases"])
    return table.rename_axis("set").reset_index().assign(why=[LEFT_OUT.get(n, "") for n in counts])


def _set_of(normal: float) -> str:
    if normal > LEAST_NORMAL:
        return "kept"
    return "near" if normal > 0.0 else "lifted"


def first_claim(compared: pd.DataFrame) -> str:
    """Say what each source gets right, and its largest error, everywhere and in calm cases."""
    right = [
        (str(source), right_of(rows)) for source, rows in compared.groupby("source", sort=False)
    ]
    calm = compared[sensitivity_of(compared) < WELL_CONDITIONED]
    return (
        f"Outcomes right on random cases that nothing was tuned on ({width(compared)}): "
        f"{gathered(right)}; largest errors of the peak {_sizes(compared)}, and {_sizes(calm)} "
        f"where neither κ nor the sensitivity reaches {WELL_CONDITIONED:g}."
    )


def width(compared: pd.DataFrame) -> str:
    """Say how wide random cases are: between which ends each of their numbers lies."""
    ends = {
        "H/B {}": compared["aspect"],
        "B {} m": compared["width_m"],
        "{} half cycles": compared["half_cycles"],
        "ω/p {}": compared["omega_over_p"],
        "{} onsets": compared["amplitude_g"] * compared["aspect"],
    }
    return ", ".join(
        words.format(f"{values.min():.3g} to {values.max():.3g}") for words, values in ends.items()
    )


def _sizes(compared: pd.DataFrame) -> str:
    """Return each source's largest error, or the least and the largest of many."""
    largest = compared["error"].abs().groupby(compared["source"], sort=False).max().dropna()
    if len(largest) > NAMED:
        named = [f"{part(size)} ({name})" for name, size in largest.sort_values().items()]
        return listed([named[0], named[-1]], "to")
    return listed([part(size) for size in largest])


def drawn_text(counted: pd.DataFrame) -> str:
    """Say how many cases were drawn and kept, which were not, and how many of each overturn.

    Parameters
    ----------
    counted : DataFrame
        From `census`.
    """
    drawn, kept, *others = (line for _, line in counted.iterrows())
    left = [
        f"in {line['cases']} ({line['overturned']} overturn) {line['why']}"
        for line in others
        if line["cases"]
    ]
    return (
        f"Of {drawn['cases']} drawn "
        f"{part(drawn['share'])} overturn, and {part(kept['share'])} of the {kept['cases']} kept: "
        f"those where the normal force stays above {LEAST_NORMAL:g} of the weight, of a block that "
        "overturns until it passes θcr for good. "
        f"Left out: {'; '.join(left) or 'none'}."
    )
