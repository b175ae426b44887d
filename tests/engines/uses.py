"""Every engine under every preset, and what may be asked of it by what it declares."""

from dataclasses import asdict

import pytest
from declared import held_to
from given import BLOCK, pulse

from analytic import Outcome, simulate
from engines import ENGINES, FRAMES, Scene, core_engines
from engines.declaration import UNTUNED, Stepping
from engines.disclosure import Deviation
from engines.run.drive import run
from engines.world import ROUNDINGS
from studies.cases.paper import sweep_cases

SHAKEN = pulse(1.3, 3.0, 2)
"""A pulse under which the block is struck once before its peak."""
HERE = {name: engine for name, engine in ENGINES.items() if engine.installed}
CORE = [name for name in core_engines() if name in HERE]
WITH_BULLET = pytest.mark.skipif("pybullet" not in HERE, reason="it has no wheel for this Python")
USES = [(name, use.name) for name, engine in HERE.items() for use in engine.presets]
TUNED = [(name, preset) for name, preset in USES if preset not in UNTUNED]
FIXED = [name for name, preset in USES if preset == "fixed"]
LANDING = [use for use in USES if HERE[use[0]].preset(use[1]).stepping is Stepping.LANDING]


def scene(motion=SHAKEN, **options):
    return Scene(**{"system": BLOCK, "motion": motion, **options})


def held_frames(engine, preset):
    """Return the frames in which a preset can hold the base, as its engine declares."""
    declared = HERE[engine]
    asked = ((frame, scene(frame=frame)) for frame in declared.frames)
    return [frame for frame, posed in asked if not declared.lacks(posed, declared.preset(preset))]


TUNED_IN_FRAMES = [(*use, frame) for use in TUNED for frame in held_frames(*use)]
MIRRORED = [pytest.param(*use, marks=held_to(Deviation.MIRROR, *use)) for use in USES]

every_use = pytest.mark.parametrize(("engine", "preset"), USES)
every_tuned_use = pytest.mark.parametrize(("engine", "preset"), TUNED)
every_fixed_use = pytest.mark.parametrize("engine", FIXED)
every_landing_use = pytest.mark.parametrize(("engine", "preset"), LANDING)


def in_both_frames(uses):
    """Return the uses whose base can also move in the world."""
    return [use for use in uses if set(FRAMES) <= set(held_frames(*use))]


def noise(engine, step):
    """Return the part of an impact's velocity, some p H/10, that is a rounding of a block's place.

    Over a step of p dt such a rounding is a velocity.
    """
    return ROUNDINGS * HERE[engine].precision.value / (0.1 * step)


def speed_band(engine):
    """Return within what landing steps meet a closed form for the velocity of an impact.

    It is extrapolated over three rows by up to two steps, which adds up to 17 times their errors.
    """
    return max(band(engine), 17.0 * max(noise(engine, 5e-3), HERE[engine].nuisance_sensitivity))


def band(engine):
    """Return within what landing steps at the default accuracy, p dt = 5e-3, meet a closed form.

    Core engines are of second order, (p dt)^2 = 2.5e-5 times a factor of a few; of others it is
    asked that no impact falls inside an ordinary step, which would cost some p dt, or what an
    engine declares as its sensitivity.
    """
    return 1e-4 if engine in core_engines() else max(1e-3, HERE[engine].nuisance_sensitivity)


def rocked(engine, motion=SHAKEN, **options):
    """Return what an engine makes of a scene of the block."""
    return run(engine, scene(motion, **options))


def error(engine, motion=SHAKEN, **options):
    """Return by which part an engine's peak misses the exact one."""
    posed = scene(motion, **options)
    exact = simulate(posed.system, motion, start=posed.start)
    return abs(run(engine, posed).peak_ratio / exact.peak_ratio - 1.0)


def errors_of_sweep(engine, every, **options):
    """Return the errors of the peaks of the survivors of the sweep, outcomes having agreed."""
    errors = []
    for case in [*sweep_cases([6, 7, 8, 9])][every // 2 :: every]:
        exact = simulate(case.block, case.motion)
        response = rocked(engine, case.motion, system=case.block, **options)
        assert response.outcome is exact.outcome, (case, response.message)
        if exact.outcome is Outcome.ROCKED:
            errors.append(abs(response.peak_ratio / exact.peak_ratio - 1.0))
    return errors


def all_but_times(response):
    """Return all fields to the last bit, apart from run times and what took the steps."""
    found = asdict(response)
    history = found.pop("history")
    kept = [] if history is None else [part for part in history.values() if part is not None]
    parts = [part.tolist() for part in kept]
    return repr({**found, "wall_s": 0.0, "setup_s": 0.0, "driver": ""}) + repr(parts)
