"""A block on a cart: a base that slides along x alone, feels the block, and is pushed by a force.

An engine that holds one has a module `cart` in its folder with a function
``build(scene, settings, dt_s) -> Cart``: it is found by its name, so that nothing else knows. The
layout stands with the others from the import of this module on.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields, replace
from enum import Enum
from importlib import import_module
from importlib.util import find_spec
from time import perf_counter
from typing import Any, NamedTuple, Protocol, cast

import numpy as np

from analytic.cart import CartBlock
from analytic.motion import FloatArray, Motion
from analytic.response import Outcome, Reason, Response
from engines.declaration import Engine, Preset, Stepping
from engines.layouts import LAYOUTS, Ability, Layout, Start, one_block
from engines.registry import find
from engines.run.drive import NotAvailableError, simulate_world
from engines.run.drive import build as built
from engines.scene import Scene
from engines.watching.history import sample
from engines.watching.swing import Row
from engines.watching.watch import LYING, LYING_PART
from engines.world import Moment, Pose, Step


class Further(Enum):
    """What a cart asks of an engine, as an `Ability` of its own."""

    FREE_BASE = "a base that feels what stands on it"


FREE_BASE = cast(Ability, Further.FREE_BASE)


class OnCart(Layout):
    """One block on a cart."""

    __slots__ = ()

    @property
    def asks(self) -> tuple[Ability, ...]:
        """What an engine must be able to do for it."""
        return (FREE_BASE,)


def on_a_cart(system: Any, density: float, depth: float | None, start: Start) -> Layout:
    """Return one block on its base, which is a cart."""
    return OnCart(*one_block(system, density, depth, start))


cast(dict[type, Callable[..., Layout]], LAYOUTS)[CartBlock] = on_a_cart


OBSERVED = 8.0
"""How long a cart on a spring, which moves on and on, is observed after the motion, in 1/p."""


class Prolonged:
    """A motion that ends later, with the base as it was left: until then nothing is decided.

    Parameters
    ----------
    motion : Motion
    duration : float
        [s].
    """

    def __init__(self, motion: Motion, duration: float) -> None:
        self._motion, self.duration = motion, duration

    def __getattr__(self, name: str) -> Any:
        return getattr(self._motion, name)

    def segments(self) -> FloatArray:
        """Return those of the motion, and one without acceleration."""
        calm = [[self._motion.duration, self.duration, 0.0, 1.0, 0.0, 0.0, 0.0]]
        return np.concatenate((self._motion.segments(), calm))


class Seen(NamedTuple):
    """What an engine says of block and cart, in the world.

    Attributes
    ----------
    pose : sequence of four floats
        Of the block, as a `Pose`, but in the world.
    speed : float
        Of the block's centre along x [m/s].
    place, cart_speed : float
        Of the cart [m, m/s]; it begins at 0.
    """

    pose: Sequence[float]
    speed: float
    place: float
    cart_speed: float


class Cart(Protocol):
    """A built cart with its block, at rest where the block begins."""

    @property
    def moment(self) -> Moment:
        """At which moment of a step the velocities hold."""

    def push(self, step: Step, force: float) -> None:
        """Advance by a step in which a force [N] along x acts on the cart, and the pull on both."""

    def seen(self) -> Seen:
        """Read both back."""

    def fault(self) -> str:
        """Say what the engine knows to have gone wrong, or return an empty string."""

    def close(self) -> None:
        """Release the engine's memory."""


def cart_mass(scene: Scene) -> float:
    """Return the mass [kg] of the cart."""
    return scene.bodies[0].mass * (1.0 / cast(CartBlock, scene.system).mass_ratio - 1.0)


