"""What a scene costs: every part is timed, every omission can be put back."""

import math

import pytest

from analytic import Outcome
from engines import ENGINES, Scene, run
from studies.precision.cost import (
    clocks,
    in_a_new_process,
    omissions,
    pose_case,
    reference_table,
    scene_memory,
    share_table,
)

BLOCK, MOTION = pose_case()


@pytest.mark.parametrize("engine", ENGINES)
@pytest.mark.parametrize("omission", omissions(BLOCK, MOTION), ids=lambda item: item.name)
def test_what_is_left_out_can_be_put_back(engine, omission):
    response = run(engine, Scene(block=BLOCK, motion=MOTION, **omission.put_back))
    assert response.outcome is Outcome.ROCKED, response.message
    # a full box keeps contacts that a corner has left: its impact is off by up to 3e-2 in PyBullet;
    # equal steps hold the impact within one: the next 1e-2; nothing else may cost accuracy
    costs = {"full box instead of corners": 3e-2, "steps all equal": 1e-2}
    allowed = costs.get(omission.name, 1e-4)
    assert response.peak_ratio == pytest.approx(0.385157, rel=allowed)
    assert (response.history is not None) == ("times" in omission.put_back)


@pytest.mark.parametrize("engine", ENGINES)
def test_clocks_see_every_part_and_go_away(engine):
    scene = Scene(block=BLOCK, motion=MOTION)
    plain = run(engine, scene)
    with clocks(engine) as spent:
        watched = run(engine, scene)
    assert watched.peak_ratio == plain.peak_ratio
    assert all(total > 0 for total in spent.values())
    assert spent["engine"] < spent["step"]
    kept = dict(spent)
    run(engine, scene)
    assert spent == kept


def test_shares_add_up_to_less_than_the_step():
    table = share_table(0.0)
    assert set(table["engine"]) == set(ENGINES)
    assert (table.filter(like="_s") > 0).all(axis=None)


def test_reference_is_timed_with_what_it_leaves_out():
    table = reference_table()
    assert (table["wall_s"] > 0).all()
    assert table["scene"].is_unique


def test_memory_is_of_a_scene_alone():
    memory = in_a_new_process(scene_memory, "mujoco", {})
    assert math.isnan(memory) or 0 <= memory < 1e5
