"""The paper's solvers: their orders through impacts, and what the event tolerance costs."""

import math

import numpy as np
import pytest

from analytic import MODELS, Outcome, Record, RigidBlock, SinePulse, integrate, simulate
from analytic.steppers import METHODS

G = 9.81
BLOCK = RigidBlock(width=0.5, height=1.0)
PULSE = SinePulse(amplitude=0.6 * G, omega=2 * math.pi, half_cycles=2)
ANSWERED = [
    (PULSE, Outcome.ROCKED),
    (SinePulse(amplitude=0.49 * G, omega=6.0, half_cycles=2), Outcome.AT_REST),
    (SinePulse(amplitude=2.0 * G, omega=2.0, half_cycles=2), Outcome.OVERTURNED),
]


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("method", "order"), [("rk4", 4), ("average-acceleration", 2)])
@pytest.mark.parametrize("sampled", [False, True])
def test_order_along_a_response_with_impacts(method, order, model, sampled):
    onset = MODELS[model].law(BLOCK.alpha, 0.0).onset
    pulse = SinePulse(amplitude=1.08 * onset * G, omega=2 * math.pi, half_cycles=3)
    if sampled:  # a step must not pass a corner
        times = np.arange(0.0, pulse.duration, 0.07)
        pulse = Record(dt=0.07, samples=pulse.acceleration(times))
    duration = pulse.duration + 1.0
    times = np.linspace(0.1, duration, 41)
    exact = simulate(BLOCK, pulse, model, times=times, duration=duration)
    assert len(exact.impacts) >= 2
    steps = 0.04 * 0.5 ** np.arange(4)
    errors = []
    for step in steps:
        tested = integrate(
            BLOCK, pulse, model, method=method, step=step,
            event_tolerance=1e-14, times=times, duration=duration,
        )  # fmt: skip
        assert len(tested.impacts) == len(exact.impacts)
        errors.append(np.sqrt(np.mean((tested.history.theta - exact.history.theta) ** 2)))
    slope = np.polyfit(np.log(steps), np.log(errors), 1)[0]
    assert slope == pytest.approx(order, abs=0.3)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize(("motion", "outcome"), ANSWERED)
def test_default_settings_keep_the_papers_outcomes(motion, outcome, method, model):
    reference = simulate(BLOCK, motion, model)
    response = integrate(BLOCK, motion, model, method=method)
    assert response.outcome is reference.outcome
    assert response.outcome is outcome or model != "exact"
    # the event tolerance 1e-6 rad ends an excursion up to 1e-6/velocity late
    assert response.peak_ratio == pytest.approx(reference.peak_ratio, rel=3e-4)
    if outcome is Outcome.ROCKED is response.outcome:
        struck = [impact for impact in reference.impacts if impact.time < motion.duration]
        assert len(response.impacts) == len(struck)


def test_the_event_tolerance_is_the_error_that_is_left():
    exact = simulate(BLOCK, PULSE).peak_ratio
    errors = [
        abs(integrate(BLOCK, PULSE, event_tolerance=tolerance).peak_ratio / exact - 1)
        for tolerance in (1e-4, 1e-8, 1e-12)
    ]
    assert errors[0] > 10 * errors[1] > 10 * errors[2]
    assert errors[2] < 1e-10
