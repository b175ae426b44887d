"""Closed forms of free rocking and of overturning; they use nothing of the solvers."""

import math

from scipy.optimize import brentq
from scipy.special import ellipk, ellipkinc

from analytic import MODELS


def quarter_period(block, theta, model="exact"):
    """Return the time [s] that a block released at rest takes to its impact."""
    law = MODELS[model].law(block.alpha, block.restitution)
    if law.linear:
        return math.acosh(law.saddle / (law.saddle - theta)) / (law.k * block.p)
    # Yim, Chopra and Penzien (1980) give it in another form
    modulus = math.cos(0.5 * (block.alpha - theta))
    angle = math.asin(math.cos(0.5 * block.alpha) / modulus)
    return float(ellipk(modulus**2) - ellipkinc(angle, modulus**2)) / block.p


def free_amplitude(block, theta, impacts):
    """Return the rotation [rad] that a released block reaches after a number of impacts."""
    lift = 2.0 * math.sin(block.alpha - 0.5 * theta) * math.sin(0.5 * theta)
    left = block.restitution ** (2 * impacts) * lift
    barrier = 2.0 * math.sin(0.5 * block.alpha) ** 2
    return block.alpha - 2.0 * math.asin(math.sqrt(0.5 * (barrier - left)))


def overturning_amplitude(omega_over_p, half_cycles):
    """Return the least amplitude over the onset that overturns a linear block with no impact."""

    def excess(log_amplitude):
        psi = math.asin(math.exp(-log_amplitude))
        wave = omega_over_p * math.sin(psi) - math.cos(psi)
        late = math.exp(-(half_cycles * math.pi - psi) / omega_over_p)
        return (wave if half_cycles == 1 else -wave) - late

    return math.exp(brentq(excess, 1e-12, math.log(1e9), xtol=1e-15, rtol=1e-15))


def overturning_velocity(block):
    """Return the sudden ground velocity [m/s] that just overturns a block at rest."""
    barrier = math.sqrt(2.0 * (1.0 - math.cos(block.alpha)))
    return 4.0 * block.R * block.p * barrier / (3.0 * math.cos(block.alpha))
