"""Frames in steps that land: what an engine needs for them concerns nothing that stands alone."""

from dataclasses import replace

import pytest

from analytic import RigidBlock, RockingFrame, SinePulse, simulate
from engines import ENGINES
from engines.declaration import Engine
from engines.layouts import Ability
from engines.registry import OWN
from studies.kit.identity import Makers
from studies.kit.jobs import Job, ask, summary

STACKERS = ("pybullet", "box2d", "dart")
PULSE = SinePulse.in_g(0.5, omega=9.0, half_cycles=2)
UNSPLIT = 2e-4
"""Relative error of a peak; where contacts above and below close in different steps it is 0.1."""


def test_those_that_hold_stacks_by_code_of_their_own():
    def apart(name, preset):
        engine = ENGINES[name]
        return engine.builder((Ability.SEVERAL, Ability.STACKED), preset) is not engine.build

    best = {name for name in OWN if apart(name, ENGINES[name].best)}
    fixed = {name for name in OWN if apart(name, ENGINES[name].preset("fixed"))}
    assert (best, fixed) == ({"box2d", "dart", "newton"}, {"newton"})


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
