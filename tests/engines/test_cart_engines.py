"""A base that feels the block: every engine that holds a cart, and why each other does not."""

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from uses import HERE

from analytic import CartBlock, RigidBlock, SinePulse, Still, simulate
from analytic.response import Outcome, Reason
from engines import ENGINES, Scene
from engines.cart import CartWorld, Seen, cart_mass
from engines.declaration import Precision, Stepping
from engines.layouts import Ability
from engines.registry import OWN
from engines.run.drive import run
from engines.undeclared import undeclared
from engines.world import Moment
from studies.kit.identity import Makers
from studies.kit.jobs import Job, ask, summary
from studies.sources.registry import Source

SIZE = {"width": 0.5, "height": 1.5}
PULSE = SinePulse.in_g(0.6, omega=20.0, half_cycles=2)
CARRIERS = [name for name in HERE if Ability.FREE_BASE in HERE[name].holds]
every_carrier = pytest.mark.parametrize("engine", CARRIERS)
LACKS = "is not built here for a base that feels what stands on it"


def on_cart(engine, mass_ratio, motion=PULSE, preset="fixed", stiffness=0.0, **options):
    cart = CartBlock(**SIZE, mass_ratio=mass_ratio, stiffness=stiffness)
    return run(engine, Scene(system=cart, motion=motion, preset=preset, **options))


def is_double(engine):
    return HERE[engine].precision is Precision.DOUBLE


def test_who_carries():
    """All of the project's own but those whose steps are recorded with a base that is moved."""
    without = {name for name in OWN if Ability.FREE_BASE not in ENGINES[name].holds}
    assert without == {"newton", "warp", "mjx"}


@pytest.mark.parametrize("engine", sorted(HERE))
def test_what_cannot_be_is_said(engine):
    for preset in HERE[engine].presets:
        if engine not in CARRIERS or preset.stepping is not Stepping.FIXED:
            found = on_cart(engine, 0.5, preset=preset.name)
            assert (found.outcome, found.reason) == (Outcome.FAILED, Reason.UNAVAILABLE)
            assert found.message.startswith("not available: ") and found.message.endswith(LACKS)


class Glider:
    """A block that stands still on a cart of its scene's mass."""

    moment = Moment.MIDDLE

    def __init__(self, scene, settings, dt_s):
        self.whole, self.place, self.speed = scene.bodies[0].mass + cart_mass(scene), 0.0, 0.0

    def push(self, step, force):
        self.speed += force / self.whole * step.dt_s
        self.place += self.speed * step.dt_s

    def seen(self):
        return Seen((self.place, 0.75, 0.0, 0.0), self.speed, self.place, self.speed)

    def fault(self):
        return ""

    def close(self):
        pass


def test_an_engine_of_another_package_declares_a_cart_in_one_line():
    plain = undeclared("glider", Glider, "numpy")
    declared = replace(plain, builders={Ability.FREE_BASE: partial(CartWorld, Glider)})
    cart = CartBlock(**SIZE, mass_ratio=0.5)
    asked = Scene(system=cart, motion=SinePulse.in_g(0.2, omega=6.0), duration=1.1, times=[1.0])
    assert run(plain, asked).message.endswith(LACKS)
    found = run(replace(declared, frames=("world",)), asked)
    exact = simulate(cart, asked.motion, duration=1.1, times=asked.times)
    assert found.message == "as glider:fixed"
    assert found.history.base[0] == pytest.approx(exact.history.base[0], rel=1e-3)
    assert found.observables["momentum_error"] < 1e-12


def test_only_rows_of_carts_depend_on_what_builds_one():
    cart, block = CartBlock(**SIZE, mass_ratio=0.5), RigidBlock(**SIZE)
    jobs = [Job(labels={}, block=it, motion=PULSE, source="pymunk:fixed") for it in (cart, block)]
    ours, whole = [Makers(ask, summary).of(job) for job in jobs], Source.declared.fget
    with pytest.MonkeyPatch.context() as patch:
        other = {Ability.FREE_BASE: partial(CartWorld, Glider)}
        patch.setattr(Source, "declared", property(lambda it: replace(whole(it), builders=other)))
        now = [Makers(ask, summary).of(job) for job in jobs]
        assert [old != new for old, new in zip(ours, now, strict=True)] == [True, False]
        patch.setattr(Source, "declared", property(lambda it: replace(whole(it), builders={})))
        now = [Makers(ask, summary).of(job) for job in jobs]
        assert [old != new for old, new in zip(ours, now, strict=True)] == [True, False]


@every_carrier
def test_a_cart_moves_in_the_world(engine):
    found = on_cart(engine, 0.5, frame="base")
    assert found.reason is Reason.UNAVAILABLE
    assert found.message.endswith("a cart moves in the frame 'world', and frame is 'base'")


@every_carrier
def test_a_heavy_cart_gives_the_engines_own_block_back(engine):
    """At 1e-6 of the mass the exact peak is 1e-6 larger; of single numbers a rounding is more."""
    block = run(engine, Scene(system=RigidBlock(**SIZE), motion=PULSE, preset="fixed"))
    found = on_cart(engine, 1e-6)
    assert found.peak_ratio == pytest.approx(
        block.peak_ratio, rel=2e-6 if is_double(engine) else 2e-3
    )
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
    found = on_cart(engine, mass_ratio, Still(), **asked)
    exact = simulate(cart, Still(), **asked)
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
        on_cart(engine, 0.5, SinePulse.in_g(g, omega=20.0, half_cycles=2), times=times)
        for g in (0.6, -0.6)
    )
    within = 1e-6 if is_double(engine) else 2e-3
    assert back.history.base == pytest.approx(-there.history.base, abs=within)
    assert back.history.theta == pytest.approx(-there.history.theta, abs=within)


@every_carrier
def test_on_a_spring(engine):
    """A block at rest rides as one mass; one that leaned beyond alpha is brought back."""
    sprung, times = {"mass_ratio": 0.3, "stiffness": 20.0}, np.linspace(0.0, 1.4, 15).tolist()
    cart, calm = CartBlock(**SIZE, **sprung), SinePulse.in_g(0.2, omega=6.0)
    found = on_cart(engine, motion=calm, **sprung, duration=1.4, times=times)
    exact = simulate(cart, calm, duration=1.4, times=times)
    assert found.outcome is exact.outcome is Outcome.AT_REST
    assert found.history.base[0] == pytest.approx(exact.history.base[0], abs=1e-4)
    pulse = SinePulse.in_g(1.0, omega=20.0, half_cycles=2)
    found = on_cart(engine, motion=pulse, **sprung, duration=1.95)
    exact = simulate(cart, pulse, duration=1.95)
    assert found.outcome is exact.outcome is Outcome.ROCKED
    assert exact.peak_ratio > 1.0
    assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=2e-2)


def test_a_block_that_has_not_come_to_lie_on_a_spring_has_not_fallen():
    sprung = {"mass_ratio": 0.3, "stiffness": 60.0}
    pulse = SinePulse.in_g(0.8, omega=14.0, half_cycles=2)
    for end in (1.8, 3.0):
        exact = simulate(CartBlock(**SIZE, **sprung), pulse, duration=end)
        found = on_cart("mujoco", motion=pulse, **sprung, duration=end)
        assert found.outcome is exact.outcome
        if end == 1.8:
            assert found.peak_ratio == pytest.approx(exact.peak_ratio, rel=5e-3)
    assert exact.outcome is Outcome.OVERTURNED
