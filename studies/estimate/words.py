"""What estimates tell of the errors, in words and as a table."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import pandas as pd

from studies.measures.differences import scientific
from studies.measures.halving import BOUNDED, MOST_TRUSTED, NO_BOUND
from studies.measures.words import listed, out_of, part


def factors_text(table: pd.DataFrame) -> str:
    """Return factors as an aligned table."""
    shown = pd.DataFrame(
        {
            "source": table["source"],
            "survive": table["survivors"],
            "estimate": table["median_estimate"].map(scientific),
            "error": table["median_error"].map(scientific),
            "half": table["factor_50"].map("{:.3g}".format),
            "95 %": table["factor_95"].map("{:.3g}".format),
            "from": table["factor_95_low"].map("{:.3g}".format),
            "to": table["factor_95_high"].map("{:.3g}".format),
            "all": table["factor_all"].map("{:.3g}".format),
            "within 3": table["within_3"].map(part),
            "within 10": table["within_10"].map(part),
            "wrong outcomes told": table["told"].astype(str) + "/" + table["wrong"].astype(str),
            "others bounded": [_bounded(line) for line in table.to_dict("records")],
        }
    )
    return shown.to_string(index=False)


def _bounded(line: Mapping[Any, Any]) -> str:
    if line["factor_95_high"] > MOST_TRUSTED:
        return NO_BOUND
    return f"{line['bounded']}/{line['tested']}"


def first_claim(table: pd.DataFrame) -> str:
    """Say whose estimates bound the error, how many on other cases, and whose give no bound."""
    bound = table["factor_95_high"] <= MOST_TRUSTED
    good, blind = table[bound], table[~bound]
    claim, said = "The difference from half the step", []
    if not good.empty:
        words = [f"{line['source']} ({line['factor_95_high']:.2g})" for _, line in good.iterrows()]
        tried = out_of(int(good["bounded"].sum()), int(good["tested"].sum()))
        said += [
            f", times the number in brackets, bounds {part(BOUNDED)} of the errors of "
            f"{listed(words)} (of other cases than gave the numbers {tried})"
        ]
    if not blind.empty:
        words = [f"{line['source']} ({_ends(line)})" for line in blind.to_dict("records")]
        said += [f"{' it' if said else ''} gives {NO_BOUND} with {listed(words)}"]
    return f"{claim}{';'.join(said)}."


def _ends(line: Mapping[Any, Any]) -> str:
    """Return the interval of a factor that is no bound."""
    low, high = line["factor_95_low"], line["factor_95_high"]
    return f"{low:.2g} or more" if math.isinf(high) else f"{low:.2g} to {high:.3g}"
