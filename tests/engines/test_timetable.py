"""When a motion can lift a block: the loads of a timetable."""

import math

import pytest

from analytic.motion import SinePulse
from engines.run.timetable import loads_of


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
