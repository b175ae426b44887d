"""Synthetic ground motions, and what must hold of every ground motion."""

import math

import numpy as np
import pytest
from given import BLOCK, FULL_SINE
from scipy.integrate import quad
from scipy.signal import cont2discrete, lfilter, welch

from analytic import (
    Delayed,
    Record,
    SinePulse,
    kanai_tajimi,
    near_fault,
    ricker,
    simulate,
)
from analytic.synthetic import MISSED, soil_kernel

MOTIONS = {
    "half sine": SinePulse(amplitude=3.0, omega=5.0),
    "sines": SinePulse(amplitude=-2.0, omega=9.0, half_cycles=5),
    "cosine": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=2, phase=0.5 * math.pi),
    "phase below 0": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=6, phase=-1.0),
    "phase beyond pi": SinePulse(amplitude=-3.0, omega=5.0, half_cycles=3, phase=4.0),
    "after a rest": Delayed(FULL_SINE, 1.25),
    "record": Record(dt=0.3, samples=[1.0, -2.0, 0.5, 3.0, 3.0, -1.0, 0.25]),
    "ricker": ricker(4.0, 2.0, dt=0.02),
    "near-fault": near_fault(0.6, 1.2, 1.7, 0.8, dt=0.05),
    "noise": kanai_tajimi(3, peak=5.0, duration=1.2, rise=0.3, fall=0.5, dt=0.05),
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


def test_rickers_velocity_is_its_closed_form():
    """The trapezoidal rule over 200 steps in a period, its error being (2 pi/200)^2/12."""
    wavelet = ricker(4.0, 2.0)
    times = np.array(wavelet.breakpoints)
    s = times - 0.75
    expected = 4.0 * s * np.exp(-((2 * math.pi * s) ** 2))
    assert wavelet.velocity(times) == pytest.approx(expected, abs=2e-4 * np.abs(expected).max())
    assert wavelet.peak == pytest.approx(4.0, rel=1e-12)
    assert abs(wavelet.samples[0]) < 1e-7


@pytest.mark.parametrize(("gamma", "phase"), [(1.3, 0.0), (2.0, 1.1), (3.4, -2.0)])
def test_near_fault_velocity_is_the_published_one(gamma, phase):
    pulse = near_fault(0.7, 1.6, gamma, phase)
    times = np.array(pulse.breakpoints)
    s = times - 0.5 * gamma / 1.6
    envelope = 0.35 * (1 + np.cos(2 * math.pi * 1.6 * s / gamma))
    expected = envelope * np.cos(2 * math.pi * 1.6 * s + phase)
    # the trapezoidal rule misses (w dt)^2/12 of each sine, with w up to 1.8 times the carrier's
    assert pulse.velocity(times) == pytest.approx(expected, abs=5e-4)
    assert pulse.duration == pytest.approx(gamma / 1.6)
    assert pulse.acceleration([0, pulse.duration]) == pytest.approx([0, 0], abs=1e-9)


@pytest.mark.parametrize(
    "make",
    [
        lambda size, dt: ricker(5.0 * size, 2.0, dt=dt),
        lambda size, dt: near_fault(0.5 * size, 1.6, 1.8, 0.5, dt=dt),
    ],
    ids=["ricker", "near-fault"],
)
def test_default_samples_cost_a_peak_what_they_miss_times_its_condition(make):
    """The stated error, and its order: half the step leaves a quarter of it."""

    def peak(step, size=1.0):
        return math.log(simulate(BLOCK, make(size, step)).peak_ratio)

    default = make(1.0, None).dt
    fine = default / 40.0
    kappa = (peak(fine, 1.0 + 1e-5) - peak(fine)) / 1e-5
    errors = [abs(peak(default / part) - peak(fine)) for part in (1, 2)]
    assert 0.3 * MISSED < errors[0] / kappa < 1.05 * MISSED
    assert errors[0] / errors[1] == pytest.approx(4.0, rel=0.02)


def test_noise_is_the_seeds():
    one, again, other = (kanai_tajimi(seed, peak=2.0) for seed in (1, 1, 2))
    assert one == again
    assert one != other
    assert one.peak == pytest.approx(2.0, rel=1e-15)
    assert one.duration == pytest.approx(20.0)
    assert one.samples[0] == 0


def test_the_soil_is_scipys_discrete_filter():
    omega, damping, dt = 15.0, 0.6, 0.02
    a, b = 2 * damping * omega, omega**2
    numerator, denominator, _ = cont2discrete(([a, b], [1.0, a, b]), dt, method="zoh")
    impulse = np.zeros(300)
    impulse[0] = 1.0
    expected = lfilter(np.ravel(numerator), denominator, impulse)
    assert soil_kernel(omega, damping, dt * np.arange(300)) == pytest.approx(expected, abs=1e-12)


def test_the_spectrum_is_kanais_and_tajimis():
    """The mean of 60 periodograms, over bands of frequency, at an eighth of the sampling rate and
    below, where the noise that is constant over a step has its spectrum flat to 5 %."""
    omega, damping, dt = 15.0, 0.5, 0.01
    kernel = soil_kernel(omega, damping, dt * np.arange(1500))
    draw = np.random.default_rng(0)
    shaken = np.convolve(draw.normal(size=200_000), kernel)[2000:200_000]
    frequency, power = welch(shaken, 1 / dt, nperseg=2048)
    r = 2 * math.pi * frequency / omega
    expected = (1 + (2 * damping * r) ** 2) / ((1 - r**2) ** 2 + (2 * damping * r) ** 2)
    bands = np.array_split(np.flatnonzero((frequency > 0.2) & (frequency < 12.5)), 12)
    ratio = [power[band].mean() / (2 * dt * expected[band].mean()) for band in bands]
    assert ratio == pytest.approx(np.ones(12), abs=0.12)
