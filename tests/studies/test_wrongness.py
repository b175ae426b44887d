"""One count of what is wrong, in three kinds, and every sentence that says it."""

import math

import pandas as pd
import pytest

from analytic.response import Outcome
from studies.measures.differences import summarize, with_reference
from studies.measures.wrongness import FALL, KINDS, MEANINGS, NO_ANSWER, REST, kinds_of

REST_WORD, ROCKED, OVER, _, FAILED = (outcome.value for outcome in Outcome)


@pytest.mark.parametrize(
    ("found", "peak", "right", "exact_peak", "kind"),
    [
        (OVER, math.inf, OVER, math.inf, ""),
        *((OVER, math.inf, right, peak, FALL) for right, peak in ((REST_WORD, 0.0), (ROCKED, 0.2))),
        *((found, peak, OVER, math.inf, FALL) for found, peak in ((REST_WORD, 0.0), (ROCKED, 0.2))),
        # a tenth of the exact peak tells rest from rocking, whatever a contact's depth says
        *((word, 0.00249, ROCKED, 0.0025, "") for word in (REST_WORD, ROCKED)),
        *((word, 0.021, ROCKED, 0.2057, "") for word in (REST_WORD, ROCKED)),
        *((word, 0.020, ROCKED, 0.2057, REST) for word in (REST_WORD, ROCKED)),
        # and a hundredth of the critical rotation, where there is no exact peak
        *((word, 0.009, REST_WORD, 0.0, "") for word in (REST_WORD, ROCKED)),
        *((word, 0.011, REST_WORD, 0.0, REST) for word in (REST_WORD, ROCKED)),
        (ROCKED, 0.0, ROCKED, 0.0, ""),
        *((found, 0.2, ROCKED, 0.2, NO_ANSWER) for found in (FAILED, "slid", math.nan)),
        (FAILED, math.nan, OVER, math.inf, NO_ANSWER),
    ],
)
def test_each_answer_is_right_or_of_one_kind(found, peak, right, exact_peak, kind):
    assert list(kinds_of([found], [peak], [right], [exact_peak])) == [kind]


def test_nothing_is_wrong_beside_no_reference():
    with pytest.raises(ValueError, match="an exact outcome is none of"):
        kinds_of([ROCKED], [0.2], [FAILED], [math.nan])


def test_a_summary_has_a_column_for_each_kind():
    """Of an engine that is right once, and wrong in each kind; the last block must fall."""
    columns = ["outcome", "peak_ratio", "width_m", "omega_over_p"]
    found = [(ROCKED, 0.011, 0.5, 4.0), (REST_WORD, 0.0, 1.0, 4.0), (REST_WORD, 0.0, 0.5, 3.9)]
    found += [(FAILED, math.nan, 1.0, 3.9), (OVER, math.inf, 0.5, 3.8), (ROCKED, 0.5, 0.5, 0.1)]
    labels = {"figure": 6, "pulse": "half-sine", "excess_g": 0.05, "aspect": 2.0, "wall_s": 1e-3}
    compared = with_reference(pd.DataFrame(found, columns=columns).assign(source="it", **labels))
    assert list(compared["agrees"]) == [True, False, False, False, False, False]
    line = summarize(compared).iloc[0]
    assert {kind: line[kind] for kind in MEANINGS} == {FALL: 2, REST: 2, NO_ANSWER: 1}
    assert line["agree"] + sum(line[kind] for kind in KINDS) == line["cases"]
    assert (line["false_overturnings"], line["missed_overturnings"]) == (1, 1)
    assert line["wall_s"] == pytest.approx(6e-3)
