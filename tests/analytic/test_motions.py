"""What must hold of every ground motion."""

import math

import numpy as np
import pytest
from given import FULL_SINE
from scipy.integrate import quad

from analytic import Delayed, Record, SinePulse

MOTIONS = {
    "half sine": SinePulse(amplitude=3.0, omega=5.0),
    "sines": SinePulse(amplitude=-2.0, omega=9.0, half_cycles=5),
    "cosine": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=2, phase=0.5 * math.pi),
    "phase below 0": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=6, phase=-1.0),
    "phase beyond pi": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=3, phase=4.0),
    "after a rest": Delayed(FULL_SINE, 1.25),
    "record": Record(dt=0.3, samples=[1.0, -2.0, 0.5, 3.0, 3.0, -1.0, 0.25]),
}


@pytest.fixture(params=MOTIONS)
def motion(request):
    return MOTIONS[request.param]


def test_it_starts_and_ends_with_its_breakpoints(motion):
    assert motion.breakpoints[0] == 0
    assert motion.breakpoints[-1] == motion.duration
    assert all(np.diff(motion.breakpoints) > 0)
    assert motion.acceleration([-1e-9, motion.duration + 1e-9]).tolist() == [0, 0]


def test_velocity_and_displacement_are_the_integrals(motion):
    times = np.linspace(0, 1.3 * motion.duration, 6)[1:]
    for t in times:
        inside = [b for b in motion.breakpoints if 0 < b < t]
        options = {"points": inside or None, "limit": 400, "epsabs": 1e-13}
        velocity, _ = quad(motion.acceleration, 0, t, **options)
        displacement, _ = quad(motion.velocity, 0, t, **options)
        assert motion.velocity(t) == pytest.approx(velocity, abs=1e-11)
        assert motion.displacement(t) == pytest.approx(displacement, abs=1e-11)


def test_its_segments_are_its_acceleration(motion):
    rows = motion.segments()
    assert rows[0, 0] == 0
    assert rows[-1, 1] == motion.duration
    assert (rows[1:, 0] == rows[:-1, 1]).all()
    for start, end, amplitude, omega, phase, offset, slope in rows:
        since = np.linspace(0.001, 0.999, 7) * (end - start)
        expected = amplitude * np.sin(omega * since + phase) + offset + slope * since
        assert motion.acceleration(start + since) == pytest.approx(expected, abs=1e-12)
