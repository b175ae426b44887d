"""Every engine under every preset, by what must hold of any engine.

What only rounding may tell apart is held to what the engine declares to compute with; the rest to
the order of the method, or to what a preset is for. With a library's defaults an engine may fail to
feel the base or to rest: that is a finding, and not asked here.
"""

import math
import os
import subprocess
import sys

import pytest
from declared import equal_to
from known import Bare
from uses import (
    BLOCK,
    CORE,
    FIXED,
    HERE,
    MIRRORED,
    SHAKEN,
    TUNED,
    TUNED_IN_FRAMES,
    USES,
    all_but_times,
    error,
    every_fixed_use,
    every_landing_use,
    every_tuned_use,
    every_use,
    held_frames,
    in_both_frames,
    noise,
    pulse,
    rocked,
    scene,
)

from analytic import simulate
from analytic.block import RigidBlock
from analytic.response import Outcome, Reason
from engines import ENGINES, FRAMES, Scene
from engines.declaration import UNTUNED, Stepping
from engines.run.drive import LAG, build, run, simulate_world
from engines.world import Pose


@pytest.mark.parametrize(("engine", "preset", "frame"), TUNED_IN_FRAMES)
def test_onset(engine, preset, frame):
    """Below g tan(alpha) nothing lifts and above it something does, or the base is not felt."""
    below, above = (
        rocked(engine, pulse(onsets, 1.0), preset=preset, frame=frame) for onsets in (0.95, 1.05)
    )
    assert (below.outcome, below.peak_ratio) == (Outcome.AT_REST, 0.0)
    assert above.outcome is Outcome.ROCKED
    assert above.peak_ratio > 0.0


@pytest.mark.parametrize(("engine", "preset"), MIRRORED)
def test_mirror(engine, preset):
    """Shaking the other way leans the block the other way."""
    times = [0.1 * i for i in range(1, 20)]
    there, back = (
        rocked(engine, pulse(onsets, 3.0, 2), preset=preset, times=times) for onsets in (1.3, -1.3)
    )
    # as it comes, a solver ends its iterations early, and visits the corners in one order
    tolerance = 1e-3 if preset in UNTUNED else equal_to(engine)
    assert there.history.theta == pytest.approx(-back.history.theta, abs=tolerance)
    assert there.peak_ratio > 0.01


@every_tuned_use
def test_rest_stays_rest(engine, preset):
    response = rocked(engine, pulse(0.5, 1.0), preset=preset, duration=5.0, times=[1.0, 5.0])
    assert response.outcome is Outcome.AT_REST
    # the contact may settle, by less than a thousandth of what would topple the block
    assert abs(response.history.theta).max() < 1e-3 * BLOCK.alpha


@every_landing_use
def test_how_a_block_lies_does_not_depend_on_the_steps(engine, preset):
    """Not up to the longest ones that the engine declares for a block at rest."""
    block, declared = RigidBlock(width=0.5, height=3.0), HERE[engine]
    asked = Scene(system=block, motion=pulse(1.2, 2.0, 1, block), preset=preset)
    dt_s, resolved = declared.preset(preset).ordinary_step_s(asked), declared.resolution(block)
    peaks = []
    for rest_factor in (1.0, resolved.rest_factor):
        world = build(declared, asked)
        try:
            within = resolved._replace(rest_factor=rest_factor)
            peaks.append(simulate_world(world, asked, dt_s, Stepping.LANDING, within).peak_ratio)
        finally:
            world.close()
    assert peaks[0] == pytest.approx(
        peaks[1], rel=max(equal_to(engine, 1e-6), declared.nuisance_sensitivity)
    )


@pytest.mark.parametrize(("engine", "preset"), in_both_frames(TUNED))
def test_frames_agree(engine, preset):
    """A moving base is the body force -m u_g'': the two differ by rounding and slip alone."""
    base, world = (rocked(engine, preset=preset, frame=frame) for frame in FRAMES)
    within = max(equal_to(engine, 1e-6), HERE[engine].nuisance_sensitivity)
    assert base.peak_ratio == pytest.approx(world.peak_ratio, rel=within)
    assert base.peak_ratio > 0.1
    assert world.observables.get(LAG, 0.0) < 1e-6


