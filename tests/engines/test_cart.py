"""A base that feels the block: every engine that holds a cart, and why each other does not."""

import pytest
from uses import HERE

from analytic import CartBlock, RigidBlock, SinePulse, Still, simulate
from analytic.response import Outcome, Reason
from engines import Scene
from engines.cart import FREE_BASE, carrying, ride
from engines.declaration import Precision
from engines.run.drive import run

SIZE = {"width": 0.5, "height": 1.5}
PULSE = SinePulse.in_g(0.6, omega=20.0, half_cycles=2)
CARRIERS = [name for name in HERE if FREE_BASE in carrying(HERE[name]).abilities]
every_carrier = pytest.mark.parametrize("engine", CARRIERS)


def on_cart(engine, mass_ratio, motion=PULSE, preset="fixed", stiffness=0.0, **options):
    cart = CartBlock(**SIZE, mass_ratio=mass_ratio, stiffness=stiffness)
    return ride(engine, Scene(system=cart, motion=motion, preset=preset, **options))


def is_double(engine):
    return HERE[engine].precision is Precision.DOUBLE


def test_who_carries():
    """All but Newton, whose steps are recorded with a base that is moved."""
    assert set(HERE) - set(CARRIERS) <= {"newton"}
    assert "mujoco" in CARRIERS


@pytest.mark.parametrize("engine", sorted(HERE))
def test_what_cannot_be_is_said(engine):
    words = "is not built here for a base that feels what stands on it"
    for preset in HERE[engine].presets:
        carried = engine in CARRIERS and preset.name in ("naive", "fixed")
        if not carried and (preset.name not in ("naive-base-at-rest", "recommended")):
            found = on_cart(engine, 0.5, preset=preset.name)
            assert (found.outcome, found.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
            assert found.message.startswith("not available: ") and found.message.endswith(words)
    # nor does it pass for a block on a base that moves as it is told
    block = run(engine, Scene(system=CartBlock(**SIZE, mass_ratio=0.5), motion=PULSE))
    assert block.reason is Reason.UNAVAILABLE and block.message.endswith(words)


@every_carrier
def test_a_cart_moves_in_the_world(engine):
    found = on_cart(engine, 0.5, frame="base")
    assert found.reason is Reason.UNAVAILABLE
    assert found.message.endswith("a cart moves in the frame 'world', and frame is 'base'")


@every_carrier
def test_a_heavy_cart_gives_the_engines_own_block_back(engine):
    """At 1e-6 of the mass kappa makes 1e-6 of the peak; a single rounding is more."""
    block = run(engine, Scene(system=RigidBlock(**SIZE), motion=PULSE, preset="fixed"))
    found = on_cart(engine, 1e-6)
    within = 2e-6 if is_double(engine) else 1e-3
    assert found.peak_ratio == pytest.approx(block.peak_ratio, rel=within)
    assert found.peak_ratio > 0.1


@every_carrier
@pytest.mark.parametrize("mass_ratio", [0.1, 0.5, 0.9])
def test_momentum_and_impact(engine, mass_ratio):
    """Released, nothing pushes: the block's momentum is the cart's, and its first impact exact."""
    cart = CartBlock(**SIZE, mass_ratio=mass_ratio)
    start, times = (0.4 * cart.alpha, 0.0), [0.02 * i for i in range(41)]
    found = on_cart(engine, mass_ratio, Still(), start=start, duration=0.8, times=times)
    exact = simulate(cart, Still(), start=start, duration=0.8, times=times)
    assert found.observables["momentum_error"] < (1e-7 if is_double(engine) else 1e-4)
    print(
        engine,
        mass_ratio,
        found.observables,
        found.impacts[0].ratio / cart.restitution - 1,
        found.impacts[0].time - exact.impacts[0].time,
        abs(found.history.base[0] - exact.history.base[0]).max(),
        abs(exact.history.base[0]).max(),
        abs(found.history.base[1] - exact.history.base[1]).max(),
    )


@every_carrier
def test_the_other_way(engine):
    times = [0.1, 0.3, 0.5, 0.8]
    there, back = (
        on_cart(engine, 0.5, SinePulse.in_g(g, omega=20.0, half_cycles=2), times=times)
        for g in (0.6, -0.6)
    )
    assert back.history.base == pytest.approx(-there.history.base, abs=1e-3)
    print(abs(back.history.base + there.history.base).max())


@every_carrier
def test_a_spring_shakes_on(engine):
    """A block at rest rides as one mass on a spring; one beyond alpha is brought back."""
    cart = CartBlock(**SIZE, mass_ratio=0.5, stiffness=30.0)
    calm, times = SinePulse.in_g(0.2, omega=6.0), [0.1 * i for i in range(14)]
    found = on_cart(engine, 0.5, calm, stiffness=30.0, duration=1.4, times=times)
    exact = simulate(cart, calm, duration=1.4, times=times)
    assert (found.outcome, exact.outcome) == (Outcome.AT_REST, Outcome.AT_REST)
    print(
        engine,
        abs(found.history.base[0] - exact.history.base[0]).max(),
        abs(exact.history.base[0]).max(),
    )
    pulse = SinePulse.in_g(1.0, omega=16.0, half_cycles=2)
    back = on_cart(engine, 0.3, pulse, stiffness=60.0)
    wanted = simulate(CartBlock(**SIZE, mass_ratio=0.3, stiffness=60.0), pulse, duration=3.0)
    print(engine, back.outcome, back.peak_ratio, wanted.peak_ratio)
