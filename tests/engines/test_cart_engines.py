"""A base that feels the block: every engine that holds a cart."""

import numpy as np
import pytest
from uses import HERE, agreed, rocked

from analytic import CartBlock, SinePulse, Still
from analytic.response import Outcome
from engines.declaration import Precision
from engines.layouts import Ability

SIZE = {"width": 0.5, "height": 1.5}
PULSE = SinePulse.in_g(0.6, omega=20.0, half_cycles=2)
CARRIERS = [name for name in HERE if Ability.FREE_BASE in HERE[name].holds]
every_carrier = pytest.mark.parametrize("engine", CARRIERS)


def on_cart(engine, mass_ratio, motion=PULSE, stiffness=0.0, **options):
    """Return the exact response on a cart, and an engine's."""
    cart = CartBlock(**SIZE, mass_ratio=mass_ratio, stiffness=stiffness)
    return agreed(engine, motion, system=cart, preset="fixed", **options)


def is_double(engine):
    return HERE[engine].precision is Precision.DOUBLE


@every_carrier
def test_a_heavy_cart_gives_the_engines_own_block_back(engine):
    """At 1e-6 of the mass the exact peak is 1e-6 larger; of single numbers a rounding is more."""
    block, (_, found) = rocked(engine, PULSE, preset="fixed"), on_cart(engine, 1e-6)
    within = 2e-6 if is_double(engine) else 2e-3
    assert found.peak_ratio == pytest.approx(block.peak_ratio, rel=within)
    assert found.peak_ratio > 0.1


@every_carrier
@pytest.mark.parametrize("mass_ratio", [0.1, 0.5, 0.9])
def test_released_nothing_pushes(engine, mass_ratio):
    """The cart goes the other way with the block's momentum, and the first impact is SCENES.md's.

    Where in a step an impact falls is worth some p dt of its ratio.
    """
    cart = CartBlock(**SIZE, mass_ratio=mass_ratio)
    start, times = (0.4 * cart.alpha, 0.0), np.linspace(0.0, 0.6, 31).tolist()
    asked = {"start": start, "duration": 0.6, "times": times}
    exact, found = on_cart(engine, mass_ratio, Still(), **asked)
    assert found.observables["momentum_error"] < (1e-7 if is_double(engine) else 1e-4)
    assert found.impacts[0].time == pytest.approx(exact.impacts[0].time, abs=1e-3)
    assert found.impacts[0].ratio == pytest.approx(cart.restitution, rel=5e-3)
    places = found.history.base[0], exact.history.base[0]
    assert places[0] == pytest.approx(places[1], abs=0.02 * np.abs(places[1]).max())
    assert np.abs(places[1]).max() > 0.01


@every_carrier
def test_the_other_way(engine):
    times = [0.1, 0.3, 0.5]
    there, back = (
        on_cart(engine, 0.5, SinePulse.in_g(g, omega=20.0, half_cycles=2), times=times)[1]
        for g in (0.6, -0.6)
    )
    within = 1e-6 if is_double(engine) else 2e-3
    assert back.history.base == pytest.approx(-there.history.base, abs=within)
    assert back.history.theta == pytest.approx(-there.history.theta, abs=within)


@every_carrier
def test_on_a_spring(engine):
    """A block at rest rides as one mass; one that leaned beyond alpha is brought back."""
    sprung, times = {"mass_ratio": 0.3, "stiffness": 20.0}, np.linspace(0.0, 1.4, 15).tolist()
    calm = SinePulse.in_g(0.2, omega=6.0)
    exact, found = on_cart(engine, motion=calm, **sprung, duration=1.4, times=times)
    assert found.outcome is Outcome.AT_REST
    assert found.history.base[0] == pytest.approx(exact.history.base[0], abs=1e-4)
    pulse = SinePulse.in_g(1.0, omega=20.0, half_cycles=2)
    exact, found = on_cart(engine, motion=pulse, **sprung, duration=1.95)
    assert found.outcome is Outcome.ROCKED
    assert exact.peak_ratio > 1.0
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=2e-2)


def test_a_block_that_has_not_come_to_lie_on_a_spring_has_not_fallen():
    sprung = {"mass_ratio": 0.3, "stiffness": 60.0}
    pulse = SinePulse.in_g(0.8, omega=14.0, half_cycles=2)
    for end in (1.8, 3.0):
        exact, found = on_cart("mujoco", motion=pulse, **sprung, duration=end)
        if end == 1.8:
            assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=5e-3)
    assert exact.outcome is Outcome.OVERTURNED