@pytest.mark.parametrize(
    ("engine", "lag_m"), [use for use in (("drake", 1e-7), ("newton", 1e-6)) if use[0] in HERE]
)
def test_a_base_that_is_led_is_where_it_should_be_as_it_comes(engine, lag_m):
    response = rocked(engine, preset="naive", frame="world")
    assert 0.0 < response.observables[LAG] < lag_m
    assert response.peak_ratio == pytest.approx(simulate(BLOCK, SHAKEN).peak_ratio, rel=0.2)
    if engine == "newton":  # of Drake's the body force makes another lean
        at_rest = rocked(engine, preset="naive", frame="base")
        assert response.peak_ratio == pytest.approx(at_rest.peak_ratio, rel=5e-3)


@pytest.mark.parametrize(
    "engine", [name for name in HERE if HERE[name].preset("naive").takes(floor="position")]
)
def test_no_way_of_moving_a_base_is_none_of_them(engine):
    with pytest.raises(ValueError, match="floor is None; it must be one of"):
        rocked(engine, preset="naive", settings={"floor": None})


@pytest.mark.parametrize(
    ("engine", "preset"),
    [
        use
        for use in USES
        if HERE[use[0]].preset(use[1]).takes(floor="position") and "world" in held_frames(*use)
    ],
)
def test_a_base_moved_by_its_place_alone_leaves_the_block_behind(engine, preset):
    """It has no velocity that friction could feel."""
    settings = {"floor": "position"}
    response = rocked(engine, preset=preset, frame="world", settings=settings)
    assert response.reason is Reason.SLID


@pytest.mark.parametrize(
    "engine", [name for name in FIXED if HERE[name].preset("fixed").takes(iterations=1)]
)
def test_iterations_that_are_asked_for_are_taken(engine):
    """Also where a preset derives them from the block."""
    peaks = [
        rocked(engine, preset="fixed", step=1e-2, settings=settings).peak_ratio
        for settings in ({}, {"iterations": 1})
    ]
    assert peaks[0] != peaks[1]


@every_fixed_use
def test_peak_without_impact(engine):
    """A peak before any impact: a fixed step is of first order only where the uplift falls in a
    step, at most p dt late, which at the cube root of the excess is a part 1e-3 of the peak."""
    assert error(engine, pulse(1.3, 2.0), preset="fixed") < 1e-3


@every_fixed_use
def test_first_order(engine):
    """A quarter of the step makes about a quarter of the error, in the mean over cases whose
    impacts fall anywhere in their steps."""
    motions = [pulse(1.3, 3.0 + 0.13 * i, 2) for i in range(8)]
    coarse, fine = (
        sum(error(engine, motion, preset="fixed", step=step) for motion in motions)
        for step in (4e-3, 1e-3)
    )
    assert 0.6 < math.log(coarse / fine, 4.0) < 1.6


@pytest.mark.parametrize("engine", CORE)
def test_naive_is_worse_than_fixed(engine):
    motions = [pulse(1.3, omega, 2) for omega in (2.5, 3.0, 3.5, 4.0)]
    naive, fixed = (
        max(error(engine, motion, preset=preset) for motion in motions)
        for preset in ("naive", "fixed")
    )
    assert fixed < 0.2 * naive


@every_fixed_use
def test_impacts_and_rest(engine):
    """A squat block rocks, loses its speed by Housner's ratio at each impact, and comes to rest."""
    block = RigidBlock(width=1.0, height=1.5)
    motion = pulse(1.5, 3.0, 1, block)
    exact = simulate(block, motion, duration=6.0)
    response = rocked(engine, motion, system=block, preset="fixed", duration=6.0)
    assert response.outcome is Outcome.ROCKED
    assert len(response.uplifts) == len(response.rests) == 1
    # the time of rest is the sum of a geometric series whose ratio carries the error of the step
    assert response.rests[0] == pytest.approx(exact.rests[0], abs=0.05)
    for seen, true in zip(response.impacts[:3], exact.impacts, strict=False):
        assert seen.time == pytest.approx(true.time, abs=0.01)
        assert seen.ratio == pytest.approx(block.restitution, abs=0.02)


