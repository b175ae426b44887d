"""Ground motions that need no data: a wavelet, near-fault pulses, filtered noise.

Each is a formula sampled into a `Record`, which is straight between its samples: of a component of
circular frequency w the interpolant misses up to (w dt)^2/8, and a peak of a response kappa times
as much, kappa being its condition number. A segment of a motion is one sine or one straight line,
which the published pulses, a sum of three sines and a Gaussian, are not.
"""

import math

import numpy as np

from analytic.checks import finite, positive
from analytic.motion import FloatArray
from analytic.record import Record

PER_CYCLE = 200
"""Default samples in a cycle of a pulse."""

MISSED = (2.0 * math.pi / PER_CYCLE) ** 2 / 8.0
"""Part of a pulse, 1.2e-4, that linear interpolation between PER_CYCLE samples misses."""

RICKER_HALF = 1.5
"""Half length of a Ricker wavelet over its period; there its acceleration is 1e-8 of the peak."""


def ricker(amplitude: float, frequency: float, *, dt: float | None = None) -> Record:
    """Return a Ricker wavelet, the second derivative of a Gaussian (Ricker 1943).

    Its acceleration is A (1 - 2 c s^2) exp(-c s^2) and its velocity A s exp(-c s^2), s being the
    time since the middle and c = (pi f)^2.

    Parameters
    ----------
    amplitude : float
        A, the acceleration [m/s2] in the middle.
    frequency : float
        f [Hz], of the maximum of its spectrum.
    dt : float, optional
        Time between samples [s]; by default PER_CYCLE in 1/f.

    Raises
    ------
    ValueError
        If a number is out of range.

    Examples
    --------
    >>> round(ricker(3.0, frequency=2.0).duration, 3)
    1.5
    """
    amplitude, frequency = finite("amplitude", amplitude), positive("frequency", frequency)
    time, dt = _times(2.0 * RICKER_HALF / frequency, frequency, dt)
    swept = (math.pi * frequency * (time - RICKER_HALF / frequency)) ** 2
    return Record(dt=dt, samples=amplitude * (1.0 - 2.0 * swept) * np.exp(-swept))


def near_fault(
    velocity: float, frequency: float, gamma: float, phase: float = 0.0, *, dt: float | None = None
) -> Record:
    """Return a near-fault pulse of Mavroeidis and Papageorgiou (2003, equation 3).

    Its velocity is A/2 [1 + cos(2 pi f s/gamma)] cos(2 pi f s + nu), abs(s) <= gamma/(2 f), s being
    the time since the middle; its acceleration, the derivative, is three sines.

    Parameters
    ----------
    velocity : float
        A [m/s], the amplitude of the envelope of the velocity.
    frequency : float
        f [Hz], of the pulse.
    gamma : float
        Number of cycles under the envelope, more than 1.
    phase : float, optional
        nu [rad].
    dt : float, optional
        Time between samples [s]; by default PER_CYCLE in 1/f.

    Raises
    ------
    ValueError
        If a number is out of range.

    Examples
    --------
    >>> round(near_fault(0.5, frequency=1.0, gamma=2.0).duration, 3)
    2.0
    """
    velocity, frequency = finite("velocity", velocity), positive("frequency", frequency)
    phase = finite("phase", phase)
    if finite("gamma", gamma) <= 1.0:
        raise ValueError(f"gamma is {gamma!r}; it must be more than 1")
    time, dt = _times(gamma / frequency, frequency, dt)
    omega = 2.0 * math.pi * frequency
    carrier = omega * (time - 0.5 * gamma / frequency)
    # the envelope's cosine times the carrier's is the mean of two cosines
    parts = ((0.5, 1.0), (0.25, 1.0 + 1.0 / gamma), (0.25, 1.0 - 1.0 / gamma))
    sines = sum(weight * k * np.sin(k * carrier + phase) for weight, k in parts)
    return Record(dt=dt, samples=-velocity * omega * np.asarray(sines))


def kanai_tajimi(
    seed: int,
    *,
    peak: float,
    duration: float = 20.0,
    omega: float = 15.0,
    damping: float = 0.6,
    rise: float = 3.0,
    fall: float = 8.0,
    dt: float = 0.01,
) -> Record:
    """Return white noise through a layer of soil, under an envelope (Kanai 1957, Tajimi 1960).

    The layer is an oscillator on a base that moves with white noise; the motion is its absolute
    acceleration, whose spectrum is (1 + 4 z^2 r^2)/((1 - r^2)^2 + 4 z^2 r^2) of the noise's with
    r = w/omega. The noise is constant between samples and the oscillator solved exactly. The
    envelope grows as the square of time until `rise`, and decays as an exponential from `fall` on
    to a hundredth at the end (Jennings, Housner and Tsai 1968). There is noise at low frequencies:
    the base ends with a velocity, which it keeps, and which no block feels.

    Parameters
    ----------
    seed : int
        Of the noise; equal seeds give equal motions.
    peak : float
        Largest absolute acceleration [m/s2], to which the motion is scaled.
    duration : float, optional
        [s].
    omega, damping : float, optional
        Circular frequency [rad/s] and damping ratio (less than 1) of the layer, by default of firm
        soil.
    rise, fall : float, optional
        Times [s] at which the envelope reaches one and leaves it.
    dt : float, optional
        Time between samples [s].

    Raises
    ------
    ValueError
        If a number is out of range.

    Examples
    --------
    >>> float(abs(kanai_tajimi(1, peak=3.0).samples).max())
    3.0
    """
    positive("peak", peak)
    duration, dt = positive("duration", duration), positive("dt", dt)
    if not 0.0 < finite("rise", rise) <= finite("fall", fall) < duration:
        raise ValueError(f"rise is {rise!r} and fall {fall!r}; 0 < rise <= fall < {duration!r}")
    time = dt * np.arange(math.ceil(duration / dt - 1e-9) + 1, dtype=np.float64)
    noise = np.random.default_rng(seed).normal(size=time.size)
    shaken = np.convolve(noise, soil_kernel(omega, damping, time))[: time.size]
    decay = np.exp(-math.log(100.0) / (duration - fall) * np.maximum(time - fall, 0.0))
    envelope = np.minimum(time / rise, 1.0) ** 2 * decay
    return Record(dt=dt, samples=shaken * envelope).scaled_to(peak)


def soil_kernel(omega: float, damping: float, time: FloatArray) -> FloatArray:
    """Return what the layer does at equal times [s] after a unit input lasting one step begins."""
    if not 0.0 < finite("damping", damping) < 1.0:
        raise ValueError(f"damping is {damping!r}; it must be between 0 and 1")
    rate = damping * positive("omega", omega)
    swing = math.sqrt(omega**2 - rate**2)
    wave = np.cos(swing * time) - rate / swing * np.sin(swing * time)
    after_a_step = 1.0 - np.exp(-rate * time) * wave
    return np.diff(after_a_step, prepend=0.0)


def _times(duration: float, frequency: float, dt: float | None) -> tuple[FloatArray, float]:
    """Return equal times [s] from zero to a duration, no further apart than dt, and their step."""
    longest = 1.0 / (PER_CYCLE * frequency) if dt is None else positive("dt", dt)
    count = math.ceil(duration / longest - 1e-9)
    return np.linspace(0.0, duration, count + 1), duration / count
