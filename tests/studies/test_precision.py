"""Error against run time: the methods, the measures, the diagram's table."""

import math
from dataclasses import replace

import numpy as np
import pandas as pd
import pytest
from given import BLOCK, PULSE

from analytic import Outcome, simulate
from engines import core_engines, installed_engines
from studies import respond
from studies.cases.paper import HISTORIES
from studies.cases.selection import chosen_cases
from studies.measures.energy import energy_drift
from studies.old.jobs import ask
from studies.precision.figure import style_of
from studies.precision.methods import METHODS, methods_of
from studies.precision.report import (
    cheapest,
    finest,
    over_targets,
    with_errors,
    work_precision,
)
from studies.precision.study import measure, precision_jobs, quick_values, reduce


def tabulate(*names, kind="typical"):
    rows = [
        {**job.labels, **reduce(job, measure(job, job.asked, budget_s=0.0))}
        for job in precision_jobs(True, core_engines())
        if job.labels["method"] in names and job.labels["set"] == kind
    ]
    return with_errors(pd.DataFrame(rows))


@pytest.mark.parametrize("name", methods_of(installed_engines()))
def test_every_method_answers_at_its_coarsest_setting(name):
    method = METHODS[name]
    options = method.options_at(method.values[len(method.values) // 2])
    response = respond(method.source, BLOCK, replace(PULSE, half_cycles=1), **options)
    # as it comes, an engine may hold the block at rest
    wrong = {Outcome.AT_REST} if name.endswith("naive") else set()
    assert response.outcome in {Outcome.ROCKED, *wrong}
    assert style_of(name) != style_of("nobody")
    assert quick_values(method)


def test_sets_of_cases_survive_and_one_is_near_overturning():
    typical, near = (
        np.array([simulate(case.block, case.motion).peak_ratio for case in cases])
        for cases in chosen_cases(quick=False).values()
    )
    assert len(typical) == len(near) == 12
    assert typical.max() < 0.5
    assert near.max() > 0.9
    assert (near > typical).all()


@pytest.mark.parametrize("method", ["RK45", "DOP853", "Radau", "LSODA"])
def test_general_purpose_integrators_converge_to_the_reference(method):
    case = HISTORIES[5][2]
    watched = {"duration": case.motion.duration + 2.0}
    watched["times"] = np.linspace(0, watched["duration"], 50)
    exact = simulate(case.block, case.motion, **watched)
    errors = []
    for rtol in (1e-4, 1e-9):
        found = respond(method.lower(), case.block, case.motion, rtol=rtol, **watched)
        assert abs(len(found.impacts) - len(exact.impacts)) <= 3
        errors.append(abs(found.peak_ratio / exact.peak_ratio - 1))
    assert errors[1] < 1e-7 < 1e-6 < errors[0]
    shared = np.interp(found.history.time, watched["times"], exact.history.theta)
    np.testing.assert_allclose(found.history.theta, shared, atol=1e-7)


def test_energy_drifts_with_the_method_that_loses_it():
    drifts = {
        job.labels["value"]: energy_drift(job.block, job.motion, ask(job, job.asked))
        for job in precision_jobs(False, ())
        if (job.labels["method"], job.labels["figure"]) == ("average acceleration", 8)
        and job.labels["value"] in (0.1, 1e-3)
    }
    assert drifts[0.1] > 10 * drifts[1e-3] > 0


def test_cheapest_setting_has_every_case_below_the_target_and_none_failed():
    table = work_precision(tabulate("Taylor series", "average acceleration"))
    # as if each setting cost what its steps do, whatever the machine is busy with
    table["wall_s"] = table["steps"]
    line = table[table["method"] == "average acceleration"]
    taylor = table[table["method"] == "Taylor series"].set_index("value")["steps"]
    failing = line.assign(method="RK4", failed=1)
    costs = cheapest(pd.concat([table, failing]))
    known = costs.set_index(["method", "target"])
    ratio = taylor.loc[1e-8] / taylor.iloc[-1]
    assert known.loc[("Taylor series", 1e-6)].tolist() == [1e-8, pytest.approx(ratio)]
    assert ("average acceleration", 1e-6) not in known.index
    # a setting with a failed case is no candidate, however cheap
    assert "RK4" not in set(costs["method"])
    shown = over_targets(costs, "value").set_index("method")
    assert list(shown) == ["0.01", "0.001", "0.0001", "1e-06"]
    assert shown.loc["Taylor series", "1e-06"] == 1e-8
    assert math.isnan(shown.loc["average acceleration", "1e-06"])


def test_the_finest_setting_is_that_of_the_smallest_error():
    table = work_precision(tabulate("Taylor series", "average acceleration"))
    table.loc[0, "failed"] = 2
    found = finest(table).set_index("method")
    assert found["failed"].tolist() == [2, 0]
    least = table.groupby("method")["median_error"].min()
    assert (found["median_error"] == least[found.index]).all()
    assert found.loc["average acceleration", "order"] == pytest.approx(2.0, abs=0.1)
    assert found.loc["average acceleration", "order_error"] < 0.1


def test_a_wrong_outcome_is_an_infinite_error():
    compared = tabulate("housner, closed form", kind="near overturning")
    assert np.isinf(compared["error"]).any()
    assert work_precision(compared)["max_error"].iloc[0] == math.inf


def test_timed_answer_is_the_recorded_one():
    job = next(job for job in precision_jobs(True, ()) if job.labels["method"] == "RK4")
    response = measure(job, job.asked, budget_s=0.01)
    assert response.history is not None
    assert response.setup_s > 0
    assert response.peak_ratio == ask(job, job.asked).peak_ratio
