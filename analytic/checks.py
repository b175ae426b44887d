"""Checks of arguments: each returns a float, or raises ValueError with one clear line."""

import math
from collections.abc import Callable

LEAST, MOST = 1e-150, 1e150
"""Range of lengths, frequencies and accelerations: floating point holds their squares and ratios,
and the ratios of those."""
MOST_HALF_CYCLES = 10**15
"""Half cycles that floating point counts."""


def finite(name: str, value: float) -> float:
    """Return the value of an argument unless it is no finite number."""
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value!r}; it must be a finite number")
    return number


def positive(name: str, value: float) -> float:
    """Return the value of an argument unless it is not positive and finite."""
    number = finite(name, value)
    if number <= 0.0:
        raise ValueError(f"{name} is {value!r}; it must be positive")
    return number


def measurable(name: str, value: float) -> float:
    """Return the value of an argument unless it is not positive, from LEAST to MOST."""
    positive(name, value)
    return within(name, value, LEAST, MOST)


def within(name: str, value: float, least: float, most: float) -> float:
    """Return the value of an argument unless it is not in a range."""
    number = finite(name, value)
    if not least <= number <= most:
        raise ValueError(f"{name} is {value!r}; it must be from {least:g} to {most:g}")
    return number


def sized(name: str, value: float, least: float = LEAST) -> float:
    """Return the value of an argument unless it is not 0, nor of a size from the least to MOST."""
    number = finite(name, value)
    if number != 0.0 and not least <= abs(number) <= MOST:
        raise ValueError(f"{name} is {value!r}; it must be 0, or of a size {least:.3g} to {MOST:g}")
    return number


TILT = ("theta", "rate", "theta [rad] and theta' [rad/s]")
PLACE = ("x", "x'", "x [m] and x' [m/s]")
"""What the two numbers of a start are called, of what rocks and of what slides."""


def start_of(
    start: tuple[float, float], called: tuple[str, str, str] = TILT, least: float = LEAST
) -> tuple[float, float]:
    """Return both numbers of a start unless one is not `sized`, the first from the least on."""
    name, rate, words = called
    try:
        first, second = start
    except (TypeError, ValueError):
        raise ValueError(f"start is {start!r}; it must be {words}") from None
    return sized(f"{name} of the start", first, least), sized(f"{rate} of the start", second)


def check_tilt(theta: float, rate: float, balance: float, still: Callable[[], bool]) -> None:
    """Refuse a start on the block's side, or in balance where nothing moves, if all is still."""
    if abs(theta) >= 0.5 * math.pi:
        raise ValueError(f"theta of the start is {theta!r}; it must be between -pi/2 and pi/2 rad")
    if abs(theta) == balance and rate == 0.0 and still():
        words = "it must not be the unstable equilibrium where nothing moves"
        raise ValueError(f"start is {(theta, rate)!r}; {words}")


def whole(name: str, value: float, most: int) -> int:
    """Return the value of an argument unless it is no whole number from 1 to the most."""
    number = positive(name, value)
    if number > most or number != int(number):
        raise ValueError(f"{name} is {value!r}; it must be a whole number from 1 to {most:g}")
    return int(number)


def finite_result(what: str, value: float, cause: str) -> None:
    """Refuse arguments, named as their cause, from which something follows that is not finite."""
    if not math.isfinite(value):
        raise ValueError(f"{cause}; {what}, which follows as {value!r}, must be finite")
