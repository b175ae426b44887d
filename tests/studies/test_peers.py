"""Engines' own tests: each exact number by another way, what their bounds let pass, their table."""

import math

import numpy as np
import pandas as pd
import pytest

from studies.literature.peers import PEERS, peers, put, read_off

G = 9.81


def rows(*engines):
    jobs = [job for test in PEERS for job in test.jobs(engines)]
    return pd.DataFrame(
        [{**job.labels, "source": job.source, **read_off(job, put(job, job.asked))} for job in jobs]
    )


def way_after_a_fall(mu, speed=2.0, drop=1e-3):
    """The way until a cube stops whose impact takes mu times the velocity of its fall."""
    fall = math.sqrt(2.0 * drop / G)
    return speed * fall + (speed - mu * G * fall) ** 2 / (2.0 * mu * G)


def way_of_steps(count, pull):
    """The way of so many steps of 1 ms, the rate changed first."""
    return float(np.cumsum(np.full(count, pull * 1e-3)).sum() * 1e-3)


def test_each_exact_number_comes_out_by_another_way():
    slope, landed = math.radians(20.0), 0.35 * 2.0 / G
    # half of a pull at 45 degrees is along y, by either of two directions across
    ways = [0.5 * (5.0 * math.cos(0.25 * math.pi) ** 2) * t2 for t2 in (0.302**2, landed)]
    found = peers(rows())
    assert found["exact"].to_numpy() == pytest.approx(
        [
            *map(way_after_a_fall, (0.2, 0.4, 0.7)),
            0.5 * (0.75**2 - 0.5**2) * G * (math.sin(slope) - 0.3 * math.cos(slope)),
            *(0.02, 6.0 - 0.5 * G * 0.2, 0.5 * 0.005 * G * 2.0**2, 2.5 * landed, sum(ways)),
        ],
        rel=1e-9,
    )
    assert list(found["exact_passes"]) == ["True"] * 8 + ["False"]
    assert set(found["source"]) == {""} and found["found"].isna().all()
    assert len(peers(rows().head(0))) == 2  # nothing is said of what was not asked


def test_what_the_bounds_let_pass():
    def way(mu, degrees, t2, pull=0.0):
        angle = math.radians(degrees)
        return 0.5 * t2 * (pull + G * math.sin(angle) - mu * G * math.cos(angle))

    measured = 0.75**2 - 0.5**2
    least = [
        way(0.350, 20.0, measured),
        way(0.822, 40.0, measured),
        way(0.504, 0.0, 4.0, 0.505 * G),
    ]
    assert least == pytest.approx([0.02] * 3, abs=1e-3)
    assert way(0.495, 0.0, 4.0, 0.495 * G) < 2e-3 < way(0.4948, 0.0, 4.0, 0.495 * G)
    # by what a unit of normal force accelerates the leading edge of a sliding cube upward
    lifted = 1.0 + 6.0 * 0.5 * (0.5 - 0.5 * 5.0 / 3.0)
    assert lifted == pytest.approx(0.0, abs=1e-15)


def test_darts_numbers_are_sums_of_its_steps():
    assert way_of_steps(266, G) < 0.35 < way_of_steps(267, G)
    assert round(way_of_steps(267, 5.0), 5) == 0.17889
    assert 0.5 * sum(way_of_steps(n, 5.0) for n in (302, 267)) == pytest.approx(0.20382, abs=1e-5)


def test_an_engine_is_asked_where_the_test_is_of_it():
    found = peers(rows("mujoco")).set_index("source").loc["mujoco:naive"]
    assert list(found["found_passes"]) == ["True"] * 4 + ["False"]
    newton = found[found["test"].str.startswith("Newton")]
    assert (newton["found"] / newton["exact"] - 1.0).abs().max() < 1e-3
