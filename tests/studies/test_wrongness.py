"""One count of what is wrong, in three kinds, and every sentence that says it."""

import math

import pandas as pd
import pytest

from analytic.response import Outcome
from studies.measures.differences import summarize, with_reference
from studies.measures.posed import posed
from studies.measures.words import between, in_kinds, right_of
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
from studies.sweep import study as sweep

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
    words = "the fall wrong in 1, at rest for rocked in 1 and no answer in 1"
    assert in_kinds(counts) == words and right_of(rows) == f"2 of 5 ({words})"
    assert in_kinds(dict.fromkeys(KINDS, 0)) == "none wrong" and right_of(rows[3:]) == "all 2"


def test_several_sources_are_never_added_up():
    lines = pd.DataFrame({FALL: [1, 44, 3], REST: [0, 0, 357], NO_ANSWER: [0, 0, 0]})
    names = pd.Series(["dart", "pymunk", "drake"])
    assert between(lines, names) == (
        "the fall wrong in 1 (dart) to 44 (pymunk) and at rest for rocked in up to 357 (drake)"
    )
    assert between(lines.assign(**{FALL: 2, REST: 0}), names) == "the fall wrong in 2 each"
    assert between(lines * 0, names) == "none wrong"


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


def test_a_sweep_says_the_kinds_and_how_many_problems_its_cases_are():
    rows = drake_like()
    lines = summarize(with_reference(rows))
    words = "the fall wrong in 2, at rest for rocked in 2 and no answer in 1"
    assert f"one engine gets {words} of 6 cases, and peaks" in sweep.finding_of(lines)
    many = pd.concat([lines, lines.assign(source="dart:naive", rest_wrong=0, no_answer=0)])
    many = pd.concat([many, lines.assign(source="pymunk:naive")], ignore_index=True)
    table = sweep.preset_table(many)
    said = (
        "3 engines get the fall wrong in 2 each, at rest for rocked in up to 2 (Drake) and no "
        "answer in up to 1 (Drake) of 6 cases each, and peaks off by up to "
    )
    assert sweep.verdict(table).startswith(f"As their documentation shows them, {said}")
    asked = posed(rows)
    assert asked.words == "6 cases are 4 problems, in up to 2 sizes, at 1.1 times the onset"
    assert said in sweep.finding_of(many)
    assert f"housner {words}." in sweep.finding_of(lines.assign(source="housner"))
    assert sweep.finding_of(lines.assign(source="exact")) == ""


def test_cases_that_are_alike_by_similarity_are_one_problem():
    found = posed(drake_like())
    assert (found.cases, found.problems, found.sizes) == (6, 4, 2)
    assert found.least == found.largest == pytest.approx(1.1)


def summary(source, agree, median, largest):
    return {
        "source": source,
        "cases": 10,
        "agree": agree,
        "fall_wrong": 10 - agree,
        "rest_wrong": 0,
        "no_answer": 0,
        "median_error": median,
        "max_error": largest,
        "p90_error": largest,
        "wall_s": 1.0,
    }


def test_a_sweep_tells_presets_apart_and_names_each_engines_outcomes():
    lines = pd.DataFrame(
        [
            summary("exact", 10, 0.0, 0.0),
            summary("housner", 8, 0.5, 2.0),
            summary("pybullet:naive", 9, 0.01, 0.4),
            summary("mujoco:naive", 10, 0.08, 0.9),
            summary("pybullet", 10, 2e-6, 3e-5),
        ]
    )
    text = sweep.finding_of(lines)
    assert "2 engines get the fall wrong in up to 1 (PyBullet) of 10 cases each" in text
    assert "with steps that land on impacts, one engine gets none wrong of 10 cases" in text
    assert "by linearization: housner the fall wrong in 2." in text
    table = sweep.preset_table(lines)
    assert list(table["source"]) == ["pybullet:naive", "mujoco:naive", "pybullet"]
    assert table["ms"].iloc[0] == pytest.approx(100.0)
