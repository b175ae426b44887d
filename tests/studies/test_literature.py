"""Printed numbers: how they are read, and what an independent solution made of each.

Of engines' own tests each exact number by another way, what their bounds let pass, their table.
"""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from engines import core_engines
from studies.__main__ import run
from studies.kit.tables import read_table
from studies.literature import readings
from studies.literature.peers import PEERS, peers, put, read_off
from studies.literature.prints import PROBLEMS
from studies.literature.problems import ModeEnd, OrbitLimit, Restitution, Threshold, number
from studies.literature.readings import reduce, solve_problem
from studies.literature.study import answers, can_answer, literature_job
from studies.sources.registry import resolve

RECOMPUTED = {
    "steady state A": (3.1510, 3.1510),
    "steady state B": (8.2258, 6.0155),
    "steady state C": (3.7911, 3.7911),
    "steady state D": (5.6254, 3.9649),
    "one sine, housner, overturning begins": (3.01864,),
    "one sine, housner, overturning ends": (6.3179,),
    "one sine, housner, overturning begins again": (7.16813,),
    "one sine, exact, with one impact": (2.2232,),
    "one sine, housner, without impact": (3.2301,),
    "half-sine of 0.5 s, housner": (0.554586,),
    "one sine of 1 s, housner": (0.451540,),
    "one cosine of 1 s, exact": (0.625845,),
    "one cosine of 2 s, p = 1 rad/s": (0.530710,),
}
"""By an adaptive Runge-Kutta solution that shares no code with this project, to these digits."""

NAMED = {problem.name: problem for problem in PROBLEMS}


def asked(problem, source):
    return reduce(
        literature_job(problem, source),
        solve_problem(literature_job(problem, source), resolve(source)),
    )


def values(row):
    return tuple(value for value in (row["value"], row["other_side"]) if not math.isnan(value))


@pytest.mark.parametrize("name", RECOMPUTED)
def test_an_independent_solution_finds_the_same(name):
    problem = NAMED[name]
    row = asked(problem, problem.model)
    # half of the last digit to which the independent solution was noted
    assert values(row) == pytest.approx(RECOMPUTED[name], rel=3e-5), row["message"]


@pytest.mark.parametrize("problem", PROBLEMS, ids=lambda problem: problem.name)
def test_the_model_of_the_print_is_within_two_percent_of_it(problem):
    row = asked(problem, problem.model)
    for value, printed in zip(values(row), problem.printed, strict=False):
        assert printed.miss(value) < (0.5 if isinstance(problem, Restitution) else 0.02)
    assert len(values(row)) >= len(problem.printed), row["message"]
    bounds = [printed.bounds for printed in problem.printed]
    agree = all(
        low <= value <= high for value, (low, high) in zip(values(row), bounds, strict=False)
    )
    # what does not come out has its reason
    assert agree == (problem.why == "")


def test_the_steady_states_tell_the_models_apart():
    linear = values(asked(NAMED["steady state B"], "housner"))
    assert linear == pytest.approx((9.11, 4.98), rel=1e-3)


def test_printed_digits_are_what_rounds_to_them():
    assert number("3.2").bounds == pytest.approx((3.15, 3.25))
    assert number("3.00", "3.01").bounds == (3.0, 3.01)
    assert number("2").bounds == (1.5, 2.5)
    assert number("3.2").miss(3.2) == 0.0
    assert number("3.00", "3.01").miss(3.04) == pytest.approx(3.04 / 3.01 - 1.0)
    assert number("3.00", "3.01").miss(2.97) == pytest.approx(3.0 / 2.97 - 1.0)
    assert math.isnan(number("3.2").miss(math.nan))


def test_an_engine_is_asked_only_where_its_impacts_are_those_of_the_print():
    for problem in PROBLEMS:
        ideal = problem.block.restitution == pytest.approx(
            max(1.0 - 1.5 * math.sin(problem.block.alpha) ** 2, 0.0)
        )
        by_formula = isinstance(problem, ModeEnd | OrbitLimit)
        assert can_answer(problem, "mujoco") == (ideal and not by_formula)


@pytest.mark.parametrize(
    "problem",
    [problem for problem in PROBLEMS if isinstance(problem, Threshold) and problem.shift],
    ids=lambda problem: problem.name,
)
def test_what_a_print_is_off_by(problem):
    """Its reason is true: it does not come out, and does with the frequency that is named."""
    moved = replace(problem.pulse, omega=problem.pulse.omega * (1.0 + problem.shift))
    edges = {}
    for pulse in (problem.pulse, moved):
        with pytest.MonkeyPatch.context() as patch:
            patch.setitem(readings.NAMED, problem.name, replace(problem, pulse=pulse))
            edges[pulse] = asked(problem, problem.model)["value"]
    (low, high), found = problem.printed[0].bounds, edges.values()
    assert [low <= value <= high for value in found] == [False, True]


@pytest.mark.parametrize("engine", core_engines())
def test_engines_drop_a_block_without_friction(engine):
    """Its corner slides away under it; near the balance, where it starts, errors grow."""
    row = asked(NAMED["drop without friction"], engine)
    assert row["value"] == pytest.approx(0.5874779745738901, rel=2e-5)
    assert row["other_side"] == pytest.approx(4.130760093379687, rel=5e-5)


def test_a_threshold_that_is_not_there_is_a_failure_with_its_reason():
    problem = next(problem for problem in PROBLEMS if isinstance(problem, Threshold))
    far = type(problem)(
        **{name: getattr(problem, name) for name in problem.__dataclass_fields__}
        | {"printed": (number("0.50", "0.51"),)}
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(readings.NAMED, far.name, far)
        row = asked(far, far.model)
        beside = asked(far, "exact")
    # a model that the print is not about may have none there
    assert beside["outcome"] != "failed"
    assert math.isnan(beside["value"])
    assert row["outcome"] == "failed"
    assert "no threshold" in row["message"]


def test_the_command_writes_what_it_says(tmp_path, capsys):
    assert run(["literature", "--out", str(tmp_path), "--sources", "modified"]) in (0, 1)
    table = read_table(tmp_path / "agreement.csv", "printed")
    assert set(table["problem"]) == set(NAMED)
    assert (tmp_path / "literature.png").stat().st_size > 4_000
    assert "printed numbers" in capsys.readouterr().out
    shown = answers(table)
    assert len(shown) == sum(len(problem.printed) for problem in PROBLEMS)
    orbit = shown.set_index("problem").loc["orbit (1, 1) loses its stability"]
    assert (orbit["printed"], orbit["housner"], orbit["exact"]) == ("9.63982", "9.63982", "")
    wrong = ~shown["agrees"].astype(bool)
    assert (shown["why"] != "").equals(wrong) and (shown["miss"] > 0.0).equals(wrong)


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
