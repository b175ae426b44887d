"""What the contract promises: what is declared, what is missing or refused, and what is a fault."""

import math
import sys
from dataclasses import replace

import pytest
from commanding import python
from declared import run
from given import Bare
from known import ScriptedWorld
from uses import BLOCK, CORE, HERE, SHAKEN, every_use, held_frames, pulse, rocked, scene

from analytic import RigidBlock, RockingFrame, SlidingBlock
from analytic.motion import BothWays
from analytic.response import Outcome, Reason
from engines import ENGINES
from engines.run.run import build, simulate_world
from engines.world import Pose

SIZE = {"width": 0.5, "height": 1.5}
UNEVEN = RigidBlock(**SIZE, offset=0.1)
HEAVING = BothWays(SHAKEN, SHAKEN)


@pytest.mark.parametrize("name", ENGINES)
def test_a_declaration_is_whole(name):
    engine = ENGINES[name]
    assert engine.name == name
    assert engine.presets[0].name == "default"
    assert "step" in [source.setting for source in engine.presets[0].documented]
    assert not engine.presets[0].helped_by
    default, bare = engine.presets[0], type(engine.presets[0].settings)()
    assert all(getattr(default.settings, name) != value for name, value in default.own.items())
    assert replace(bare, **{name: getattr(default.settings, name) for name in default.own}) == (
        default.settings
    )
    for preset in engine.presets:
        assert isinstance(preset.settings.friction, float)
        for left_out in filter(None, preset.helped_by.values()):
            assert replace(preset.settings, **left_out) != preset.settings
    for item in engine.factors:
        assert all(hasattr(engine.best.settings, setting) for setting in item.settings)


@pytest.mark.parametrize("name", ENGINES)
def test_a_library_that_is_missing_is_a_row_that_says_how_to_install_it(name):
    def missing(*_):
        raise ModuleNotFoundError("No module named 'nothing'")

    response = run(replace(ENGINES[name], build=missing), scene())
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
    assert f"'nothing'; pip install '{ENGINES[name].install}'" in response.message


@pytest.mark.parametrize(
    ("change", "asked", "named"),
    [
        ({"frames": ("base",)}, {"frame": "world"}, "'world'"),
        ({"stacks": False}, {"system": RockingFrame(**SIZE, load=1.0)}, "is not built here for"),
        (
            {},
            {"system": SlidingBlock(**SIZE, friction=0.2), "preset": "landing"},
            "nothing rocks here",
        ),
        ({"offsets": False}, {"system": UNEVEN, "preset": "tuned"}, "PyBullet is not built here"),
        ({}, {"system": UNEVEN, "preset": "landing"}, "pybullet:landing is not built here"),
        ({}, {"rest_s": 0.2, "preset": "landing"}, "only equal steps can begin before"),
        ({}, {"motion": HEAVING, "preset": "landing"}, "pybullet:landing is not built here"),
        ({"lifts": ()}, {"motion": HEAVING, "preset": "default"}, "presets on a base at rest are"),
    ],
)
def test_what_an_engine_cannot_do_is_a_row_that_says_so(change, asked, named):
    response = run(replace(ENGINES["pybullet"], **change), scene(**asked))
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
    assert named in response.message


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"frame": "moon"}, "frame is 'moon'; it must be one of base, world"),
        ({"density": -1.0}, r"density is -1\.0; it must be positive"),
        ({"step": 0.0}, r"step is 0\.0; it must be positive"),
        ({"duration": 0.1}, r"duration is 0\.1; it must be at least the motion's"),
        ({"rest_s": -0.1}, r"rest_s is -0\.1; it must be 0 where"),
        ({"rest_s": 0.2, "start": (0.1, 0.0)}, r"rest_s is 0\.2; it must be 0 where"),
        ({"times": [1.0, 0.5]}, "they must increase"),
        ({"friction": -0.1}, r"friction is -0\.1; it must not be negative"),
        ({"motion": pulse(1.3, 1.0, 10**6 + 1)}, "half_cycles is 1000001; it must be at most 1000"),
        ({"motion": HEAVING, "system": RockingFrame(**SIZE, load=1.0)}, "vertical is given"),
        ({"motion": BothWays(SHAKEN, pulse(5.0, 3.0, 2))}, "presses on its base all the time"),
    ],
)
def test_a_scene_refuses_what_is_not_allowed(options, message):
    with pytest.raises(ValueError, match=message):
        scene(**options)


