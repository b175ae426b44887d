"""Words of a claim made from its counts and numbers, so that no sentence says more than a table."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from typing import Any, TypeVar

import pandas as pd

from studies.measures.wrongness import MEANINGS, WORDS, Counts, counted, wrong_in

NAMED = 2
"""Engines up to which a sentence names each; of more it says the sum or the range."""

WHOLE = 0.1
"""From this part on a number is given in whole per cent."""

Said = TypeVar("Said")

SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def out_of(count: float, total: float) -> str:
    """Return "all 960", "none of 960" or "949 of 960".

    Parameters
    ----------
    count, total : float
        Whole numbers, 0 <= count <= total; "all" is not said of one.
    """
    if count == total > 1:
        return f"all {total:.0f}"
    return f"none of {total:.0f}" if count == 0 else f"{count:.0f} of {total:.0f}"


def each_out_of(counts: Sequence[float], totals: Sequence[float]) -> str:
    """Return several counts: "all 960", "949 and 955 of 960", "3 of 31 and all 27".

    Parameters
    ----------
    counts, totals : sequence of float
        As for `out_of`, of equal lengths.

    Raises
    ------
    ValueError
        If the lengths differ.
    """
    words = [out_of(*pair) for pair in zip(counts, totals, strict=True)]
    if len(set(words)) > 1 and len(set(totals)) == 1:
        return f"{listed([f'{count:.0f}' for count in counts])} of {totals[0]:.0f}"
    return alike(words)


def listed(words: Sequence[str], joint: str = "and") -> str:
    """Return words as a list in a sentence: "a", "a and b", "a, b and c"; "none" without any.

    Parameters
    ----------
    words : sequence of str
    joint : str, optional
        What stands before the last.
    """
    *first, last = words or ("none",)
    return f"{', '.join(first)} {joint} {last}" if first else last


def alike(words: Sequence[str], joint: str = "and") -> str:
    """Return a list of words, or the one word that they all are.

    Parameters
    ----------
    words, joint
        As for `listed`.
    """
    return words[0] if len(set(words)) == 1 else listed(words, joint)


def by_value(said: Iterable[tuple[str, Said]]) -> dict[Said, list[str]]:
    """Return the names of whom the same is said, under what is said of them."""
    names: dict[Said, list[str]] = {}
    for name, value in said:
        names.setdefault(value, []).append(name)
    return names


def gathered(said: Iterable[tuple[str, str]]) -> str:
    """Return names and what is said of each, once for all of whom the same is said.

    "a and b 7 of 10; c none of 10".
    """
    return "; ".join(f"{listed(group)} {words}" for words, group in by_value(said).items())


def power(value: float) -> str:
    """Return a number in two digits with its power of ten: "2.9·10⁻⁶", "10⁻⁴"."""
    if not value:
        return "0"
    digits, exponent = f"{value:.1e}".split("e")
    ten = "10" + str(int(exponent)).translate(SUPERSCRIPTS)
    return ten if digits == "1.0" else f"{digits.removesuffix('.0')}·{ten}"


def part(value: float) -> str:
    """Return a part of a whole: in per cent from a thousandth on, as a power of ten below."""
    if math.isnan(value):
        return "-"
    if math.isinf(value):
        return "without bound"
    if abs(value) < 1e-3:
        return power(value)
    if 0.99 < value < 1.0:
        return f"{math.floor(1e3 * value) / 10.0:.1f} %"  # not all of it
    return f"{value:.0%}".replace("%", " %") if abs(value) >= WHOLE else f"{100.0 * value:.2g} %"


def signed(error: float) -> str:
    """Return an error with its sign, in whole per cent; below 0.1 % its size as a power of ten."""
    if abs(error) < 1e-3:
        return power(abs(error))
    return f"{error:+.0%}".replace("-", "−").replace("%", " %")


def per_cent(error: float) -> str:
    """Return an error that is asked for, in per cent."""
    return f"{100.0 * error:g} %"


def times(value: float) -> str:
    """Return a factor that something follows: "0.62 of", "1.1 times", "192 times"."""
    if value < 1.0:
        return f"{value:.2g} of"
    return f"{value:.2g} times" if value < 10.0 else f"{value:.0f} times"


def duration(seconds: float) -> str:
    """Return a time in the unit in which it is between 1 and 1000."""
    for scale, unit in ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")):
        if seconds >= scale:
            return f"{seconds / scale:.3g} {unit}"
    return f"{seconds * 1e9:.3g} ns"


def capital(sentence: str) -> str:
    """Return a sentence with its first letter large."""
    return sentence[:1].upper() + sentence[1:]


def in_kinds(counts: Counts) -> str:
    """Return counts in words, those that are not zero: "the fall wrong in 3 and no answer in 2"."""
    words = [f"{name} in {counts[kind]:.0f}" for kind, name in WORDS.items() if counts[kind]]
    return listed(words) if words else "none wrong"


def right_of(rows: pd.DataFrame) -> str:
    """Return how many outcomes are right of how many, and the kinds of the others in brackets."""
    return right_but(counted(wrong_in(rows)), len(rows))


def right_but(counts: Counts, cases: float) -> str:
    """Return how many outcomes are right, and the kinds of the others: "8 of 9 (no answer in 1)".

    Parameters
    ----------
    counts : mapping
        How many are wrong, by kind; the line of a summary is one.
    cases : float
        How many there are.
    """
    lost = sum(counts[kind] for kind in WORDS)
    return out_of(cases - lost, cases) + (f" ({in_kinds(counts)})" if lost else "")


def meant() -> str:
    """Return what each kind of a wrong outcome counts."""
    return listed([f"{name} ({MEANINGS[kind]})" for kind, name in WORDS.items()])


def between(lines: pd.DataFrame, names: pd.Series[Any]) -> str:
    """Return between what counts several sources lie, kind by kind, and who is at the ends.

    "the fall wrong in 1 (a) to 44 (b) and no answer in up to 3 (b)"; never the sum over sources,
    of whom one may have most of it.

    Parameters
    ----------
    lines : DataFrame
        A line for each source, with a column for each kind.
    names : Series
        What each is called.
    """
    words = [
        f"{name} in {_ends(lines[kind], names)}" for kind, name in WORDS.items() if any(lines[kind])
    ]
    return listed(words) if words else "none wrong"


def _ends(counts: pd.Series[Any], names: pd.Series[Any]) -> str:
    low, high = counts.min(), counts.max()
    least, most = (names.iloc[int(place)] for place in (counts.argmin(), counts.argmax()))
    if low == high:
        return f"{high:.0f} each" if len(counts) > 1 else f"{high:.0f}"
    return f"{f'{low:.0f} ({least}) to' if low else 'up to'} {high:.0f} ({most})"
