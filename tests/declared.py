"""What tests ask of an engine, by what it declares."""

from contextlib import contextmanager

import pytest

from engines import ENGINES, registry
from engines.world import ROUNDINGS
from studies.sources import registry as sources

STEPS_ADD_UP = 1e4
"""Steps over whose roundings the errors of two runs may add up that should be equal."""


def held_to(miss, engine, preset):
    """Return the marks of a test that must fail where a preset declares to miss what it asks."""
    missed = miss in ENGINES[engine].preset(preset).deviations
    return [pytest.mark.xfail(strict=True, reason=miss.value)] if missed else []


def equal_to(engine, exactly=1e-9):
    """Return within what two numbers agree that only the engine's rounding may tell apart."""
    return max(exactly, STEPS_ADD_UP * ENGINES[engine].precision.value)


def rounding(engine):
    """Return within what a number comes back that an engine was given."""
    return max(1e-12, ROUNDINGS * ENGINES[engine].precision.value)


@contextmanager
def announced(name, place):
    """Make an engine known for a while, to this process and to those that it starts."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(registry.FURTHER, f"{name}={place}")
        registry._places.cache_clear()
        patch.setitem(sources.SOURCES, name, sources._engine(name, ENGINES[name].best.name))
        yield
    registry._places.cache_clear()
