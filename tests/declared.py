"""What tests ask of an engine, by what it declares."""

from enum import Enum

import pytest

from engines import ENGINES
from engines.run.run import run as run_use
from engines.world import ROUNDINGS

STEPS_ADD_UP = 1e4
"""Steps over whose roundings the errors of two runs may add up that should be equal."""


class Miss(Enum):
    """What an engine gets wrong with its defaults, without a word."""

    MIRROR = "shaken the other way, the block does not answer the other way"
    PEAK = "on one of the paper's histories another outcome, or a peak off by more than 0.3"
    SLEEP = "a block that stood still for two seconds sleeps on while it is shaken"
    RECORD = "under an accelerogram the rotation is off by more than 0.6 of its peak"


MISSED = {
    Miss.MIRROR: (
        *("pymunk:default", "pymunk:default-at-rest", "pymunk:recommended"),
        *("box2d:default", "box2d:default-at-rest", "box2d:recommended"),
        *("rapier:default", "rapier:default-at-rest", "rapier:recommended", "rapier:pasted"),
        *("physx:default", "physx:default-at-rest", "drake:default"),
    ),
    Miss.PEAK: (
        *("box2d:default", "box2d:default-at-rest", "box2d:recommended", "rapier:default"),
    ),
    Miss.RECORD: (*("pymunk:default-at-rest", "box2d:default-at-rest", "rapier:default-at-rest"),),
    Miss.SLEEP: ("box2d:default-at-rest", "dart:default", "rapier:default-at-rest"),
}
"""What is missed -> the sources that miss it: all are presets of the libraries' own."""

NUISANCE = {"rapier": 6e-3, "drake": 2e-4, "physx": 6e-3}
"""Engine -> part by which the peak of its best preset was seen to move when what should not matter
was changed a little: the radius of its corners, the steps over which it corrects a depth."""


def run(engine, scene):
    """Return what an engine, by its name or declaration, makes of a scene."""
    declared = ENGINES[engine] if isinstance(engine, str) else engine
    return run_use(declared.use(scene))


def held_to(miss, engine, preset):
    """Return the marks of a test that must fail where a preset is known to miss what it asks."""
    missed = f"{engine}:{preset}" in MISSED[miss]
    return [pytest.mark.xfail(strict=True, reason=miss.value)] if missed else []


def equal_to(engine, exactly=1e-9):
    """Return within what two numbers agree that only the engine's rounding may tell apart."""
    return max(exactly, STEPS_ADD_UP * ENGINES[engine].precision.value)


def rounding(engine):
    """Return within what a number comes back that an engine was given."""
    return max(1e-12, ROUNDINGS * ENGINES[engine].precision.value)
