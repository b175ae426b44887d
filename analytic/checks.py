"""Checks of arguments: each returns the value as a float or raises with one clear line."""

import math


def finite(name: str, value: float) -> float:
    """Return `value` as a float; raise ValueError unless it is a finite number."""
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value!r}; it must be a finite number")
    return number


def positive(name: str, value: float) -> float:
    """Return `value` as a float; raise ValueError unless it is positive and finite."""
    number = finite(name, value)
    if number <= 0.0:
        raise ValueError(f"{name} is {value!r}; it must be positive")
    return number