class CartWorld:
    """A cart as a world whose base is the cart: poses are relative to it.

    The force (m + M) u'' of the motion pushes it, and that of the spring, constant over a step and
    from where the cart is as the velocities change.

    Attributes
    ----------
    momentum_error : float
        Largest difference [kg m/s] of the momentum from what was given.
    momentum_size : float
        Largest sum of the sizes of both momenta [kg m/s].
    """

    def __init__(self, scene: Scene, cart: Cart) -> None:
        self._cart, self._scene = cart, scene
        self._mass, self._own = scene.bodies[0].mass, cart_mass(scene)
        self._stiffness = cast(CartBlock, scene.system).stiffness
        self._seen = cart.seen()
        self._given = self._mass * scene.bodies[0].at.velocity_x
        self.momentum_error = self.momentum_size = self._peak = 0.0
        self._rows = [Row(0.0, 0.0, self._seen.place, 0.0)]

    @property
    def moment(self) -> Moment:
        """See `engines.world.World`."""
        return self._cart.moment

    def step(self, step: Step) -> None:
        """Advance by a step; see `engines.world.SteppedWorld`."""
        part = self.moment.value
        # the velocity changes at the beginning, in the middle or at the end of the way
        at = self._seen.place + (part - 0.5) * step.dt_s * self._seen.cart_speed
        impulse = (self._mass + self._own) * (step.base_kick - self._stiffness * at * step.kick_s)
        self._given += impulse
        self._cart.push(step, impulse / step.dt_s)
        self._seen = seen = self._cart.seen()
        block, own = self._mass * seen.speed, self._own * seen.cart_speed
        self.momentum_error = max(self.momentum_error, abs(block + own - self._given))
        self.momentum_size = max(self.momentum_size, abs(block) + abs(own))
        self._peak = max(self._peak, abs(seen.pose[2]))
        if self._scene.times is not None:
            at_s = step.end_s - (1.0 - part) * step.dt_s
            self._rows.append(Row(step.end_s, at_s, seen.place, seen.cart_speed))

    def state(self) -> tuple[Pose]:
        """Return the block's pose on the cart; see `engines.world.World`."""
        x, *others = self._seen.pose
        return (Pose(x - self._seen.place, *others),)

    def fault(self) -> str:
        """See `engines.world.World`."""
        return self._cart.fault()

    def close(self) -> None:
        """See `engines.world.World`."""
        self._cart.close()

    def told(self, response: Response) -> Response:
        """Return a response with what was seen of the cart beside the block.

        On a spring a block that has not come to lie when the observation ends has not overturned.
        """
        size = self.momentum_size
        part = self.momentum_error / size if size else 0.0
        seen = {"momentum_error": part, "cart_m": self._seen.place}
        up = abs(self._seen.pose[2]) < LYING_PART * LYING
        if response.outcome is Outcome.OVERTURNED and self._stiffness and up:
            peak = self._peak / self._scene.system.alpha
            response = replace(response, outcome=Outcome.ROCKED, peak_ratio=peak)
        if response.history is None:
            return replace(response, observables=seen)
        base = sample(np.array(self._rows), response.history.time.tolist())
        history = replace(response.history, base=np.array([base.theta, base.velocity]))
        return replace(response, observables=seen, history=history)


@dataclass(frozen=True, slots=True, kw_only=True)
class CartEngine(Engine):
    """An engine as it holds a cart: in equal steps alone."""

    def lacks(self, scene: Scene, preset: Preset) -> str:
        """Say what of a scene a preset cannot do, or return an empty string."""
        if preset.stepping is not Stepping.FIXED:
            return f"{self.name}:{preset.name} is not built here for {FREE_BASE.value}"
        return Engine.lacks(self, scene, preset)


def carrying(engine: Engine) -> Engine:
    """Return an engine as it holds a cart, or as it is where it holds none."""
    place = f"{engine.build.__module__.rpartition('.')[0]}.cart"
    if not place.startswith("engines.") or find_spec(place) is None:
        return engine
    known = {item.name: getattr(engine, item.name) for item in fields(engine)}
    abilities = (*engine.abilities, FREE_BASE)
    return CartEngine(**{**known, "build": import_module(place).build, "abilities": abilities})


def observed(scene: Scene) -> Scene:
    """Return a scene of a cart on a spring with its end, and shaken until then.

    A block on one that leans by more than alpha may still come back, as one that is shaken may.
    """
    if cast(CartBlock, scene.system).stiffness == 0.0:
        return scene
    end = scene.duration or scene.motion.duration + OBSERVED / scene.system.p
    if end <= scene.motion.duration:
        return scene
    return replace(scene, duration=end, motion=cast(Motion, Prolonged(scene.motion, end)))


def ride(name: str, scene: Scene) -> Response:
    """Simulate a block on a cart with an engine.

    Returns
    -------
    Response
        As of `engines.run.drive.run`. Its observables are momentum_error, the largest difference of
        the horizontal momentum from what push and spring gave, over the largest sum of both
        bodies', and cart_m, the cart's last place [m]; its history has the cart's. One on a spring
        is observed for 8/p after the motion where the scene says no duration.

    Raises
    ------
    ValueError
        If the engine is unknown, or a preset or setting is not one of the engine's.
    """
    began, engine = perf_counter(), carrying(find(name))
    preset = engine.used_for(scene)
    if scene.frame == "base":
        words = "not available: a cart moves in the frame 'world', and frame is 'base'"
        return Response.failure(words, reason=Reason.UNAVAILABLE)
    scene = observed(replace(scene, frame="world"))
    try:
        cart = cast(Cart, built(engine, scene))
    except NotAvailableError as error:
        return Response.failure(str(error), reason=Reason.UNAVAILABLE)
    world, setup_s = CartWorld(scene, cart), perf_counter() - began
    dt_s, resolution = preset.ordinary_step_s(scene), engine.resolution(scene.system)
    try:
        found = simulate_world(world, scene, dt_s, preset.stepping, resolution)
    finally:
        world.close()
    said = [] if scene.preset or preset is engine.best else [f"as {name}:{preset.name}"]
    message = "; ".join(filter(None, (*said, found.message)))
    return replace(world.told(found), setup_s=setup_s, driver="python", message=message)
