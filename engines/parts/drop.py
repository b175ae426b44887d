"""A sphere dropped on a base: what a library makes of a coefficient of restitution."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

from analytic.checks import positive

AHEAD = 20
"""Whole steps from the start to the step of the impact."""

SHOWN = 0.6
"""The coefficient for which settings are quoted."""

PATIENCE_S, PATIENCE_STEPS = 0.1, 100
"""Time [s] and steps within which a sphere must come off the base again; else it does not."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Drop:
    """A sphere that falls on a base.

    Attributes
    ----------
    restitution : float
        Speed after over before that is wanted, from 0 to 1.
    speed : float
        With which it sets out downwards [m/s].
    radius : float
        [m].
    dt_s : float
        Step [s].
    gravity : float
        [m/s2].
    phase : float
        Part of a step after which the sphere, were there no weight, meets the base.

    Raises
    ------
    ValueError
        If a value is not allowed.
    """

    restitution: float
    speed: float = 1.0
    radius: float = 0.1
    dt_s: float = 1e-3
    gravity: float = 9.81
    phase: float = 0.5

    def __post_init__(self) -> None:
        if not 0.0 <= self.restitution <= 1.0:
            raise ValueError(f"restitution is {self.restitution!r}; it must be from 0 to 1")
        for name in ("speed", "radius", "dt_s", "gravity"):
            positive(name, getattr(self, name))

    @property
    def height(self) -> float:
        """Gap [m] from which it sets out."""
        return (AHEAD + self.phase) * self.speed * self.dt_s

    @property
    def mass(self) -> float:
        """Its mass at 1000 kg/m3 [kg]."""
        return 4000.0 / 3.0 * math.pi * self.radius**3


@dataclass(frozen=True, slots=True, kw_only=True)
class Bouncing:
    """One way to ask a library for a coefficient of restitution.

    Attributes
    ----------
    name : str
    setting : callable
        ``(drop) -> str``: what is set, in the library's words.
    dropped : callable
        ``(drop) -> float``: the speed after over before an impact that comes out; nan where the
        library says that it went wrong.
    block : callable or None
        ``(restitution) -> settings``: the same for a rocking block, in place of those of the
        preset "fixed"; None where that is not tried.
    """

    name: str
    setting: Callable[[Drop], str]
    dropped: Callable[[Drop], float]
    block: Callable[[float], Mapping[str, Any]] | None = None


def rebound(drop: Drop, step: Callable[[], tuple[float, float]]) -> float:
    """Return the speed after over before the first impact; 0 if the sphere stays on the base.

    Parameters
    ----------
    drop : Drop
    step : callable
        Takes a step; returns the gap [m] and the velocity upwards [m/s].
    """
    energy = drop.speed**2 + 2.0 * drop.gravity * drop.height
    for _ in range(math.ceil(PATIENCE_S / drop.dt_s) + PATIENCE_STEPS):
        gap, velocity = step()
        if gap > 0.0 and velocity > 0.0:
            return math.sqrt((velocity**2 + 2.0 * drop.gravity * gap) / energy)
    return 0.0
