"""Numbers in a text that follow a step, as formulas of it."""

import math
import re
from collections.abc import Callable

NUMBER = re.compile(r"((?<![\w.])-?\d+(?:\.\d*)?(?:[eE][-+]?\d+)?)")
"""A number, and no digit of a name."""
FORMULA = re.compile(NUMBER.pattern + r"?([*/]?)\bDT\b(?:\*\*(\d+))?")
"""A power of DT, with a coefficient or without."""
STEPS_S = (2.0**-10, 2.0**-9, 2.0**-8)
"""Steps [s] whose powers are exact."""
NEAR = 1e-9
"""Relative difference within which a number follows a power of the step."""


def by_step(written: Callable[[float], str]) -> str:
    """Return a text with what follows the step as a power of DT, the step [s].

    `written` gives the text at a step [s]: the same for all but for its numbers and for where its
    lines are broken. It is a ValueError if a number follows the step, and no power of it.
    """
    parts = [NUMBER.split(written(dt_s)) for dt_s in STEPS_S]
    plain = {tuple("".join(word.split()) for word in part[::2]) for part in parts}
    if len(plain) > 1:
        raise ValueError(f"{''.join(parts[0])!r} has other words at another step")
    numbers = [_of_step(*three) for three in zip(*(part[1::2] for part in parts), strict=True)]
    words = [word for pair in zip(parts[0][::2], [*numbers, ""], strict=True) for word in pair]
    return "".join(words)


def at_step(written: str, dt_s: float) -> str:
    """Return a text of `by_step` with numbers, in ten digits, in place of its formulas."""

    def number(found: re.Match[str]) -> str:
        times, sign, power = found.groups()
        exponent = float(power or 1) * (-1.0 if sign == "/" else 1.0)
        return f"{float(times or 1.0) * dt_s**exponent:.10g}"

    return FORMULA.sub(number, written)


def _of_step(first: str, second: str, third: str) -> str:
    """Return a number as it is written, or as a power of the step times a coefficient."""
    if first == second == third:
        return first
    a, b, c = map(float, (first, second, third))
    power = round(math.log2(b / a)) if a * b > 0.0 else 0
    ratio = 2.0**power
    if not power or not all(math.isclose(x, ratio * y, rel_tol=NEAR) for x, y in ((b, a), (c, b))):
        raise ValueError(f"{first}, {second}, {third} at doubled steps follow no power of them")
    times = f"{a / STEPS_S[0] ** power:.10g}"
    step = "DT" if abs(power) == 1 else f"DT**{abs(power)}"
    if power < 0:
        return f"{times}/{step}"
    return step if times == "1" else f"{times}*{step}"
