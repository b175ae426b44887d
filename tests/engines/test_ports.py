"""MuJoCo Warp and MJX: what they take of MuJoCo's settings, and its answers in their numbers."""

import numpy as np
import pytest
from declared import equal_to
from uses import BLOCK, HERE, pulse, rocked, scene

from analytic import RigidBlock
from engines import ENGINES
from engines.declaration import AT_REST
from engines.mujoco.port import Port
from engines.mujoco.settings import MujocoSettings
from engines.run.batch import run_together
from engines.run.drive import build, run

PORTS = ("warp", "mjx")
every_port = pytest.mark.parametrize("name", [name for name in PORTS if name in HERE])


@pytest.mark.parametrize("name", PORTS)
@pytest.mark.parametrize("setting", [{"carry": 1e-4}, {"reflection": True}, {"solver": "PGS"}])
def test_what_it_would_refuse_or_not_heed_is_bad_input(name, setting):
    assert not ENGINES[name].best.takes(**setting)


def test_a_tolerance_that_warp_raises_is_bad_input():
    assert ENGINES["warp"].best.takes(tolerance=1e-6)
    assert not ENGINES["warp"].best.takes(tolerance=1e-7)


def test_mjx_s_stiff_contact_is_not_built_for_a_base_that_moves():
    moved, mjx = scene(frame="world"), ENGINES["mjx"]
    words = "mjx:fixed is not built here for a base that moves in the world"
    assert mjx.lacks(moved, mjx.preset("fixed")) == words
    assert not mjx.lacks(moved, mjx.preset("naive"))
    assert not mjx.lacks(scene(frame="base"), mjx.preset("fixed"))


@pytest.mark.skipif("warp" not in HERE, reason="it is not installed")
def test_what_warp_has_no_room_for_is_a_fault_and_its_last_iteration_is_none():
    world = build(HERE["warp"], scene(preset="naive"))
    kinds = world._worlds._mjw.OverflowType
    said = []
    for lost in (kinds.ITERATIONS, kinds.ITERATIONS | kinds.NARROWPHASE):
        world._worlds._overflow = np.array([int(lost)])
        said.append(world.fault())
    assert said == ["", "MuJoCo Warp had no room: NARROWPHASE"]


def test_worlds_side_by_side_hold_no_data_of_mujoco_s(monkeypatch):
    """Each takes 14 MB: some 300 scenes would not fit into what a process of a study may hold."""
    mujoco = pytest.importorskip("mujoco")
    monkeypatch.setattr(mujoco, "MjData", None)
    scenes = [scene(frame="world", start=(0.1, 0.0)), scene(frame="world")]
    port = Port(scenes, MujocoSettings(), np.array([1e-3, 2e-3]))
    assert port.starts[0] != port.starts[1]
    assert port._base_place.tolist() == [[[0.0, 0.0, -BLOCK.height]]] * 2


@every_port
def test_side_by_side_blocks_of_other_sizes_answer_as_each_alone(name):
    tall = RigidBlock(width=0.4, height=2.0)
    asked = [scene(pulse(1.3, 3.0, 1, it), system=it) for it in (scene().system, tall)]
    asked.append(scene(pulse(0.5, 3.0)))
    each = [run(name, it) for it in asked]
    for together, alone in zip(run_together(name, asked), each, strict=True):
        assert (together.outcome, together.steps) == (alone.outcome, alone.steps)
        assert together.peak_ratio == pytest.approx(alone.peak_ratio, rel=equal_to(name))


@pytest.mark.slow
@every_port
def test_the_defaults_are_mujoco_s_in_other_numbers(name):
    port, mujoco = (rocked(engine, preset=AT_REST) for engine in (name, "mujoco"))
    assert port.outcome is mujoco.outcome
    assert port.peak_ratio == pytest.approx(mujoco.peak_ratio, rel=1e-3)
    assert port.steps == mujoco.steps


@pytest.mark.slow
@pytest.mark.skipif("mjx" not in HERE, reason="it is not installed")
@pytest.mark.parametrize(
    ("preset", "settings", "apart"),
    [(AT_REST, {}, 1e-6), ("naive", {"geometry": "corners"}, 1e-6), ("naive", {}, 0.5)],
)
def test_in_double_precision_mjx_is_mujoco_but_for_two_boxes(preset, settings, apart):
    """Its solver may end an iteration earlier or later: to 1e-6, not to the bit.

    Of a box on a base that is moved, a box as well, it counts a contact thrice.
    """
    mujoco = rocked("mujoco", preset=preset, settings=settings)
    double = rocked("mjx", preset=preset, settings={**settings, "precision": "double"})
    assert double.outcome is mujoco.outcome
    change = abs(double.peak_ratio / mujoco.peak_ratio - 1.0)
    assert change < apart
    assert (change > 0.02) == (apart > 0.1)
