"""One count of what is wrong, in three kinds, and every sentence that says it."""

import math

import pandas as pd
import pytest

from analytic.response import Outcome
from studies.measures.differences import summarize, with_reference
from studies.measures.wrongness import (
    FALL,
    KINDS,
    MEANINGS,
    NO_ANSWER,
    REST,
    counted,
    kinds_of,
    wrong_in,
)

REST_WORD, ROCKED, OVER, _, FAILED = (outcome.value for outcome in Outcome)


@pytest.mark.parametrize(
    ("found", "right", "kind"),
    [
        *((word, word, "") for word in (REST_WORD, ROCKED, OVER)),
        *((OVER, right, FALL) for right in (REST_WORD, ROCKED)),
        *((found, OVER, FALL) for found in (REST_WORD, ROCKED)),
        (REST_WORD, ROCKED, REST),
        (ROCKED, REST_WORD, REST),
        *((found, ROCKED, NO_ANSWER) for found in (FAILED, "slid", math.nan)),
        (FAILED, OVER, NO_ANSWER),
    ],
)
def test_each_pair_of_outcomes_is_right_or_of_one_kind(found, right, kind):
    assert list(kinds_of([found], [right])) == [kind]


def test_nothing_is_wrong_beside_no_reference():
    with pytest.raises(ValueError, match="an exact outcome is none of"):
        kinds_of([ROCKED], [FAILED])


def test_kinds_are_counted():
    rows = pd.DataFrame(
        {"outcome": [OVER, REST_WORD, FAILED, ROCKED, ROCKED], "exact_outcome": [ROCKED] * 5}
    )
    assert counted(wrong_in(rows)) == dict.fromkeys(KINDS, 1) and set(MEANINGS) == set(KINDS)


def test_a_summary_has_a_column_for_each_kind():
    """Of an engine that is right once, and wrong in each kind; the last block must fall."""
    columns = ["outcome", "peak_ratio", "width_m", "omega_over_p"]
    found = [(ROCKED, 0.011, 0.5, 4.0), (REST_WORD, 0.0, 1.0, 4.0), (REST_WORD, 0.0, 0.5, 3.9)]
    found += [(FAILED, math.nan, 1.0, 3.9), (OVER, math.inf, 0.5, 3.8), (ROCKED, 0.5, 0.5, 0.1)]
    labels = {"figure": 6, "pulse": "half-sine", "excess_g": 0.05, "aspect": 2.0, "wall_s": 1e-3}
    compared = with_reference(pd.DataFrame(found, columns=columns).assign(source="it", **labels))
    assert list(compared["agrees"]) == [True, False, False, False, False, False]
    line = summarize(compared).iloc[0]
    assert {kind: line[kind] for kind in KINDS} == {FALL: 2, REST: 2, NO_ANSWER: 1}
    assert line["agree"] + sum(line[kind] for kind in KINDS) == line["cases"]
    assert line["false_overturnings"] + line["missed_overturnings"] == line[FALL]
