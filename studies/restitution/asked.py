"""What is asked of a drop and of a strike: every coefficient, with one thing varied at a time."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import product
from typing import TypeVar

from engines.parts.drop import Drop
from engines.run.strike import Strike

WANTED = (0.0, 0.2, 0.4, 0.6, 0.8, 1.0)
"""Coefficients of restitution."""

PHASES = (0.1, 0.5, 0.9)
"""Parts of a step after which the impact falls."""

Asked = TypeVar("Asked", Drop, Strike)


def one_at_a_time(
    base: Asked, varied: Mapping[str, Sequence[float]]
) -> Iterator[tuple[str, Asked]]:
    """Yield what is varied, "" for nothing, and what is asked.

    Parameters
    ----------
    base : Drop or Strike
        From which one thing at a time is varied.
    varied : mapping
        What is varied -> its other values.
    """
    others: list[tuple[str, dict[str, float]]] = [("", {})]
    others += [(name, {name: value}) for name, values in varied.items() for value in values]
    for (name, other), wanted, phase in product(others, WANTED, PHASES):
        yield name, replace(base, restitution=wanted, phase=phase, **other)
