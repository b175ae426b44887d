"""When a motion can lift a block, the loads of a timetable, and how its base moves in a step."""

import math

import numpy as np
import pytest

from analytic import Record, SinePulse
from engines.run.ground import mean_velocity_of
from engines.run.steps import loads_of

WANDERING = Record(dt=0.3, samples=[1.0, -2.0, 0.5, 3.0, 3.0, -1.0, 0.25])


@pytest.mark.parametrize("excess", [1e-9, 0.1, 5.0])
def test_loads_are_found_however_short(excess):
    pulse = SinePulse(amplitude=1.0 + excess, omega=3.0, half_cycles=5)
    loads = loads_of(pulse, 1.0)
    level = math.asin(1.0 / (1.0 + excess))
    begins = [(k * math.pi + level) / 3.0 for k in range(5)]
    ends = [((k + 1) * math.pi - level) / 3.0 for k in range(5)]
    # near a crest the time of a crossing is known to the root of the rounding only
    assert [load.begin for load in loads] == pytest.approx(begins, rel=1e-7)
    assert [load.end for load in loads] == pytest.approx(ends, rel=1e-7)
    assert [load.side for load in loads] == [-1.0, 1.0, -1.0, 1.0, -1.0]


def test_a_motion_below_the_onset_loads_nothing_however_long():
    pulse = SinePulse(amplitude=0.999, omega=1e-6, half_cycles=2)
    assert loads_of(pulse, 1.0) == []


def test_the_mean_velocity_of_the_base_is_its_displacement_over_time():
    """Also over steps longer than a sample, past both ends, from corner to corner."""
    mean_velocity = mean_velocity_of(WANDERING.segments())
    draw = np.random.default_rng(4)
    for begin, finish in [*np.sort(draw.uniform(0, 2.5, (40, 2))).tolist(), (0.0, 1.8), (0.3, 0.6)]:
        moved = WANDERING.displacement(finish) - WANDERING.displacement(begin)
        expected = float(moved) / (finish - begin)
        assert mean_velocity(begin, finish) == pytest.approx(expected, abs=1e-12)


def test_loads_are_where_the_acceleration_exceeds_the_onset():
    loads = loads_of(WANDERING, 1.2)
    grid = np.linspace(0, WANDERING.duration, 20_001)
    beyond = np.abs(WANDERING.acceleration(grid)) > 1.2
    inside = np.zeros_like(beyond)
    for load in loads:
        inside |= (grid > load.begin) & (grid < load.end)
        sign = -math.copysign(1.0, float(WANDERING.acceleration(0.5 * (load.begin + load.end))))
        assert load.side == sign
    assert (beyond == inside).all()
