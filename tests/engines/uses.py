"""Every engine under every preset, and what may be asked of it by what it declares."""

from dataclasses import replace

import pytest
from declared import NUISANCE, Miss, held_to, run
from given import BLOCK, pulse

from analytic import Outcome, simulate
from engines import ENGINES, FRAMES, Scene, core_engines
from engines.declaration import UNTUNED, Stepping
from engines.run.look import Monitor
from engines.world import ROUNDINGS, Moment
from studies.cases.paper import sweep_cases

SHAKEN = pulse(1.3, 3.0, 2)
"""A pulse under which the block is struck once before its peak."""
HERE = {name: engine for name, engine in ENGINES.items() if engine.installed}
CORE = [name for name in core_engines() if name in HERE]
USES = [(name, use.name) for name, engine in HERE.items() for use in engine.presets]
TUNED = [(name, preset) for name, preset in USES if preset not in UNTUNED]
FIXED = [name for name, preset in USES if preset == "tuned"]
LANDING = [use for use in USES if HERE[use[0]].preset(use[1]).stepping is Stepping.LANDING]


def scene(motion=SHAKEN, **options):
    return Scene(**{"system": BLOCK, "motion": motion, **options})


def held_frames(engine, preset):
    """Return the frames in which a preset can hold the base, as its engine declares."""
    declared = HERE[engine]
    asked = ((frame, scene(frame=frame, preset=preset)) for frame in declared.frames)
    return [frame for frame, posed in asked if not declared.use(posed).lacking]


BOTH_FRAMES = [use for use in TUNED if set(FRAMES) <= set(held_frames(*use))]
TUNED_IN_FRAMES = [(*use, frame) for use in TUNED for frame in held_frames(*use)]
MIRRORED = [pytest.param(*use, marks=held_to(Miss.MIRROR, *use)) for use in USES]

every_use = pytest.mark.parametrize(("engine", "preset"), USES)
every_tuned_use = pytest.mark.parametrize(("engine", "preset"), TUNED)
every_fixed_use = pytest.mark.parametrize("engine", FIXED)
every_landing_use = pytest.mark.parametrize(("engine", "preset"), LANDING)


def speed_band(engine):
    """Return within what landing steps meet a closed form for the velocity of an impact.

    Extrapolation over three rows adds up 17 times their errors, and roundings over p dt = 5e-3.
    """
    noise = ROUNDINGS * HERE[engine].precision.value / (0.1 * 5e-3)
    return max(band(engine), 17.0 * max(noise, NUISANCE.get(engine, 0.0)))


def band(engine):
    """Return within what landing steps at the default accuracy, p dt = 5e-3, meet a closed form.

    Core engines are of second order, (p dt)^2 = 2.5e-5; of others no more is asked than that no
    impact falls inside an ordinary step.
    """
    return 1e-4 if engine in core_engines() else max(1e-3, NUISANCE.get(engine, 0.0))


def rocked(engine, motion=SHAKEN, **options):
    """Return what an engine makes of a scene of the block."""
    return run(engine, scene(motion, **options))


def both(engine, motion=SHAKEN, **options):
    """Return the exact response of a scene, and what an engine makes of it."""
    posed = scene(motion, **options)
    shared = {"start": posed.start, "duration": posed.duration, "times": posed.times}
    return simulate(posed.system, motion, **shared), run(engine, posed)


def agreed(engine, motion=SHAKEN, **options):
    """Return both, whose outcomes agree."""
    exact, found = both(engine, motion, **options)
    assert found.outcome is exact.outcome, (options, found.message)
    return exact, found


def error(engine, motion=SHAKEN, **options):
    """Return by which part an engine's peak misses the exact one."""
    exact, found = both(engine, motion, **options)
    return abs(found.peak_ratio / exact.peak_ratio - 1.0)


def errors_of_sweep(engine, every, **options):
    """Return the errors of the peaks of the sweep's survivors, of one width if all are asked."""
    cases = [*sweep_cases([6, 7, 8, 9])][every // 2 :: every]
    if every == 1:
        cases = [case for case in cases if case.width_m == 1.0]
    pairs = [agreed(engine, case.motion, system=case.block, **options) for case in cases]
    survived = [pair for pair in pairs if pair[0].outcome is Outcome.ROCKED]
    return [abs(found.peak_ratio / exact.peak_ratio - 1.0) for exact, found in survived]


def take_a_step(world, posed, engine):
    """Take the first of the steps that a fixed preset takes in a scene; return it."""
    use = HERE[engine].use(replace(posed, preset="tuned"))
    monitor = Monitor(use.scene, use.dt_s, Stepping.FIXED, Moment.MIDDLE, use.resolution)
    monitor.make_room(1)
    step = monitor.next(world.state())
    world.step(step)
    return step