@every_use
def test_overturning(engine, preset):
    """A history ends with the response."""
    response = rocked(engine, pulse(2.0, 0.5), preset=preset, times=[0.1, 0.5, 1e3])
    assert response.outcome is Outcome.OVERTURNED
    assert response.crossed
    assert response.peak_ratio == math.inf
    assert list(response.history.time) == [0.1, 0.5]


@every_fixed_use
def test_crossed_is_not_overturned(engine):
    """The second half of a pulse brings back a block that the first took past alpha."""
    motion = pulse(3.5, 3.0, 2)
    exact = simulate(BLOCK, motion)
    assert (exact.outcome, exact.crossed) == (Outcome.ROCKED, True)
    response = rocked(engine, motion, preset="fixed")
    assert (response.outcome, response.crossed) == (Outcome.ROCKED, True)
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-2)


LEAVING = [name for name in FIXED if HERE[name].preset("fixed").takes(planar=False)]
"""Engines that hold a block in the plane, and can let it leave it."""


@pytest.mark.parametrize("engine", LEAVING)
def test_geometry_can_be_put_back(engine):
    """Four corners in space move as two in the plane do."""
    plane, space = (
        rocked(engine, pulse(1.3, 2.0), preset="fixed", settings=settings)
        for settings in ({}, {"planar": False})
    )
    assert space.peak_ratio == pytest.approx(plane.peak_ratio, rel=1e-3 + equal_to(engine))
    assert space.peak_ratio != plane.peak_ratio


@every_fixed_use
def test_history(engine):
    """Samples stand where the exact ones do, within the first-order error of one impact, which is
    1e-2 alpha or what 20 p dt come to, and within what its velocity lacks for being made of rounded
    places.

    That impact falls anywhere in its step, so that its velocity is off by p dt times the
    acceleration over p times the velocity: a few p dt = 5e-4, doubled in the energy of the peak.
    """
    times = [0.05 * i for i in range(60)]
    response = rocked(engine, preset="fixed", duration=3.0, times=times)
    exact = simulate(BLOCK, SHAKEN, duration=3.0, times=times)
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=2e-2)
    assert response.impacts[0].time == pytest.approx(exact.impacts[0].time, abs=0.01)
    assert response.history.time == pytest.approx(times)
    step = HERE[engine].preset("fixed").step
    allowed = max(1e-2, 20.0 * step) + noise(engine, step)
    assert response.history.theta == pytest.approx(exact.history.theta, abs=allowed * BLOCK.alpha)


@every_use
def test_repeats_bit_by_bit(engine, preset):
    """Whatever was simulated in between, in whichever process."""
    asked = scene(preset=preset, times=[0.1 * i for i in range(10)])
    first = all_but_times(run(engine, asked))
    rocked(engine, pulse(1.5, 1.0), system=RigidBlock(width=2.0, height=3.0))
    assert all_but_times(run(engine, asked)) == first


@every_tuned_use
def test_a_sliding_block_is_no_rocking_block(engine, preset):
    response = rocked(engine, pulse(1.3, 1.0), preset=preset, friction=0.05)
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.SLID)
    assert math.isnan(response.peak_ratio)


@every_fixed_use
@pytest.mark.parametrize("limit", [{"time_limit_s": 1e-6}, {"max_steps": 9}])
def test_limits(engine, limit):
    response = rocked(engine, pulse(1.3, 1.0), preset="fixed", **limit)
    assert (response.outcome, response.reason) == (Outcome.FAILED, Reason.UNDECIDED)
    assert f"{next(iter(limit.values()))}" in response.message


def test_too_stiff_a_contact_is_a_failure():
    """k dt^2 = 1e6 corrects a penetration a million times over."""
    response = rocked("mujoco", pulse(1.3, 1.0), preset="fixed", settings={"stiffness": 1e6})
    assert response.reason is Reason.THROWN


