"""A block on a cart: a base that slides along x alone, feels the block, and is pushed by a force.

An engine that holds one says what builds its `Cart` (`engines.declaration.Engine.builders`), by
``partial(CartWorld, MyCart)``.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any, NamedTuple, Protocol, cast

import numpy as np

from analytic.motion import FloatArray, Motion
from analytic.response import Outcome, Response
from engines.scene import Scene
from engines.watching.history import sample
from engines.watching.swing import Row
from engines.watching.watch import LYING, LYING_PART
from engines.world import Moment, Pose, Step

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
    system: Any = scene.system
    return float(scene.bodies[0].mass * (1.0 / system.mass_ratio - 1.0))


class CartWorld:
    """A cart as a world whose base is the cart: poses are relative to it.

    The force (m + M) u'' of the motion pushes it, and that of the spring, constant over a step and
    from where the cart is as the velocities change.

    Parameters
    ----------
    make : callable
        ``(scene, settings, dt_s) -> Cart``.
    scene, settings, dt_s
        As of `engines.declaration.Engine.build`.

    Attributes
    ----------
    momentum_error : float
        Largest difference [kg m/s] of the momentum from what was given.
    momentum_size : float
        Largest sum of the sizes of both momenta [kg m/s].
    """

    def __init__(
        self, make: Callable[[Scene, Any, float], Cart], scene: Scene, settings: Any, dt_s: float
    ) -> None:
        self._cart, self._scene = make(scene, settings, dt_s), scene
        self._mass, self._own = scene.bodies[0].mass, cart_mass(scene)
        self._stiffness = cast(Any, scene.system).stiffness
        self._seen = self._cart.seen()
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

    def observed(self, scene: Scene) -> Scene:
        """Return a scene of a cart on a spring with its end, and shaken until then.

        A block on one that leans by more than alpha may still come back, as one that is shaken may.
        """
        end = scene.duration or scene.motion.duration + OBSERVED / scene.system.p
        if self._stiffness == 0.0 or end <= scene.motion.duration:
            return scene
        return replace(scene, duration=end, motion=cast(Motion, Prolonged(scene.motion, end)))

    def told(self, response: Response) -> Response:
        """Return a response with what was seen of the cart beside the block.

        On a spring a block that has not come to lie when the observation ends has not overturned.

        Returns
        -------
        Response
            Its observables are momentum_error, the largest difference of the horizontal momentum
            from what push and spring gave, over the largest sum of both bodies', and cart_m, the
            cart's last place [m]; its history has the cart's.
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
