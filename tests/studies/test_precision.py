"""Error against run time, and what a scene costs: methods, timing, tables, the cheapest setting."""

import math
from dataclasses import replace
from functools import cache

import pandas as pd
import pytest
from declared import NUISANCE, equal_to

from analytic.response import Response
from engines import ENGINES, core_engines, installed_engines
from engines.declaration import Stepping
from studies import precision
from studies.kit.run import run
from studies.kit.tables import split
from studies.measures.costs import LEAST_RUNS, LEAST_S, best_of, cost_text, enough
from studies.precision import SCENES, STUDY, cheapest, jobs, measure

MOST_S = 4.0 * LEAST_S
ONE_CONTACT = {"drake": 0.6}
"""Error of a box whose face touches a plane in one point, whatever its rotation."""


@pytest.mark.parametrize(
    ("times", "spent_s", "known"),
    [
        ([1.0] * LEAST_RUNS, LEAST_S, True),
        ([1.0] * (LEAST_RUNS - 1), LEAST_S, False),
        ([1.0] * LEAST_RUNS, 0.9 * LEAST_S, False),  # too cold
        ([1.3, 1.0, 1.03, 1.3, 1.3], LEAST_S, False),  # the shortest came once
        ([1.3, 1.0, 1.03, 1.3, 1.01], LEAST_S, True),
        ([1.3], MOST_S, True),  # nothing more may be spent
    ],
)
def test_a_minimum_is_known_once_it_came_twice(times, spent_s, known):
    assert enough(times, spent_s, MOST_S) is known


def test_the_best_run_is_kept_with_the_least_set_up():
    runs = iter(
        [(3.0, 0.1), (1.0, 0.3), (2.0, 0.2), (4.0, 0.4), (1.01, 0.4)] + [(1.0, 0.5)] * 10**6
    )

    def action():
        wall_s, setup_s = next(runs)
        return replace(Response.failure("timed", wall_s=wall_s), setup_s=setup_s)

    ((response, count),) = best_of([action], MOST_S)
    assert (response.wall_s, response.setup_s) == (1.0, 0.1)
    assert count >= LEAST_RUNS
    assert best_of([action], 0.0)[0][1] == 1
    assert cost_text(0.0124, 5) == "12.4 ms" and cost_text(0.0124, 1) == "12.4 ms (1 run)"


def line(method, value, error, wall_s, kind="typical", failed=0):
    known = {"set": kind, "method": method, "value": value, "cases": 12, "failed": failed}
    return {**known, "median_error": error / 3.0, "max_error": error, "wall_s": wall_s, "runs": 5}


def test_the_cheapest_setting_holds_with_every_finer_one_and_is_compared_to_the_exact_time():
    lines = [line("Taylor series", value, value, 1e-5) for value in (1e-2, 1e-16)]
    # a coarse step may be lucky, and a failure is no candidate, however cheap
    lines += [line("mujoco landing", *each) for each in
              ((0.05, 1e-5, 1e-3), (0.02, 0.05, 2e-3), (0.01, 5e-3, 4e-3))]  # fmt: skip
    lines += [line("pymunk landing", 0.05, 1e-9, 1e-6, failed=1)]
    near = [line("mujoco landing", value, math.inf, 1.0, "near overturning") for value in
            (0.05, 0.02, 0.01)]  # fmt: skip
    table = pd.DataFrame([*lines, *near])
    target, best, cases = cheapest(table)
    assert (target, best["value"], cases) == (0.01, 0.01, "typical")
    said = precision.finding({"work-precision": table})
    assert said.startswith("MuJoCo") and "4 ms" in said and "400" in said and "typical" in said
    assert "10 µs" in precision.finding({"work-precision": table.head(2)})


posed = cache(jobs)


def few(*names, **labels):
    asked = [job for job in posed(names, True) if labels.items() <= job.labels.items()]
    return [replace(job, labels={**job.labels, "budget_s": 0.0}) for job in asked]


def test_a_wrong_outcome_is_an_infinite_error_and_each_table_has_its_rows():
    free = {"scene": "free body instead of planar"}
    asked = [*few("exact", "housner", set="near overturning", figure=8)]
    assert not few("pymunk", **free)  # it has none
    asked += few("mujoco", **free)
    rows = run(asked, measure)
    tables = STUDY.tabulate(split(rows, "table"))
    found = tables["work-precision"].set_index("method")["max_error"]
    assert found["housner, closed form"] == math.inf
    assert found["Taylor series"].min() < 1e-9 < 1e-3 < found["Taylor series"].max()
    assert tables["precision"]["figure"].dtype == int
    (free,) = tables[SCENES].to_dict("records")
    assert free["error"] == pytest.approx(0.0, abs=1e-4)
    assert list(STUDY.shown(tables).values())[-1]["cost"].item() == free["wall_s"] / free["plain_s"]
    assert {row["table"] for row in STUDY.needed(rows)} == {"precision"}


@pytest.mark.slow
@pytest.mark.parametrize("engine", installed_engines())
def test_what_is_left_out_can_be_put_back(engine):
    """A full box keeps contacts that a corner has left, and more where it has one contact.

    Equal steps hold an impact within one; nothing else may cost more than roundings, which equal
    steps, or those of an estimated error, add up otherwise in other coordinates.
    """
    assert engine not in core_engines() or len(few(engine, table=SCENES)) == 7
    rows = {row["scene"]: row for row in run(few(engine, table=SCENES), measure)}
    lands = ENGINES[engine].best.stepping is Stepping.LANDING
    whole = 0.385157 if lands else rows["as it is"]["peak_ratio"]
    assert whole == pytest.approx(0.385157, rel=1e-2)
    costs = {"full box instead of corners": ONE_CONTACT.get(engine, 1e-1), "steps all equal": 1e-2}
    least = max(2.0 * equal_to(engine), NUISANCE.get(engine, 0.0))
    for name, row in rows.items():
        assert row["outcome"] == "rocked", (name, row["message"])
        allowed = max(costs.get(name, 1e-4 if lands else 1e-3), least)
        assert row["peak_ratio"] == pytest.approx(whole, rel=allowed), name
