"""Engines with their own defaults, on a floor that a constraint or a weld drags: its lag."""

import pytest
from uses import HERE, SHAKEN, agreed, pulse, rocked

from analytic.response import Outcome
from engines.pybullet import NAIVE
from engines.run.run import LAG

FASTEST = 2.0 * SHAKEN.amplitude / SHAKEN.omega
ERROR_REDUCTION = 0.2
"""Part of its error that PyBullet's constraint takes out of the floor's place in a step."""
LAGS_S = {
    "pybullet": (1.0 - ERROR_REDUCTION) / ERROR_REDUCTION * NAIVE.step_s,
    "mujoco": 2.0 * 0.02 * 0.95,  # damping over stiffness of its weld
}
"""Engine -> by how long its floor lags behind a steady velocity."""
WITHIN = {"pybullet": 1e-2, "mujoco": 5e-2}
LED_M = {"drake": 1e-7, "newton": 1e-6}
"""Engine -> by less than what the floor is off that it leads."""


@pytest.mark.parametrize("engine", [name for name in LAGS_S if name in HERE])
def test_the_floor_lags_by_what_holds_it(engine):
    lag = rocked(engine, preset="default").observables[LAG]
    assert lag == pytest.approx(LAGS_S[engine] * FASTEST, rel=WITHIN[engine])


@pytest.mark.parametrize("engine", [name for name in LED_M if name in HERE])
def test_a_floor_that_is_led_is_where_it_should_be(engine):
    exact, response = agreed(engine, preset="default", frame="world")
    assert 0.0 < response.observables[LAG] < LED_M[engine]
    assert response.peak_ratio == pytest.approx(exact.peak_ratio, rel=0.2)


@pytest.mark.parametrize("engine", [name for name in LAGS_S if name in HERE])
@pytest.mark.parametrize("onsets", [0.8, -0.8])
def test_what_stands_on_a_floor_that_lags_is_at_rest(engine, onsets):
    """A block is seen from where the floor is, not from where it should be."""
    response = rocked(engine, pulse(onsets, 3.0, 2), preset="default")
    assert response.outcome is Outcome.AT_REST
    assert response.observables[LAG] > 1e-3
