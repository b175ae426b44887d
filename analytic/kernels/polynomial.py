"""Roots and maxima of a polynomial on the unit interval, none missed.

A polynomial of a degree n is an array, shape (>= n + 1,), of the coefficients a[i] of sum a[i] x^i;
d[i] are those of a step that is stretched to [0, 1], so that x is the part of the step.

It is turned into Bernstein form, where the number of sign changes of its coefficients bounds the
number of its roots in (0, 1) and has the same parity (Descartes). No change: no root; one change:
exactly one. Otherwise the interval is halved (de Casteljau) until one of the two holds. Most are
monotone, as the signs of their coefficients tell for less.
"""

from analytic.kernels.law import FloatArray

ORDER = 24
"""Degree of the Taylor polynomials of a step."""

MAX_DEPTH = 45
"""Halvings after which two roots count as a touching point, not as two crossings."""

NEWTON_DONE = 1e-9
"""Relative length of the last Newton step of a root."""

EDGE = 1e-9
"""Part of a bracket in which a chord's zero is taken to be at its end."""

SAME_ROOT = 1e-15
"""Distance within which a root is not told from another."""


def value(a: FloatArray, degree: int, x: float) -> float:
    """Return sum a[i] x^i."""
    total = a[degree]
    for i in range(degree - 1, -1, -1):
        total = total * x + a[i]
    return total


def slope(a: FloatArray, degree: int, x: float) -> float:
    """Return sum i a[i] x^(i-1)."""
    total = degree * a[degree]
    for i in range(degree - 1, 0, -1):
        total = total * x + i * a[i]
    return total


def value_and_slope(a: FloatArray, degree: int, x: float) -> tuple[float, float]:
    """Return `value` and `slope`, in little more time than one of them."""
    total, rate = a[degree], 0.0
    for i in range(degree - 1, -1, -1):
        rate = rate * x + total
        total = total * x + a[i]
    return total, rate


def stretch(a: FloatArray, degree: int, h: float, d: FloatArray) -> None:
    """Write the coefficients of sum a[i] (h x)^i into d[0..degree]."""
    scale = 1.0
    for i in range(degree + 1):
        d[i] = a[i] * scale
        scale *= h


def trend(d: FloatArray, degree: int, lead: int) -> int:
    """Return 1 where sum d[i] x^i is sure to rise on (0, 1], -1 where it falls, else 0."""
    first = max(lead, 1)
    least = most = first * d[first]
    for i in range(first + 1, degree + 1):
        rate = i * d[i]
        least += min(rate, 0.0)
        most += max(rate, 0.0)
    if least > 0.0:
        return 1
    return -1 if most < 0.0 else 0


def to_bernstein(a: FloatArray, degree: int, b: FloatArray) -> None:
    """Write the Bernstein coefficients of sum a[i] x^i on [0, 1] into `b`."""
    binomial = 1.0
    for i in range(degree + 1):
        b[i] = a[i] * (1.0 / binomial)
        binomial = binomial * (degree - i) / (i + 1)
    for r in range(1, degree + 1):
        for i in range(degree, r - 1, -1):
            b[i] += b[i - 1]


def sign_changes(b: FloatArray, degree: int) -> tuple[int, float]:
    """Count the sign changes in b[0..degree], zeros left out; return the last other one, too."""
    changes = 0
    last = 0.0
    for i in range(degree + 1):
        if b[i] != 0.0:
            if last * b[i] < 0.0:
                changes += 1
            last = b[i]
    return changes, last


def halve(b: FloatArray, degree: int, right: FloatArray) -> None:
    """Replace `b` by its left half and write its right half into `right`."""
    right[degree] = b[degree]
    for r in range(1, degree + 1):
        for i in range(degree, r - 1, -1):
            b[i] = 0.5 * (b[i] + b[i - 1])
        right[degree - r] = b[degree]


