"""Checks of arguments: each returns a float, or raises ValueError with one clear line."""

import math

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
