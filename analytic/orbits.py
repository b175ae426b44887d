"""Symmetric orbits of Housner's linearization under sustained harmonic shaking (Hogan 1989).

In units of alpha and 1/p the block between two impacts follows x'' = x - s - beta cos(w t + phase).
On a symmetric (1, n) orbit, n odd, an impact comes after every n half periods of the shaking, and
each swing is the mirror image of the one before.
"""

import math

from analytic.checks import positive


def orbit_limits(restitution: float, omega_over_p: float, n: int) -> tuple[float, float]:
    """Return the amplitudes between which a symmetric (1, n) orbit exists and is stable.

    Parameters
    ----------
    restitution : float
        Ratio r of the velocities after and before an impact, between 0 and 1.
    omega_over_p : float
        w.
    n : int
        Half periods of the shaking in a swing, odd.

    Returns
    -------
    birth, loss : float
        Amplitudes over alpha g: the orbit exists from `birth` on (Hogan's beta_plus), and at `loss`
        (his beta_minus) it gives way to asymmetric ones.

    Raises
    ------
    ValueError
        If a number is out of range.

    Notes
    -----
    A swing of the duration T = n pi/w must bring x from 0 to 0 and its rate from v to -v/r. That
    leaves (1 - r) tanh(T/2) = C [(1 - r) w sin(phase) - (1 + r) cos(phase) coth(T/2)] with
    C = beta/(1 + w^2): a phase exists where the amplitude of the right is enough. Of the map from
    one impact to the mirrored next, the determinant is r^2; the orbit is stable until one of its
    eigenvalues is -1, where 1 + trace + r^2 = 0.
    """
    from scipy.optimize import brentq

    w = positive("omega_over_p", omega_over_p)
    if not 0.0 < restitution < 1.0:
        raise ValueError(f"restitution is {restitution!r}; it must be between 0 and 1")
    if n < 1 or n % 2 == 0:
        raise ValueError(f"n is {n!r}; it must be odd and positive")
    rise = math.tanh(0.5 * n * math.pi / w)
    along, across = (1.0 - restitution) * w, (1.0 + restitution) / rise
    birth = (1.0 + w * w) * (1.0 - restitution) * rise / math.hypot(along, across)

    def stability(beta: float) -> float:
        # rounding would put a beta at the birth below it
        sine = min(birth / beta, 1.0)
        phase = math.atan2(across, along) + math.pi - math.asin(sine)
        return 1.0 + restitution**2 + _trace(beta, restitution, w, n, phase)

    high = 2.0 * birth
    while stability(high) > 0.0:
        high *= 2.0
    return birth, float(brentq(stability, birth, high, xtol=1e-14, rtol=1e-14))


def _trace(beta: float, r: float, w: float, n: int, phase: float) -> float:
    """Return the trace of the map (phase, v) -> (phase, v) from one impact to the next."""
    swing = n * math.pi / w
    c, s = (beta / (1.0 + w * w) * part for part in (math.cos(phase), math.sin(phase)))
    grown, rising = math.cosh(swing), math.sinh(swing)
    # x = 1 + a cosh t + b sinh t + C cos(w t + phase); the shaking is mirrored at the end
    a, b = -1.0 - c, (grown - 1.0 + c * (1.0 + grown)) / rising
    rate = a * rising + b * grown + w * s
    bend = a * grown + b * rising + w * w * c
    by_phase = s * grown + w * c * rising + s
    return float(1.0 - w * by_phase / rate - r * (grown - bend * rising / rate))