@pytest.mark.parametrize("engine", HERE)
def test_what_an_engine_does_not_have_is_refused(engine):
    with pytest.raises(ValueError, match=f"preset of {engine} is 'best'; it must be one of"):
        rocked(engine, preset="best")
    for preset in HERE[engine].presets:
        with pytest.raises(ValueError, match="setting is 'bounce'; it must be one of"):
            rocked(engine, preset=preset.name, settings={"bounce": 1})
    if HERE[engine].preset("default").takes(floor="position"):
        with pytest.raises(ValueError, match="floor is None; it must be one of"):
            rocked(engine, preset="default", settings={"floor": None})
    if engine in CORE:
        with pytest.raises(ValueError, match="geometry is 'ball'; it must be one of box, corners"):
            rocked(engine, settings={"geometry": "ball"})


def takes(engine, **options):
    """Build a scene, and go some steps: the library has refused no setting, then or before."""
    posed = scene(pulse(1.3, 1.0), **options)
    world = build(HERE[engine].use(posed))
    assert world.fault() == "", options
    world.close()
    assert run(engine, replace(posed, max_steps=20)).reason is not Reason.FAULT


@every_use
def test_what_a_preset_sets_is_taken_and_what_helps_it_can_be_left_out(engine, preset):
    """One at a time: what a preset is helped by is a setting, so that its price can be measured."""
    for frame in held_frames(engine, preset):
        takes(engine, preset=preset, frame=frame)
    for left_out in filter(None, HERE[engine].preset(preset).helped_by.values()):
        takes(engine, preset=preset, settings=left_out)


@pytest.mark.parametrize("engine", HERE)
def test_an_engine_is_imported_when_named_and_says_nothing(engine):
    own = {HERE[engine].library, "numpy", *HERE[engine].packages}  # it may be built on another
    libraries = {other.library for other in ENGINES.values()} - {"numpy"}
    script = (
        "import sys\n"
        "from analytic import RigidBlock, SinePulse\n"
        "from engines import ENGINES, Scene\n"
        "from engines.run.run import run\n"
        "assert all(engine.presets for engine in ENGINES.values())\n"
        f"assert not {libraries!r} & set(sys.modules)\n"
        f"block, pulse = {BLOCK!r}, {SHAKEN!r}\n"
        f"run(ENGINES[{engine!r}].use(Scene(system=block, motion=pulse)))\n"
        f"assert not {libraries - own!r} & set(sys.modules)\n"
    )
    done = python("-c", script, path=sys.path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")


def test_faults_are_asked_while_a_run_goes_on():
    """A setting that was not taken ends a run long before its hour of rest is over."""
    world = ScriptedWorld(scene())
    world.fault = lambda: "the moon is full"
    response = simulate_world(world, scene(pulse(0.5, 1.0), duration=3600.0), 1e-3)
    assert (response.reason, response.message) == (Reason.FAULT, "the moon is full")
    assert response.steps < 1000


@pytest.mark.parametrize(
    ("pose", "amount", "reason"),
    [
        (Pose(0.0, 0.75, math.nan, 0.0), "", Reason.DIVERGED),
        (Pose(0.0, math.inf, 0.0, 0.0), "", Reason.DIVERGED),
        (Pose(0.0, 0.75, math.inf, 0.0), "", Reason.DIVERGED),
        (Pose(0.0, -0.25, 0.0, 0.0), " 1 m", Reason.SANK),
        (Pose(0.0, 2.75, 0.0, 0.0), " 2 m", Reason.THROWN),
        (Pose(0.2, 0.75, 0.0, 0.0), " 0.2 m", Reason.SLID),
    ],
)
def test_poses_that_are_no_rocking_block(pose, amount, reason):
    world = Bare()
    world.state = lambda: [pose]
    response = simulate_world(world, scene(pulse(1.3, 1.0)), 1e-3)
    assert (response.outcome, response.reason) == (Outcome.FAILED, reason)
    assert amount in response.message
