"""What landing steps do with hints that are false, and which hints are refused."""

import math

import pytest
from uses import BLOCK, pulse

from analytic import simulate
from engines import Scene, core_engines
from engines.hints import TRUE, Hints
from engines.run.drive import run

every_core_engine = pytest.mark.parametrize("engine", core_engines())

FALSE_HINTS = [
    Hints(onset=0.8),
    Hints(onset=1.2),
    Hints(swapped=True),
    Hints(fall=0.5),
    Hints(fall=2.0),
]


@every_core_engine
@pytest.mark.parametrize("hints", FALSE_HINTS, ids=str)
def test_false_hints_choose_other_steps_and_not_what_happens(engine, hints):
    """A block that lifts where nothing was expected lifts within a step, p dt = 5e-3 late, of which
    the peak feels the square. One that was expected to lift and does not may lean into a contact
    that has been made ready to let go of it, by less than what it could ever show."""
    motion = pulse(1.3, 3.0, 2)
    exact = simulate(BLOCK, motion)
    true, misled = (run(engine, Scene(system=BLOCK, motion=motion, hints=h)) for h in (TRUE, hints))
    assert misled.peak_ratio == pytest.approx(exact.peak_ratio, rel=1e-3)
    assert len(misled.impacts) == len(exact.impacts)
    if hints.onset != 1.0:
        assert misled.steps != true.steps
        assert abs(misled.peak_ratio - exact.peak_ratio) > abs(true.peak_ratio - exact.peak_ratio)
    calm = run(engine, Scene(system=BLOCK, motion=pulse(0.9, 3.0, 2), hints=hints))
    assert calm.peak_ratio < 1e-3


@every_core_engine
def test_fixed_steps_take_no_hints(engine):
    motion = pulse(1.3, 3.0, 2)
    peaks = {
        run(
            engine, Scene(system=BLOCK, motion=motion, preset="fixed", step=5e-3, hints=h)
        ).peak_ratio
        for h in (TRUE, *FALSE_HINTS)
    }
    assert len(peaks) == 1


@pytest.mark.parametrize(("name", "value"), [("onset", 0.0), ("onset", math.nan), ("fall", -1.0)])
def test_hints_that_make_no_sense_are_refused(name, value):
    with pytest.raises(ValueError, match=f"{name} is .*; it must be"):
        Hints(**{name: value})
