"""Frames: what an engine needs for them concerns nothing that stands alone."""

from dataclasses import replace

import pytest

from analytic import RigidBlock, RockingFrame, SinePulse, simulate
from engines import ENGINES
from engines.declaration import Engine
from engines.layouts import Ability
from engines.mujoco.settings import STACKED, TUNED
from engines.mujoco.stacks import softened
from engines.registry import OWN
from engines.run.drive import run
from engines.scene import Scene
from studies.cases.drawn import RandomFrame
from studies.kit.identity import Makers
from studies.kit.jobs import Job, ask, summary

STACKERS = ("pybullet", "box2d", "dart")
HARD = {
    "a light beam, which lets go": (3.373, 9.294, 3, 0.6203, 3.198, 5, 0.578),
    "one that lets go between impacts": (3.153, 0.07137, 4, 0.9501, 4.923, 5, 0.3667),
    "a heavy one, whose load wanders": (1.988, 2.015, 4, 1.2365, 4.134, 3, 9.546),
}
"""Values of `RandomFrame`, from aspect on: what makes them hard for a contact in equal steps."""
PULSE = SinePulse.in_g(0.5, omega=9.0, half_cycles=2)
UNSPLIT = 2e-4
"""Relative error of a peak; where contacts above and below close in different steps it is 0.1."""


def test_those_that_hold_stacks_by_code_of_their_own():
    def apart(name, preset):
        engine = ENGINES[name]
        return engine.builder((Ability.SEVERAL, Ability.STACKED), preset) is not engine.build

    best = {name for name in OWN if apart(name, ENGINES[name].best)}
    fixed = {name for name in OWN if apart(name, ENGINES[name].preset("fixed"))}
    assert (best, fixed) == ({"box2d", "dart", "newton"}, {"mujoco", "newton"})


@pytest.mark.parametrize("name", STACKERS)
@pytest.mark.parametrize(("columns", "load"), [(2, 4.0), (3, 0.5)])
def test_columns_and_beam_land_together(name, columns, load):
    if not ENGINES[name].installed:
        pytest.skip(f"{name} is not installed")
    frame = RockingFrame(width=0.5, height=1.5, columns=columns, load=load)
    exact = simulate(frame, PULSE)
    job = Job(labels={}, block=frame, motion=PULSE, source=name)
    found = ask(job, job.asked)
    assert (found.outcome, len(found.impacts)) == (exact.outcome, len(exact.impacts))
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=UNSPLIT)
    assert found.observables["parting"] < 1e-4
    assert found.message == ""


@pytest.mark.skipif(not ENGINES["newton"].installed, reason="Newton is not installed")
@pytest.mark.parametrize("preset", ["naive", "fixed"])
def test_a_frame_in_newton_lifts_rocks_and_stays_whole(preset):
    frame = RockingFrame(width=0.5, height=1.5, columns=2, load=0.5)
    job = Job(labels={}, block=frame, motion=PULSE, source=f"newton:{preset}")
    found = ask(job, job.asked)
    assert found.outcome is simulate(frame, PULSE).outcome, found.message
    assert found.observables["parting"] < 0.1
    assert found.observables["tilt"] < 0.02


@pytest.mark.parametrize("name", STACKERS)
def test_a_single_block_knows_nothing_of_it(name, monkeypatch):
    frame = RockingFrame(width=0.5, height=1.5, columns=2, load=2.0)
    block = RigidBlock(width=0.5, height=1.5)
    posed = ((frame, "landing"), (frame, "fixed"), (block, "landing"))
    jobs = [Job(labels={}, block=it, motion=PULSE, source=f"{name}:{p}") for it, p in posed]
    made = [Makers(ask, summary).of(job) for job in jobs]
    own = f"engines/{name}/stacks.py"
    assert [own in maker for maker in made] == [name != "pybullet", False, False]
    whole = Engine.preset

    def preset(engine, called):
        found = whole(engine, called)
        return replace(found, stacked={"friction": 5.0}) if called == "landing" else found

    monkeypatch.setattr(Engine, "preset", preset)
    changed = [Makers(ask, summary).of(job) != maker for job, maker in zip(jobs, made, strict=True)]
    assert changed == [True, False, False]


@pytest.mark.parametrize("hard", HARD.values(), ids=HARD)
def test_columns_keep_to_their_beam_in_mujoco(hard):
    """A top that lets go makes columns part by a tenth and more of alpha, where three can."""
    names = ("aspect", "width_m", "half_cycles", "amplitude_g", "omega_over_p", "columns", "load")
    case = RandomFrame(case=0, **dict(zip(names, hard, strict=True)))
    found = run("mujoco", Scene(system=case.block, motion=case.motion, preset="fixed"))
    assert found.observables["parting"] < 1e-6
    assert found.peak_ratio == pytest.approx(simulate(case.block, case.motion).peak_ratio, rel=5e-3)


@pytest.mark.parametrize("aspect", [1.2, 3.0, 12.0])
def test_a_soft_surface_is_in_proportion_to_what_lifts_a_pivot(aspect):
    system = RockingFrame(width=0.5, height=0.5 * aspect, columns=3, load=2.0)
    scene, s = Scene(system=system, motion=PULSE), replace(TUNED, **STACKED)
    surface, whole, *_ = softened(scene, s).impedance
    depth = STACKED["soft_surface"] / (1.0 + aspect**2)
    assert softened(scene, s).soft_surface == pytest.approx(depth, rel=1e-12)
    assert (1.0 - surface) / surface == pytest.approx(depth, rel=1e-12)
    assert whole == TUNED.impedance[1]
    firm = replace(s, impedance=(0.1, *TUNED.impedance[1:]))
    assert softened(scene, firm).impedance[0] == 0.1
    assert softened(scene, TUNED) is TUNED


def test_blocks_and_frames_that_land_in_mujoco_know_nothing_of_it():
    frame = RockingFrame(width=0.5, height=1.5, columns=2, load=2.0)
    block = RigidBlock(width=0.5, height=1.5)
    posed = ((frame, "fixed"), (frame, "landing"), (frame, "naive"), (block, "fixed"))
    jobs = [Job(labels={}, block=it, motion=PULSE, source=f"mujoco:{p}") for it, p in posed]
    made = [Makers(ask, summary).of(job) for job in jobs]
    assert ["engines/mujoco/stacks.py" in maker for maker in made] == [True, False, False, False]
