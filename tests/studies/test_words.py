"""Words made of counts and numbers."""

import math

import pytest

from studies.measures import words


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
