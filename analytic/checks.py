"""Checks of arguments: each returns the value as a float or raises with one clear line."""

import math

LEAST, MOST = 1e-150, 1e150
"""Range of lengths, frequencies and accelerations: floating point holds their squares and ratios,
and the ratios of those."""
MOST_HALF_CYCLES = 10**15
"""Half cycles that floating point counts."""


def finite(name: str, value: float) -> float:
    """Return `value` as a float; raise ValueError unless it is a finite number.

    Parameters
    ----------
    name : str, of the argument, for the message
    value : float, or what `float` makes one of
    """
    try:
        number = float(value)
    except (TypeError, ValueError, OverflowError):
        number = math.nan
    if not math.isfinite(number):
        raise ValueError(f"{name} is {value!r}; it must be a finite number")
    return number


def positive(name: str, value: float) -> float:
    """Return `value` as a float; raise ValueError unless it is positive and finite.

    Parameters
    ----------
    name, value
        As for `finite`.
    """
    number = finite(name, value)
    if number <= 0.0:
        raise ValueError(f"{name} is {value!r}; it must be positive")
    return number


def measurable(name: str, value: float) -> float:
    """Return `value` as a float; raise ValueError unless it is positive, from LEAST to MOST.

    Parameters
    ----------
    name, value
        As for `finite`.
    """
    number = positive(name, value)
    if not LEAST <= number <= MOST:
        raise ValueError(f"{name} is {value!r}; it must be from {LEAST:g} to {MOST:g}")
    return number


def whole_half_cycles(value: float) -> int:
    """Return a number of half cycles; raise ValueError unless it is a whole one that counts."""
    number = positive("half_cycles", value)
    if number > MOST_HALF_CYCLES or number != int(number):
        allowed = f"a whole number from 1 to {MOST_HALF_CYCLES:g}"
        raise ValueError(f"half_cycles is {value!r}; it must be {allowed}")
    return int(number)


def finite_result(what: str, value: float, cause: str) -> None:
    """Raise ValueError unless a value that follows from arguments is finite.

    Parameters
    ----------
    what : str, name of the value
    value : float
    cause : str, the arguments that it follows from, with their values
    """
    if not math.isfinite(value):
        raise ValueError(f"{cause}; {what}, which follows as {value!r}, must be finite")
