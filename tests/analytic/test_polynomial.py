"""Roots on the unit interval: none missed, each once."""

import numpy as np
import pytest
from hypothesis import assume, example, given, settings
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from analytic.kernels.polynomial import MAX_DEPTH, ORDER, next_root


def all_roots(coefficients):
    a = np.zeros(ORDER + 1)
    a[: len(coefficients)] = coefficients
    pool = np.empty((MAX_DEPTH + 2, ORDER + 1))
    found, x = [], 0.0
    while (x := next_root(a, len(coefficients) - 1, x, pool)) <= 1.0:
        found.append(x)
    return found


@settings(max_examples=400, deadline=None)
@given(
    st.lists(st.floats(-0.6, 1.6), max_size=7),
    st.lists(st.sampled_from([0.25, 0.375, 0.5, 0.75]), max_size=3),
    st.floats(0.1, 10),
)
# one on the border of two intervals, and another beside it
@example([1.1985469861617877, 1.3346662292034783, 1.1, 0.36, -0.03330319795478531], [0.5], 7.467)
@example([-0.2, 0.304, 0.864], [0.5, 0.25, 0.75], 0.7)
@example([-0.4, -0.038, 0.232, 1.103], [0.5, 0.25], 3.1)
# the value at 0.75 is rounding, and says nothing of the root beyond
@example(
    [1.3839232288930248, 0.6674282039319627, 0.5707148808912018, 0.9823074301086024, 0.04],
    [0.375, 0.5, 0.75],
    1.0,
)
def test_the_roots_put_in_come_out(anywhere, borders, scale):
    """Roots on the borders of intervals hide no others."""
    roots = [r for r in (*anywhere, *borders) if abs(r) > 1e-3 and abs(r - 1) > 1e-3]
    assume(roots and not (np.diff(sorted(roots)) < 1e-2).any())
    inside = sorted(r for r in roots if 0 < r < 1)
    found = all_roots((scale * Polynomial.fromroots(roots)).coef)
    # a root moves by the rounding of the coefficients times its condition number
    np.testing.assert_allclose(found, inside, atol=1e-6)


@pytest.mark.parametrize(
    ("roots", "raised", "found", "within"),
    [
        ([0.25, 0.5, 0.75], 0.0, [0.25, 0.5, 0.75], 1e-14),  # where intervals are halved
        ([0.3, 0.3 + 1e-6], 0.0, [0.3, 0.3 + 1e-6], 1e-9),
        ([0.3, 0.3], 1e-12, [], 0.0),  # it touches without a crossing
        ([0.0, -2.0], 0.0, [], 0.0),  # one at the begin is not in (0, 1]
        ([1.0, -4.0], 0.0, [1.0], 0.0),
    ],
)
def test_roots_that_are_easily_missed(roots, raised, found, within):
    seen = all_roots((Polynomial.fromroots(roots) + raised).coef)
    np.testing.assert_allclose(seen, found, rtol=0.0, atol=within)
