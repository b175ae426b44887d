"""Words made of counts and numbers, and what a sweep says with them."""

import math

import pandas as pd
import pytest

from studies.measures import words
from studies.measures.posed import Posed
from studies.sweep import study as sweep


@pytest.mark.parametrize(
    ("count", "text"), [(960, "all 960"), (0, "none of 960"), (949, "949 of 960")]
)
def test_all_and_none_are_counted(count, text):
    assert words.out_of(count, 960) == text


@pytest.mark.parametrize(
    ("value", "text"),
    [
        (0.9958, "99.5 %"),
        (1.0, "100 %"),
        (0.0846, "8.5 %"),
        (0.39, "39 %"),
        (7.8e-5, "7.8·10⁻⁵"),
        (1e-4, "10⁻⁴"),
        (0.0, "0"),
        (math.inf, "without bound"),
        (math.nan, "-"),
    ],
)
def test_a_part_is_never_rounded_to_the_whole(value, text):
    assert words.part(value) == text


def test_lists_and_times():
    assert words.listed([]) == "none"
    assert words.listed(["a", "b", "c"]) == "a, b and c"
    assert words.alike(["1 %", "1 %"]) == "1 %"
    assert words.each_out_of([949, 955], [960, 960]) == "949 and 955 of 960"
    assert words.each_out_of([960, 960], [960, 960]) == "all 960"
    assert words.each_out_of([3, 27], [31, 27]) == "3 of 31 and all 27"
    assert words.times(0.62) == "0.62 of" and words.times(192.4) == "192 times"
    assert words.duration(1.78e-3) == "1.78 ms" and words.duration(19.2e-6) == "19.2 µs"


def summary(source, agree, median, largest, false=0, missed=0):
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
        "false_overturnings": false,
        "missed_overturnings": missed,
        "wall_s": 1.0,
    }


def test_a_sweep_tells_presets_apart_and_names_each_engines_outcomes():
    lines = pd.DataFrame(
        [
            summary("exact", 10, 0.0, 0.0),
            summary("housner", 8, 0.5, 2.0, false=2),
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


def test_of_many_engines_a_sweep_tells_the_range_and_who_is_at_its_ends():
    lines = pd.DataFrame(
        [
            summary("pybullet:naive", 9, 0.01, 0.4),
            summary("mujoco:naive", 10, 0.08, 0.9),
            summary("pymunk:naive", 7, 0.5, 0.8),
        ]
    )
    said = (
        "As their documentation shows them, 3 engines get the fall wrong in up to 3 (pymunk) of "
        "10 cases each, and peaks off by up to 90 %."
    )
    assert sweep.finding_of(lines) == said
    assert sweep.verdict(sweep.preset_table(lines)) == said
    asked = Posed(cases=10, problems=5, sizes=2, least=1.1, largest=1.5)
    assert asked.words == "10 cases are 5 problems, each in 2 sizes, at 1.1 to 1.5 times the onset"
