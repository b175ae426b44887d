"""One look a step: compiled or not, from Python or from MuJoCo's loop, to the same bit."""

from types import SimpleNamespace

import pytest
from given import BLOCK, all_but_times, noise
from uses import HERE, rocked, scene

from analytic import SinePulse
from engines import ENGINES
from engines.declaration import AT_REST
from engines.mujoco import loop as mujoco_loop
from engines.run import look
from engines.run.run import build

TIMES = [0.02 * i for i in range(80)]
LOOSE = {"accuracy": "loose"}
OF_ALL = {
    "landing": {},
    "history": {"times": TIMES, "duration": 2.0},
    "released": {"start": (0.5 * BLOCK.alpha, 0.3), **LOOSE},
    "tuned": {"preset": "tuned", "step": 5e-3},
    "default": {"preset": "default"},
    "moving base": {"frame": "world", **LOOSE},
    "box": {"settings": {"geometry": "box"}, **LOOSE},
    "free body": {"settings": {"planar": False}, **LOOSE},
    "record": {"motion": noise(1, 1200, 0.01, 6.0), **LOOSE},
    "given up": {"max_steps": 300},
    "slides": {"friction": 0.05},
    "lost": {"motion": SinePulse(amplitude=1e30, omega=1.0), "preset": "tuned"},
}
WELDED = {"floor": "weld"}
SCENES = {
    "mujoco": {
        **OF_ALL,
        "default at rest": {"preset": AT_REST},
        "landing on a welded base": {"frame": "world", "settings": WELDED, **LOOSE},
        "free body on it": {"frame": "world", "settings": {**WELDED, "planar": False}, **LOOSE},
        "no reflection": {"settings": {"reflection": False}, **LOOSE},
        "no margin": {"settings": {"carry": None, "preload": False}, **LOOSE},
        "Runge-Kutta": {"settings": {"integrator": "RK4"}, **LOOSE},
    },
    "pybullet": {
        **OF_ALL,
        "default": {"preset": AT_REST},
        "base without velocity": {"settings": {"floor": "position"}, "frame": "world"},
        "same in all phases": {"settings": {"by_phase": False}, **LOOSE},
        "same gap": {"settings": {"gap_by_step": False}, **LOOSE},
        "default on a moving base": {"preset": "default", "settings": {"floor": "velocity"}},
        "hull on a box": {
            "preset": "tuned",
            "settings": {"geometry": "hull", "base_geometry": "box"},
            "step": 5e-3,
        },
    },
}
EACH = [
    pytest.param(engine, options, id=f"{engine}, {name}")
    for engine, scenes in SCENES.items()
    if engine in HERE
    for name, options in scenes.items()
]


@pytest.fixture
def eager(monkeypatch):
    monkeypatch.setattr(look, "patience", 0.0)


@pytest.mark.parametrize(("engine", "options"), EACH)
@pytest.mark.usefixtures("eager")
def test_a_run_answers_compiled_and_interpreted_alike(engine, options):
    """Where Python raises, compiled code goes on, and is asked."""
    compiled, plain = rocked(engine, **options), rocked(engine, compiled=False, **options)
    assert all_but_times(compiled) == all_but_times(plain)


def driven(**options):
    world = build(ENGINES["mujoco"].use(scene(accuracy="loose", **options)))
    world.close()
    return world.drive is not None


@pytest.mark.skipif("mujoco" not in HERE, reason="MuJoCo is not installed")
def test_mujoco_is_stepped_by_its_loop_unless_asked_not_to():
    assert ENGINES["mujoco"].compiles
    assert driven()
    assert not driven(compiled=False)


@pytest.mark.usefixtures("eager")
def test_memory_that_is_not_where_it_should_be_is_left_alone(monkeypatch):
    compiled = rocked("mujoco", accuracy="loose")
    found = mujoco_loop.layout("mjData")

    moved = SimpleNamespace(**{name: getattr(found, name) for name, *_ in found._fields_})
    # another build, in which the numbers of contacts and of rows have changed places
    moved.ncon, moved.nefc = found.nefc, found.ncon
    elsewhere = {"mjData": moved, "mjOption": mujoco_loop.layout("mjOption")}
    monkeypatch.setattr(mujoco_loop, "layout", elsewhere.__getitem__)
    mujoco_loop.usable.cache_clear()
    try:
        assert not driven()
        assert all_but_times(rocked("mujoco", accuracy="loose")) == all_but_times(compiled)
    finally:
        mujoco_loop.usable.cache_clear()
