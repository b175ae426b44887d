"""MuJoCo's rollout: what it answers beside the stepping loops, and what it says of a failure."""

import math
from dataclasses import replace

import pytest
from declared import announced
from uses import BLOCK, all_but_times, pulse, rocked, scene

from analytic import Outcome, RigidBlock, RockingFrame
from engines import registry
from engines.declaration import AT_REST, RECOMMENDED
from engines.run.batch import alike, run_together
from engines.run.drive import run

pytest.importorskip("mujoco")
NAME = "mujoco-rollout"
FRAME = RockingFrame(width=0.5, height=1.5, columns=2, load=2.0)
WIDE = RigidBlock(width=0.8, height=1.5)
MOTIONS = [pulse(onsets, 3.0, 2) for onsets in (0.8, 1.3, 1.45, 1.9)]


@pytest.fixture(autouse=True)
def _announced():
    with announced(NAME, "engines.mujoco.rollout:ENGINE"):
        yield


def both(scenes):
    """Return what rollouts and single runs of MuJoCo answer."""
    assert len({alike(registry.ENGINES[NAME], each) for each in scenes} - {None}) == 1
    together = run_together(NAME, scenes)
    assert {response.driver for response in together} == {"rollout"}
    return together, [run("mujoco", each) for each in scenes]


@pytest.mark.parametrize("preset", ["naive", RECOMMENDED])
def test_a_moving_base_is_rolled_out_to_the_bit(preset):
    """Where gravity alone is made a force, nothing is rounded otherwise."""
    scenes = [scene(motion, preset=preset) for motion in MOTIONS]
    scenes.append(scene(MOTIONS[1], system=WIDE, preset=preset, duration=4.0, times=[0.1, 2.0]))
    together, alone = both(scenes)
    assert [*map(all_but_times, together)] == [*map(all_but_times, alone)]
    assert Outcome.ROCKED in {response.outcome for response in alone}


@pytest.mark.parametrize(
    "options",
    [
        {"preset": AT_REST},
        {"preset": AT_REST, "start": (0.4 * BLOCK.alpha, 0.1)},
        {"preset": "fixed", "step": 1e-3, "system": FRAME},
    ],
)
def test_a_body_force_is_rolled_out_but_for_last_digits(options):
    together, alone = both([scene(motion, **options) for motion in MOTIONS])
    for found, expected in zip(together, alone, strict=True):
        assert (found.outcome, found.steps) == (expected.outcome, expected.steps)
        assert found.peak_ratio == pytest.approx(expected.peak_ratio, rel=1e-12)


@pytest.mark.parametrize("settings", [{}, {"geometry": "box", "planar": False}])
def test_a_tuned_contact_is_rolled_out_as_near_as_its_own_rounding_lets_it(settings):
    """Until an impact to 1e-12; then by no more than what one rounding of the pulse does."""
    posed = [scene(motion, preset="fixed", step=1e-3, settings=settings) for motion in MOTIONS]
    together, alone = both(posed)
    assert [each.outcome for each in together] == [each.outcome for each in alone]
    for each, found, expected in zip(posed, together, alone, strict=True):
        ulp = replace(each.motion, amplitude=math.nextafter(each.motion.amplitude, math.inf))
        other = run("mujoco", replace(each, motion=ulp)).peak_ratio
        if expected.outcome is Outcome.ROCKED:
            allowed = 10.0 * abs(other / expected.peak_ratio - 1.0) + 1e-12
            assert abs(found.peak_ratio / expected.peak_ratio - 1.0) < allowed < 1e-8
            assert found.uplifts[0] == pytest.approx(expected.uplifts[0], rel=1e-12)


def test_what_is_set_anew_each_step_cannot_be_rolled_out():
    for options in ({"frame": "world"}, {"settings": {"reflection": True}}):
        asked = scene(preset="fixed", **options)
        with pytest.raises(ValueError, match="set anew each step cannot be rolled out"):
            run_together(NAME, [asked])
    assert alike(registry.ENGINES[NAME], scene(preset="fixed")) is not None
    assert (
        alike(registry.ENGINES[NAME], scene(settings={"friction": 0.3}, time_limit_s=9.0)) is None
    )


def test_a_world_that_the_library_warns_of_is_a_failure_among_good_ones():
    thrown = {"start": (0.1, 1e12)}
    scenes = [scene(motion, preset="fixed", step=5e-3) for motion in MOTIONS]
    scenes[1] = replace(scenes[1], **thrown)
    together, alone = both(scenes)
    assert alone[1].outcome is Outcome.FAILED
    assert [each.outcome for each in together] == [each.outcome for each in alone]
    assert together[1].message == alone[1].message == "MuJoCo warned: BADQVEL"
    assert together[1].steps < alone[1].steps  # where it failed, not where that was asked
    peaks = [[each.peak_ratio for each in found[2:]] for found in (together, alone)]
    assert peaks[0] == pytest.approx(peaks[1], rel=1e-8)


def test_it_answers_alone_as_mujoco_does():
    assert all_but_times(rocked(NAME, preset="naive")) == all_but_times(
        rocked("mujoco", preset="naive")
    )
