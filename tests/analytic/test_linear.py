"""The linear models' closed form, and how the models relate."""

import math

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.integrate import solve_ivp

from analytic import MODELS, peak_ratios
from analytic.kernels.closed_form import linear_state
from analytic.kernels.law import State

LINEAR = [name for name, model in MODELS.items() if model.linear]


@settings(max_examples=60, deadline=None)
@given(
    name=st.sampled_from(LINEAR),
    alpha=st.floats(0.05, 0.7),
    segment=st.tuples(
        st.floats(-2, 2), st.floats(0.01, 8), st.floats(-3, 3), st.floats(-1, 1), st.floats(-1, 1)
    ),
    side=st.sampled_from([-1.0, 1.0]),
    v=st.floats(-1, 1),
    h=st.floats(0.01, 3),
)
def test_closed_form_solves_its_equation(name, alpha, segment, side, v, h):
    law = MODELS[name].law(alpha, 0.9)
    amplitude, omega, phase, offset, slope = segment
    row = np.array([0.5, 9.0, amplitude, omega, phase, offset, slope])
    y = 0.3 * alpha

    def equation(t, state):
        a = amplitude * math.sin(omega * t + phase) + offset + slope * t
        return [state[1], -(law.k**2) * (law.saddle - state[0] + side * law.factor * a)]

    path = solve_ivp(equation, (0.0, h), [y, v], "DOP853", rtol=1e-12, atol=1e-13)
    end = linear_state(law, row, State(side, 0.5, 0, y, v), h)
    scale = 1 + np.abs(path.y).max()
    np.testing.assert_allclose(end, path.y[:, -1], atol=1e-10 * scale)


@pytest.mark.parametrize("h", [1e-3, 1e-2, 0.1, 0.3])
def test_short_steps_out_of_a_rest_lose_no_digits(h):
    law = MODELS["housner"].law(0.3, 0.9)
    psi = math.asin(law.onset / 0.5)
    row = np.array([0.0, 9.0, 0.5, 2.0, psi, 0.0, 0.0])
    y, _ = linear_state(law, row, State(-1.0, 0.0, 3, 0.0, 0.0), h)
    # y'' = y + f, f = 0.5 (sin(2t + psi) - sin psi): its Taylor series from the recurrence
    f = [0.5 * 2.0**n / math.factorial(n) * math.sin(psi + n * math.pi / 2) for n in range(30)]
    f[0] = 0.0
    c = [0.0, 0.0]
    for n in range(28):
        c.append((c[n] + f[n]) / ((n + 1) * (n + 2)))
    assert y == pytest.approx(math.fsum(cn * h**n for n, cn in enumerate(c)), rel=1e-13)


def test_slender_blocks_make_all_models_one():
    alpha = 1e-4
    peaks = [peak_ratios(alpha, 1.3 * alpha, [0.8, 3.0], 2, name)[0] for name in MODELS]
    for other in peaks[1:]:
        np.testing.assert_allclose(other, peaks[0], rtol=1e-5)


def test_onset_matched_is_housner_with_a_smaller_amplitude():
    alpha = 0.4
    omega = np.linspace(0.2, 4, 20)
    matched, _ = peak_ratios(alpha, 0.6, omega, 2, "onset-matched")
    scaled, _ = peak_ratios(alpha, 0.6 * alpha / math.tan(alpha), omega, 2, "housner")
    np.testing.assert_allclose(matched, scaled, rtol=1e-12)
