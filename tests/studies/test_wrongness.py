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
    in_kinds,
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


def test_kinds_are_counted_and_said():
    rows = pd.DataFrame(
        {"outcome": [OVER, REST_WORD, FAILED, ROCKED, ROCKED], "exact_outcome": [ROCKED] * 5}
    )
    counts = counted(wrong_in(rows))
    assert counts == dict.fromkeys(KINDS, 1) and set(MEANINGS) == set(KINDS)
    words = "wrong overturning in 1, missed rocking in 1, no result in 1"
    assert in_kinds(counts) == words
    assert in_kinds(dict.fromkeys(KINDS, 0)) == "none wrong"


def case(source, outcome, peak, **changes):
    labels = {"figure": 6, "pulse": "half-sine", "excess_g": 0.05, "aspect": 2.0, "width_m": 0.5}
    answer = {"source": source, "outcome": outcome, "peak_ratio": peak, "wall_s": 1e-3}
    return {**labels, "omega_over_p": 4.0, **answer, **changes}


def drake_like():
    """Return rows of an engine that is right once, and wrong in each kind; the last must fall."""
    return pd.DataFrame(
        [
            case("drake:naive", ROCKED, 0.011),
            case("drake:naive", REST_WORD, 0.0, width_m=1.0),
            case("drake:naive", REST_WORD, 0.0, omega_over_p=3.9),
            case("drake:naive", FAILED, math.nan, omega_over_p=3.9, width_m=1.0),
            case("drake:naive", OVER, math.inf, omega_over_p=3.8),
            case("drake:naive", ROCKED, 0.5, omega_over_p=0.1),
        ]
    )


def test_a_summary_has_a_column_for_each_kind():
    compared = with_reference(drake_like())
    assert list(compared["agrees"]) == [True, False, False, False, False, False]
    line = summarize(compared).iloc[0]
    assert {kind: line[kind] for kind in KINDS} == {FALL: 2, REST: 2, NO_ANSWER: 1}
    assert line["agree"] + sum(line[kind] for kind in KINDS) == line["cases"]
    assert line["false_overturnings"] + line["missed_overturnings"] == line[FALL]
