"""What a scene costs: every part is timed, every omission can be put back."""

import contextlib
import itertools
import math
import time
from dataclasses import replace

import pytest
from declared import equal_to

from analytic.response import Outcome, Reason, Response
from engines import ENGINES, Scene, core_engines, installed_engines
from engines.declaration import Stepping
from engines.run.drive import run
from studies.measures.costs import LEAST_RUNS
from studies.precision import cost, shares
from studies.precision.cost import (
    in_a_new_process,
    omissions,
    put_back,
    reference_table,
    scene_memory,
    scene_table,
)
from studies.precision.repeats import LEAST_S
from studies.precision.shares import CASE, clock, share_table

SCENE = Scene(system=CASE.block, motion=CASE.motion)
ONE_CONTACT = {"drake": 0.6}
"""What a box costs whose face touches a plane in one point, whatever its rotation."""


@pytest.mark.parametrize("engine", installed_engines())
@pytest.mark.parametrize("omission", omissions())
def test_what_is_left_out_can_be_put_back(engine, omission):
    response = put_back(engine, omissions()[omission])
    if response.reason is Reason.UNAVAILABLE:
        assert engine not in core_engines()
        pytest.skip(response.message)
    assert response.outcome is Outcome.ROCKED, response.message
    # a full box keeps contacts that a corner has left: its impact is off by some per cent, and by
    # more where it has one contact; equal steps hold the impact within one: the next 1e-2; nothing
    # else may cost more than roundings, here and where the base has moved
    costs = {"full box instead of corners": ONE_CONTACT.get(engine, 1e-1), "steps all equal": 1e-2}
    lands = ENGINES[engine].best.stepping is Stepping.LANDING
    # equal steps, or those of an estimated error, add it up otherwise in other coordinates
    least = max(2.0 * equal_to(engine), ENGINES[engine].nuisance_sensitivity)
    allowed = max(costs.get(omission, 1e-4 if lands else 1e-3), least)
    whole = 0.385157 if lands else run(engine, SCENE).peak_ratio
    assert whole == pytest.approx(0.385157, rel=1e-2)
    assert response.peak_ratio == pytest.approx(whole, rel=allowed)
    assert (response.history is not None) == ("times" in omissions()[omission])


TIMED = [name for name in core_engines() if ENGINES[name].own_step]


@pytest.mark.parametrize("engine", TIMED)
def test_a_clock_sees_every_step_and_goes_away(engine):
    scene = replace(SCENE, compiled=False)
    plain = run(engine, scene)
    with clock(engine) as spent:
        watched = run(engine, scene)
    assert watched.peak_ratio == plain.peak_ratio
    assert len(spent) >= watched.steps
    assert 0.0 < sum(spent) < watched.wall_s + watched.setup_s
    before = len(spent)
    run(engine, scene)
    assert len(spent) == before


def test_the_clock_s_own_time_is_nobody_s(monkeypatch):
    steps = run("mujoco", SCENE).steps

    @contextlib.contextmanager
    def known_times(engine):
        yield [4.5] * steps

    monkeypatch.setattr(shares, "clock", known_times)
    monkeypatch.setattr(shares, "tick", lambda: 0.5)
    (row,) = share_table(["mujoco"], 0.0).to_dict("records")
    assert row["engine_s"] == pytest.approx(4.0)
    assert 0.0 < row["step_s"] < 1.0


def test_an_engine_s_own_step_that_no_clock_fits_around_is_unknown():
    (row,) = share_table(["pymunk"], 0.0).to_dict("records")
    assert math.isnan(row["engine_s"]) and row["step_s"] > 0.0


def test_an_engine_that_is_not_here_has_no_shares(monkeypatch):
    missing = Response.failure("not available: no such library")
    monkeypatch.setattr(shares, "run", lambda engine, scene: missing)
    (row,) = share_table(["pybullet"], 0.0).to_dict("records")
    assert row["engine"] == "pybullet"
    assert math.isnan(row["step_s"]) and math.isnan(row["engine_s"])


def test_a_burst_of_other_work_slows_no_scene(monkeypatch):
    """Whatever slows the first runs, all at the same speed, is over before the last of each."""
    count = itertools.count()

    def slow_at_first(engine, settings):
        time.sleep(2.0 * LEAST_S / LEAST_RUNS)  # what is timed is warm after so few runs
        slow = 1.2 if next(count) < 2 * LEAST_RUNS else 1.0
        response = put_back(engine, {})
        return replace(response, wall_s=slow)

    monkeypatch.setattr(cost, "put_back", slow_at_first)
    monkeypatch.setattr(cost, "in_a_new_process", lambda *_: 0.0)
    table = scene_table(["mujoco"], 10.0)
    assert table["wall_s"].tolist() == [1.0] * len(table)
    assert (table["runs"] >= LEAST_RUNS).all()


def test_reference_is_timed_with_what_it_leaves_out():
    table = reference_table()
    assert (table["wall_s"] > 0).all()
    assert table["scene"].is_unique


def test_memory_is_of_a_scene_alone():
    memory = in_a_new_process(scene_memory, "mujoco", {})
    assert math.isnan(memory) or 0 <= memory < 1e5
