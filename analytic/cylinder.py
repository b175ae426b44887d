"""The rolling cylinder: steady rolling on a rim, the centre at rest (Euler's disk and its kin).

The equations are in EQUATIONS.md, "The rolling cylinder".
"""

import math
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from analytic.block import GRAVITY
from analytic.checks import measurable
from analytic.motion import FloatArray

COMPLEX_STEP = 1e-30
"""Imaginary part whose square no digit holds: a derivative by it is exact to rounding."""


class Rolling(NamedTuple):
    """States at n times: axis (n, 3), foot (n, 3) [m], rates (n, 3) [rad/s], turned (n, 3, 3).

    axis is the unit vector from the lower to the upper face; foot the point on the rim that touches
    the base, from the point below the centre; rates the angular velocity; turned the rotation of
    the body from upright. The vertical is the third component.
    """

    axis: FloatArray
    foot: FloatArray
    rates: FloatArray
    turned: FloatArray


@dataclass(frozen=True, slots=True, kw_only=True)
class RollingCylinder:
    """A homogeneous cylinder that rolls steadily on its rim, without sliding, about its own centre.

    The centre is at rest, and no friction is needed: axis and foot turn about the vertical at
    `precession`, and the cylinder about its axis by `spin` less.

    Parameters
    ----------
    radius, height : float
        a, and the full dimension 2h [m].
    tilt : float
        Angle beta of the axis to the vertical [rad], where its lower face stands on the rim.
    gravity : float, optional
        g [m/s2].

    Raises
    ------
    ValueError
        If a number is not positive and finite, or no steady rolling has that tilt.

    Examples
    --------
    >>> cylinder = RollingCylinder(radius=0.3, height=1.0, tilt=0.2)
    >>> round(cylinder.precession, 4), round(cylinder.spin, 4)
    (10.4033, -6.7512)
    """

    radius: float
    height: float
    tilt: float
    gravity: float = GRAVITY

    def __post_init__(self) -> None:
        for name in ("radius", "height", "tilt", "gravity"):
            object.__setattr__(self, name, measurable(name, getattr(self, name)))
        if not self.tilt < 0.5 * math.pi:
            raise ValueError(f"tilt is {self.tilt!r}; it must be below pi/2")
        moment, asked = self._balance()
        if not moment * asked > 0.0:
            low, high = self._limits()
            allowed = f"below {low!r} or above {high!r} rad: none rolls steadily between"
            raise ValueError(f"tilt is {self.tilt!r}; it must be {allowed}")

    @property
    def precession(self) -> float:
        """Omega [rad/s], of axis and foot about the vertical.

        Omega^2 = g (a cos b - h sin b)/[sin b (A cos b - C (h/a) sin b)], A and C over the mass.
        """
        moment, asked = self._balance()
        return math.sqrt(moment / asked)

    @property
    def spin(self) -> float:
        """Rate about the axis beside the precession [rad/s], -Omega (cos b - (h/a) sin b)."""
        flat = 0.5 * self.height / self.radius * math.sin(self.tilt)
        return -self.precession * (math.cos(self.tilt) - flat)

    @property
    def turn(self) -> float:
        """Time [s] of a turn of the foot about the centre."""
        return 2.0 * math.pi / self.precession

    @property
    def centre_height(self) -> float:
        """Height of the centre [m], a sin b + h cos b."""
        return self.radius * math.sin(self.tilt) + 0.5 * self.height * math.cos(self.tilt)

    @property
    def energy(self) -> float:
        """Energy over the mass [m2/s2], of height and turning."""
        across, along = self._moments
        rate = self.precession * math.sin(self.tilt)
        lengthwise = 0.5 * self.height / self.radius * rate
        turning = 0.5 * (across * rate**2 + along * lengthwise**2)
        return self.gravity * self.centre_height + turning

    def at(self, times: ArrayLike) -> Rolling:
        """Return the states at times [s]; at 0 the axis leans to +x, where the foot is."""
        t = np.atleast_1d(np.asarray(times, dtype=np.float64))
        phase, zero, one = self.precession * t, np.zeros(t.size), np.ones(t.size)
        c, s = math.cos(self.tilt), math.sin(self.tilt)
        across = np.stack((np.cos(phase), np.sin(phase), zero), axis=1)
        up = np.stack((zero, zero, one), axis=1)
        axis = s * across + c * up
        # up along the lower face, away from the foot
        slope = -c * across + s * up
        foot = -0.5 * self.height * axis - self.radius * slope
        foot[:, 2] = 0.0
        rates = self.precession * up + self.spin * axis
        lean = np.array([[c, 0.0, s], [0.0, 1.0, 0.0], [-s, 0.0, c]])
        turned = _about_z(phase) @ lean @ _about_z(self.spin * t)
        return Rolling(axis, foot, rates, turned)

    @property
    def wobble(self) -> float:
        """Squared frequency [rad2/s2] at which a disturbed tilt swings while the cylinder rolls.

        Positive: the steady motion is stable, but for a lasting change to one beside it. Negative:
        a disturbance grows by exp(sqrt(-wobble) t) while it is small.
        """
        tilt, lean, nod, turn = self._linearized
        # with beta' = -q, p' = P q and r' = R q: q'' = (-Q_beta + Q_p P + Q_r R) q
        return float(tilt[2] - lean[2] * nod[1] - turn[2] * nod[3])

    def growth(self, time: float) -> tuple[float, float]:
        """Return what small disturbances of the rolling motion become in a time [s].

        Of disturbances whose tilt [rad] and rates over `precession` have squares that sum to one:
        the largest change of the tilt, and of the phase, both [rad]. The latter grows with time
        where the motion is stable, too: the tilt of a steady motion near by goes with its rate.
        """
        from scipy.linalg import expm  # takes longer to import than to use

        rate, c, s = self.precession, math.cos(self.tilt), math.sin(self.tilt)
        flow = np.zeros((5, 5))
        flow[:4, :4] = self._linearized.T
        # the phase's own rate is p / sin(beta)
        flow[4, :2] = -rate * c / s, 1.0 / s
        scale = np.array([1.0, rate, rate, rate])
        become = expm(flow * time)[:, :4] * scale
        return float(np.linalg.norm(become[0])), float(np.linalg.norm(become[4]))

    @property
    def p(self) -> float:
        """Frequency parameter [rad/s] as it rocks on its rim, sqrt(m g R/I) as of a block.

        R is the distance from the centre to the rim, I the moment of inertia about its tangent.
        """
        square = self.radius**2 + 0.25 * self.height**2
        return math.sqrt(self.gravity * math.sqrt(square) / (self._moments[0] + square))

    @property
    def _linearized(self) -> FloatArray:
        """Derivatives of `rolling_rates` by each of (beta, p, q, r), a row each, as it rolls."""
        rate = self.precession * math.sin(self.tilt)
        steady = np.array([self.tilt, rate, 0.0, 0.5 * self.height / self.radius * rate])
        by = [rolling_rates(self, steady + 1j * COMPLEX_STEP * row).imag for row in np.eye(4)]
        return np.array(by) / COMPLEX_STEP

    @property
    def _moments(self) -> tuple[float, float]:
        """A, C over the mass [m2]."""
        square = self.radius**2
        return 0.25 * square + self.height**2 / 12.0, 0.5 * square

    def _balance(self) -> tuple[float, float]:
        """Return the moment of the weight, and the one asked for by a unit precession, over m."""
        across, along = self._moments
        h, c, s = 0.5 * self.height, math.cos(self.tilt), math.sin(self.tilt)
        moment = self.gravity * (self.radius * c - h * s)
        return moment, s * (across * c - along * h / self.radius * s)

    def _limits(self) -> tuple[float, float]:
        """Return the tilts [rad] at which the two parts of the balance vanish, in order."""
        across, along = self._moments
        slender = 2.0 * self.radius / self.height
        low, high = sorted((1.0, across / along))
        return math.atan(slender * low), math.atan(slender * high)


