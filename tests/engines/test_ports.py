"""MuJoCo Warp: what it takes of MuJoCo's settings, and its answers in single precision."""

import numpy as np
import pytest
from declared import equal_to
from uses import HERE, pulse, rocked, scene

from analytic import RigidBlock
from analytic.response import Outcome, Reason
from engines import ENGINES
from engines.run.batch import run_together
from engines.run.drive import build, run

WITH_WARP = pytest.mark.skipif("warp" not in HERE, reason="it is not installed")


@pytest.mark.skipif("warp" in HERE, reason="it is installed")
def test_where_it_is_missing_a_row_says_how_to_install_it():
    response = rocked("warp")
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
    assert "pip install 'rocking[warp]'" in response.message


@pytest.mark.parametrize("setting", [{"carry": 1e-4}, {"reflection": True}, {"solver": "PGS"}])
def test_what_it_would_refuse_or_not_heed_is_bad_input(setting):
    assert not ENGINES["warp"].best.takes(**setting)


def test_a_tolerance_that_it_raises_is_bad_input():
    assert ENGINES["warp"].best.takes(tolerance=1e-6)
    assert not ENGINES["warp"].best.takes(tolerance=1e-7)


@WITH_WARP
def test_what_it_has_no_room_for_is_a_fault_and_a_last_iteration_is_none():
    world = build(HERE["warp"], scene(preset="naive"))
    kinds = world._worlds._mjw.OverflowType
    said = []
    for lost in (kinds.ITERATIONS, kinds.ITERATIONS | kinds.NARROWPHASE):
        world._worlds._overflow = np.array([int(lost)])
        said.append(world.fault())
    assert said == ["", "MuJoCo Warp had no room: NARROWPHASE"]


@WITH_WARP
def test_side_by_side_blocks_of_other_sizes_answer_as_each_alone():
    tall = RigidBlock(width=0.4, height=2.0)
    asked = [scene(pulse(1.3, 3.0, 1, it), system=it) for it in (scene().system, tall)]
    asked.append(scene(pulse(0.5, 3.0)))
    each = [run("warp", it) for it in asked]
    for together, alone in zip(run_together("warp", asked), each, strict=True):
        assert (together.outcome, together.steps) == (alone.outcome, alone.steps)
        assert together.peak_ratio == pytest.approx(alone.peak_ratio, rel=equal_to("warp"))


@WITH_WARP
def test_a_solver_that_is_cut_short_prints_nothing(capfd):
    """With one iteration the solver is cut short in most steps, which it would print."""
    rocked("warp", settings={"iterations": 1}, max_steps=600)
    assert capfd.readouterr() == ("", "")


@pytest.mark.slow
@WITH_WARP
def test_the_defaults_are_mujoco_s_in_single_precision():
    warp, mujoco = (rocked(engine, preset="naive") for engine in ("warp", "mujoco"))
    assert warp.outcome is mujoco.outcome
    assert warp.peak_ratio == pytest.approx(mujoco.peak_ratio, rel=1e-3)
    assert warp.steps == mujoco.steps
