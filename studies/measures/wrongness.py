"""What is wrong about an outcome: counted here alone, in three kinds, for every table and sentence.

Only two outcomes are compared, so that whoever reads a published table can count the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike, NDArray

from analytic.response import Outcome

FALL, REST, NO_ANSWER = "fall_wrong", "rest_wrong", "no_answer"
KINDS = (FALL, REST, NO_ANSWER)
"""Kinds of wrong outcomes, which are columns of tables, too."""

WORDS = {FALL: "wrong overturning", REST: "missed rocking", NO_ANSWER: "no result"}
"""Kind -> its name in a sentence."""

MEANINGS = {
    FALL: "one overturns, the other does not",
    REST: "at rest for rocking, or the reverse",
    NO_ANSWER: "the run failed, or the block slid away",
}
"""Kind -> what it counts of an outcome and the exact one."""

ANSWERS = tuple(outcome.value for outcome in (Outcome.AT_REST, Outcome.ROCKED, Outcome.OVERTURNED))
"""Outcomes that can be right."""


def kinds_of(found: ArrayLike, right: ArrayLike) -> NDArray[np.str_]:
    """Return for each outcome its kind of wrongness, empty where it is the exact one.

    It is a ValueError if the exact solution has no outcome.
    """
    mine, exact = np.broadcast_arrays(np.asarray(found, object), np.asarray(right, object))
    if not np.isin(exact, ANSWERS).all():
        raise ValueError(f"an exact outcome is none of {', '.join(ANSWERS)}")
    fallen = Outcome.OVERTURNED.value
    return np.select(
        [~np.isin(mine, ANSWERS), mine == exact, (mine == fallen) | (exact == fallen)],
        [NO_ANSWER, "", FALL],
        REST,
    )


def wrong_in(rows: pd.DataFrame) -> pd.Series[Any]:
    """Return the kind of each row that has an outcome and an exact_outcome."""
    return pd.Series(kinds_of(rows["outcome"], rows["exact_outcome"]), rows.index, object)


def counted(kinds: pd.Series[Any]) -> dict[str, int]:
    """Return how many there are of each kind."""
    return {kind: int((kinds == kind).sum()) for kind in KINDS}


def in_kinds(counts: Mapping[str, Any] | pd.Series[Any]) -> str:
    """Return how many outcomes are wrong, by kind: "wrong overturning in 3, no result in 2"."""
    words = [f"{name} in {counts[kind]:.0f}" for kind, name in WORDS.items() if counts[kind]]
    return ", ".join(words) or "none wrong"