def rolling_rates(cylinder: RollingCylinder, state: NDArray[Any]) -> NDArray[Any]:
    """Return the derivatives of (beta, p, q, r) of a cylinder that rolls without sliding.

    In axes that turn with the foot: 1 up along the lower face, 3 along the axis; p, q, r are the
    angular velocity in them, and beta' = -q. About the foot c, with V = c x w the centre's rate
    and n = (p, q, p cot(beta)) that of the axes,

        I w' + n x I w = c x [c x w' + n x V + g Z].
    """
    beta, w = state[0], state[1:]
    across, along = cylinder._moments
    inertia = np.diag([across, across, along])
    foot = np.array([-cylinder.radius, 0.0, -0.5 * cylinder.height])
    up = np.array([np.sin(beta), 0.0, np.cos(beta)])
    axes = np.array([w[0], w[1], w[0] / np.tan(beta)])
    arm = np.cross(foot, np.eye(3)).T
    load = np.cross(axes, np.cross(foot, w)) + cylinder.gravity * up
    forced = np.cross(foot, load) - np.cross(axes, inertia @ w)
    return np.concatenate(([-w[1]], np.linalg.solve(inertia - arm @ arm, forced)))


def _about_z(angle: FloatArray) -> FloatArray:
    """Return the rotations (n, 3, 3) by angles [rad] about the third axis."""
    turned = np.zeros((angle.size, 3, 3))
    turned[:, 0, 0] = turned[:, 1, 1] = np.cos(angle)
    turned[:, 1, 0] = np.sin(angle)
    turned[:, 0, 1] = -turned[:, 1, 0]
    turned[:, 2, 2] = 1.0
    return turned
