"""Closed-form criteria: free rocking, and the ground motions that overturn a block.

They use nothing of the solvers, and so are checks on them.
"""

import math

import numpy as np

from analytic.block import RigidBlock
from analytic.checks import finite, positive
from analytic.frame import Rocker
from analytic.models import find_model


def quarter_period(block: Rocker, theta: float, model: str = "exact") -> float:
    """Return the time [s] that a block released at rest takes to its impact.

    Linear models: acosh(c/(c - theta))/k, the exact one by elliptic integrals (Housner 1963 gives
    the first; Yim, Chopra and Penzien 1980 the second in another form). ValueError unless theta is
    between 0 and the rotation at which the model's block overturns.
    """
    from scipy.special import ellipk, ellipkinc

    law = find_model(model).law(block.alpha, block.restitution)
    theta = finite("theta", theta)
    if not 0.0 < theta < law.saddle:
        raise ValueError(f"theta is {theta!r}; it must be between 0 and {law.saddle}")
    if law.linear:
        return math.acosh(law.saddle / (law.saddle - theta)) / (law.k * block.p)
    modulus = math.cos(0.5 * (block.alpha - theta))
    angle = math.asin(math.cos(0.5 * block.alpha) / modulus)
    return float(ellipk(modulus**2) - ellipkinc(angle, modulus**2)) / block.p


def free_amplitude(block: Rocker, theta: float, impacts: int) -> float:
    """Return the rotation [rad] that a released block reaches after a number of impacts.

    The exact model's energy: cos(alpha - theta_n) = cos alpha + eta^2n [cos(alpha - theta) - cos
    alpha], in a form that keeps the digits of small rotations.
    """
    theta = finite("theta", theta)
    lift = 2.0 * math.sin(block.alpha - 0.5 * theta) * math.sin(0.5 * theta)
    left = block.restitution ** (2 * impacts) * lift
    barrier = 2.0 * math.sin(0.5 * block.alpha) ** 2
    return block.alpha - 2.0 * math.asin(math.sqrt(0.5 * (barrier - left)))


def frictionless_fall(block: RigidBlock, theta: float) -> tuple[float, float]:
    """Return the time [s] and the rate [rad/s] at which a frictionless block strikes its base.

    It is released on one corner, which slides: the centre of mass falls straight down. With
    z = R cos(alpha - theta) its height, energy gives theta'^2 (B^2 + H^2)/12 + z'^2 = 2 g (z0 - z),
    and the time is a quadrature, substituted so that the release is regular. ValueError unless
    theta is between 0 and alpha, from where the block falls back.
    """
    from scipy.integrate import quad

    theta = finite("theta", theta)
    if not 0.0 < theta < block.alpha:
        raise ValueError(f"theta is {theta!r}; it must be between 0 and {block.alpha}")
    gyration = (block.width**2 + block.height**2) / 12.0

    def slowness(root: float) -> float:
        """Return d time/d root at theta - root^2, whose rate is root times a regular function."""
        turned = root * root
        # z0 - z over root^2, as a product of sines
        mean = math.sin(block.alpha - theta + 0.5 * turned)
        fallen = 2.0 * block.R * mean * 0.5 * np.sinc(0.5 * turned / math.pi)
        lever = block.R * math.sin(block.alpha - theta + turned)
        return 2.0 * math.sqrt((gyration + lever * lever) / (2.0 * block.gravity * fallen))

    end = math.sqrt(theta)
    time, _ = quad(slowness, 0.0, end, epsabs=0.0, epsrel=1e-13)
    return float(time), 2.0 * end / slowness(end)


def overturning_amplitude(omega_over_p: float, half_cycles: int = 1) -> float:
    """Return the least amplitude, over the onset, that overturns without an impact.

    Half-sine: (omega/p) sin psi - cos psi = exp(-(p/omega)(pi - psi)); full-sine:
    cos psi - (omega/p) sin psi = exp(-(p/omega)(2 pi - psi)); sin psi = onset/amplitude. Housner
    (1963) drops the exponential, which is not on the safe side. ValueError unless half_cycles is 1
    or 2, and where no amplitude below 1e9 onsets overturns the block so.
    """
    from scipy.optimize import brentq

    if half_cycles not in (1, 2):
        raise ValueError(f"half_cycles is {half_cycles!r}; it must be 1 or 2")
    omega_over_p = positive("omega_over_p", omega_over_p)
    sign = 1.0 if half_cycles == 1 else -1.0

    def excess(log_amplitude: float) -> float:
        psi = math.asin(math.exp(-log_amplitude))
        wave = omega_over_p * math.sin(psi) - math.cos(psi)
        return sign * wave - math.exp(-(half_cycles * math.pi - psi) / omega_over_p)

    low, high = 1e-12, math.log(1e9)
    if excess(low) * excess(high) > 0.0:
        raise ValueError(f"omega_over_p is {omega_over_p!r}; no amplitude overturns the block so")
    return math.exp(brentq(excess, low, high, xtol=1e-15, rtol=1e-15))


def overturning_velocity(block: RigidBlock) -> float:
    """Return the sudden ground velocity [m/s] that just overturns a block at rest (exact).

    4 R p sqrt(2 (1 - cos alpha)) / (3 cos alpha), from the angular momentum about the pivot.
    """
    barrier = math.sqrt(2.0 * (1.0 - math.cos(block.alpha)))
    return 4.0 * block.R * block.p * barrier / (3.0 * math.cos(block.alpha))