def bracketed_root(a: FloatArray, degree: int, low: float, high: float, rising: bool) -> float:
    """Return the only root of `a` in [low, high], by Newton's method kept in its bracket.

    `a` is positive at `high` if it is `rising`. It begins where the chord is zero, but in the
    middle where that is at an end: another root may be there.
    """
    first, last = value(a, degree, low) if low > 0.0 else a[0], value(a, degree, high)
    x = low + (high - low) * (first / (first - last)) if first != last else low
    edge = EDGE * (high - low)
    if not low + edge < x < high - edge:
        x = 0.5 * (low + high)
    for _ in range(100):
        f, gradient = value_and_slope(a, degree, x)
        if f == 0.0:
            return x
        if (f > 0.0) == rising:
            high = x
        else:
            low = x
        new = x - f / gradient if gradient != 0.0 else low
        if low < new < high:
            # the error of a Newton step is of the order of its square
            if abs(new - x) <= NEWTON_DONE * x:
                return new
        else:
            new = 0.5 * (low + high)
            if not low < new < high:
                return new
        x = new
    return x


def only_root(a: FloatArray, degree: int, start: float) -> float:
    """Return the root of a monotone `a` in (start, 1], or 2 when there is none."""
    last = value(a, degree, 1.0)
    if a[0] * last > 0.0 or a[0] == 0.0:
        return 2.0
    root = bracketed_root(a, degree, 0.0, 1.0, last > 0.0) if last != 0.0 else 1.0
    return root if root > start + SAME_ROOT else 2.0


def next_root(a: FloatArray, degree: int, start: float, pool: FloatArray) -> float:
    """Return the first root of `a` beyond SAME_ROOT of the start, up to 1, or 2; pool is spare."""
    if trend(a, degree, 0) != 0:
        return only_root(a, degree, start)
    to_bernstein(a, degree, pool[0])
    low, width = 0.0, 1.0
    top = depth = 0
    # pool[0..top] hold the intervals still to search, the leftmost, [low, low + width], on top
    while top >= 0:
        b = pool[top]
        changes, last = sign_changes(b, degree) if low + width > start else (0, 0.0)
        if changes > 1 and depth < MAX_DEPTH:
            for i in range(degree + 1):
                pool[top + 1][i] = b[i]
            halve(pool[top + 1], degree, b)
            top += 1
            depth += 1
            width *= 0.5
            continue
        if changes == 1:
            # of a root on the border of two intervals the signs here say in which of them it is,
            # those of values would say it of each anew
            root = bracketed_root(a, degree, low, low + width, last > 0.0)
            if root > start + SAME_ROOT:
                return root
        low += width
        if b[degree] == 0.0 and low > start + SAME_ROOT:
            return low
        top -= 1
        # after a right half the next interval is the sibling of an ancestor, which is wider
        while depth > 0 and (low / width) % 2.0 == 0.0:
            width *= 2.0
            depth -= 1
    return 2.0


def highest(
    d: FloatArray, order: int, lead: int, end: float, above: float, work: FloatArray
) -> tuple[float, float]:
    """Return the maximum of sum d[i] x^i on [0, end] and where; `above`, -1 if it is no higher."""
    bound = d[0]
    for i in range(1, order + 1):
        bound += max(d[i], 0.0)
    if bound <= above:
        return above, -1.0
    top, where = above, -1.0
    last = value(d, order, end)
    if last > top:
        top, where = last, end
    if trend(d, order, lead) != 0:
        return top, where
    rate = work[0]
    shift = max(lead, 1)
    degree = order - shift
    for i in range(degree + 1):
        rate[i] = (i + shift) * d[i + shift]
    once = trend(rate, degree, 0) != 0
    x = next_root(rate, degree, 0.0, work[1:])
    while x < end:
        here = value(d, order, x)
        if here > top:
            top, where = here, x
        x = 2.0 if once else next_root(rate, degree, x, work[1:])
    return top, where