def test_a_silent_reset_is_a_failure(tmp_path, monkeypatch):
    """MuJoCo puts a state that is not a number back to its start and goes on."""
    monkeypatch.chdir(str(tmp_path))
    motion = scene(pulse(1.3, 1.0), preset="fixed")
    world = build(ENGINES["mujoco"], motion)
    world._data.qpos[2] = math.nan
    response = simulate_world(world, motion, 1e-3, Stepping.FIXED)
    world.close()
    assert response.outcome is Outcome.FAILED
    assert "BADQPOS" in response.message
    assert not list(tmp_path.iterdir())


class Lost(Bare):
    """A world that hands out what a broken engine might."""

    def __init__(self, pose):
        self.pose = pose

    def state(self):
        return [self.pose]


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
    response = simulate_world(Lost(pose), scene(pulse(1.3, 1.0)), 1e-3)
    assert (response.outcome, response.reason) == (Outcome.FAILED, reason)
    assert amount in response.message


def test_settings_are_read_back(monkeypatch):
    """A library that takes a setting and does not keep it makes a failed response."""
    library = pytest.importorskip("pybullet")
    change = library.changeDynamics

    def forgetful(*body, **asked):
        return change(*body, **{**asked, "lateralFriction": 0.5})

    monkeypatch.setattr(library, "changeDynamics", forgetful)
    response = rocked("pybullet", preset="fixed")
    assert response.reason is Reason.FAULT
    assert response.message == "friction of the block was set to 10.0 but reads 0.5"


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"frame": "moon"}, "frame is 'moon'; it must be one of base, world"),
        ({"density": -1.0}, "density is -1.0; it must be positive"),
        ({"step": 0.0}, "step is 0.0; it must be positive"),
        ({"duration": 0.1}, "duration is 0.1; it must be at least the motion's"),
        ({"times": [1.0, 0.5]}, "they must increase"),
    ],
)
def test_a_scene_refuses_what_is_not_allowed(options, message):
    with pytest.raises(ValueError, match=message):
        scene(pulse(1.3, 1.0), **options)


@every_use
def test_a_setting_that_there_is_not_is_refused(engine, preset):
    with pytest.raises(ValueError, match="setting is 'bounce'; it must be one of"):
        rocked(engine, preset=preset, settings={"bounce": 1})


@pytest.mark.parametrize("engine", HERE)
def test_a_preset_that_there_is_not_is_refused(engine):
    with pytest.raises(ValueError, match=f"preset of {engine} is 'best'; it must be one of"):
        rocked(engine, preset="best")


def test_an_engine_or_geometry_that_there_is_not_is_refused():
    with pytest.raises(ValueError, match="engine is 'ode'; it must be one of pybullet, mujoco"):
        rocked("ode")
    for engine in CORE:
        with pytest.raises(ValueError, match="geometry is 'ball'; it must be one of box, corners"):
            rocked(engine, settings={"geometry": "ball"})


@pytest.mark.parametrize("engine", HERE)
def test_an_engine_is_imported_when_named_and_says_nothing(engine):
    own = {HERE[engine].library, "numpy", *HERE[engine].packages}  # it may be built on another
    libraries = {other.library for other in ENGINES.values()} - {"numpy"}
    script = (
        "import sys, engines\n"
        "from engines.run.drive import run\n"
        "from analytic.block import RigidBlock\n"
        "from analytic.motion import SinePulse\n"
        "assert all(engine.presets for engine in engines.ENGINES.values())\n"
        f"assert not {libraries!r} & set(sys.modules)\n"
        "block = RigidBlock(width=0.5, height=1.5)\n"
        "scene = engines.Scene(system=block, motion=SinePulse(amplitude=4.0, omega=20.0))\n"
        f"run({engine!r}, scene)\n"
        f"assert not {libraries - own!r} & set(sys.modules)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", script],
        capture_output=True,
        check=False,
        env={**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)},
    )
    assert (done.returncode, done.stdout, done.stderr) == (0, b"", b"")
