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
    positive(name, value)
    return within(name, value, LEAST, MOST)


def within(name: str, value: float, least: float, most: float) -> float:
    """Return `value` as a float; raise ValueError unless it is a number from `least` to `most`.

    Parameters
    ----------
    name, value
        As for `finite`.
    least, most : float
    """
    number = finite(name, value)
    if not least <= number <= most:
        raise ValueError(f"{name} is {value!r}; it must be from {least:g} to {most:g}")
    return number


def sized(name: str, value: float, least: float = LEAST) -> float:
    """Return `value` as a float; raise ValueError unless it is 0, or of a size `least` to MOST.

    Parameters
    ----------
    name, value
        As for `finite`.
    least : float, optional
    """
    number = finite(name, value)
    if number != 0.0 and not least <= abs(number) <= MOST:
        raise ValueError(f"{name} is {value!r}; it must be 0, or of a size {least:.3g} to {MOST:g}")
    return number


def whole(name: str, value: float, most: int) -> int:
    """Return `value` as an int; raise ValueError unless it is a whole number from 1 to `most`.

    Parameters
    ----------
    name, value
        As for `finite`.
    most : int
    """
    number = positive(name, value)
    if number > most or number != int(number):
        raise ValueError(f"{name} is {value!r}; it must be a whole number from 1 to {most:g}")
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
