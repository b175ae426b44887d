"""What the contact of a block on a cart must bear in its exact response."""

from typing import NamedTuple

import numpy as np

from analytic.cart import CartBlock
from analytic.motion import FloatArray, Motion
from analytic.response import History
from analytic.simulate import simulate
from analytic.start import REST


class CartDemands(NamedTuple):
    """What an exact response needs to be one.

    friction is the largest abs(horizontal)/normal force, normal the smallest normal force over the
    weight; nan where the block does not rock.
    """

    friction: float
    normal: float


def cart_demands(
    cart: CartBlock,
    motion: Motion,
    start: tuple[float, float] = REST,
    *,
    duration: float,
    samples: int = 4001,
) -> CartDemands:
    """Return what the contact of a block on a cart must bear, until it leans by twice alpha.

    Parameters
    ----------
    cart, motion, start, duration
        As in `simulate`.
    samples : int, optional
        How many times are looked at, at equal distances.

    Examples
    --------
    >>> cart = CartBlock(width=0.5, height=1.5, mass_ratio=0.5)
    >>> pulse = SinePulse.in_g(0.6, omega=20.0, half_cycles=2)
    >>> needs = cart_demands(cart, pulse, duration=1.0)
    >>> round(needs.friction, 2), round(needs.normal, 2)
    (0.42, 0.65)
    """
    times = np.linspace(0.0, duration, samples)
    history = simulate(cart, motion, start=start, duration=duration, times=times).history
    if history is None or history.base is None:
        return CartDemands(np.nan, np.nan)
    along, normal = _accelerations(cart, motion, history, history.base[0])
    rocks = (history.theta != 0.0) & (np.abs(history.theta) < 2.0 * cart.alpha)
    if not rocks.any():
        return CartDemands(np.nan, np.nan)
    pressed = np.where(normal > 0.0, normal, np.nan)
    friction = np.nanmax((np.abs(along) / pressed)[rocks])
    return CartDemands(float(friction), float(normal[rocks].min() / cart.gravity))


def _accelerations(
    cart: CartBlock, motion: Motion, history: History, place: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Return accelerations of the block's centre [m/s2]: along x, and upwards plus gravity."""
    g, part, r, rate = cart.gravity, cart.mass_ratio, cart.R, history.velocity
    side, z = np.sign(history.theta), cart.alpha - np.abs(history.theta)
    sine, cosine = np.sin(z), np.cos(z)
    pushed = motion.acceleration(history.time) - cart.stiffness * place
    # momentum of both, and of the block about its corner: x'' + part (r cos z theta')' = pushed,
    # 4/3 r theta'' + cos z x'' + s g sin z = 0
    given = pushed + side * part * sine * (0.75 * g * cosine - r * rate**2)
    base = given / (1.0 - 0.75 * part * cosine**2)
    turning = -0.75 * (side * g * sine + cosine * base)  # r theta''
    along = base + cosine * turning + side * r * sine * rate**2
    up = side * sine * turning - r * cosine * rate**2
    return along, g + up
