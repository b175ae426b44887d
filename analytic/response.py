"""What every source answers: the outcome of a case, its peak, its impacts, what it cost."""

import enum
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray


class Outcome(enum.Enum):
    """How a response ends."""

    AT_REST = "at rest"
    ROCKED = "rocked"
    OVERTURNED = "overturned"
    SLID = "slid"
    FAILED = "failed"


class Reason(enum.Enum):
    """Why there is no usable result; the value is the sentence that a reader sees."""

    DIVERGED = "the state is not finite"
    SANK = "the block sank through the base"
    THROWN = "the block was thrown off the base"
    SLID = "the pivot slid away along the base"
    PARTED = "the columns of a frame parted"
    UNDECIDED = "not decided within the limits of time and steps"
    FAULT = "the engine reports a fault of its own"
    UNAVAILABLE = "the engine cannot do what was asked, or is not installed"
    ERROR = "an error of the program, or a process that died"


class Problem(NamedTuple):
    """A reason, and the message with its numbers."""

    reason: Reason
    message: str


class Impact(NamedTuple):
    """An impact of the block on its base, when the rotation passes through zero.

    time [s]; velocity_before and velocity_after are angular velocities [rad/s] with their signs.
    """

    time: float
    velocity_before: float
    velocity_after: float

    @property
    def ratio(self) -> float:
        """Velocity ratio, to be compared with `RigidBlock.restitution`."""
        return self.velocity_after / self.velocity_before


@dataclass(frozen=True, slots=True)
class History:
    """A sampled response: time [s], rotation theta [rad], angular velocity [rad/s], equal lengths.

    A history ends where its response ends, for instance when the block lies on its side. Of a
    `SlidingBlock`, theta holds its place [m] and velocity its rate [m/s], relative to the base.
    """

    time: NDArray[np.float64]
    theta: NDArray[np.float64]
    velocity: NDArray[np.float64]


@dataclass(frozen=True, slots=True, kw_only=True)
class Response:
    """The response of a block to a base motion, from whichever source.

    Attributes
    ----------
    outcome, reason, message
        What happened; why it failed, without numbers and with them, or what to know about it.
    peak_ratio : float
        Largest abs(theta)/alpha; inf when overturned, 0 at rest or slid, nan when failed. An engine
        at rest has the angle by which its block leaned in the contact.
    peak_sides : (float, float)
        The same of the right side, theta > 0, and of the left one, each over its own alpha.
    crossed : bool
        Whether abs(theta) exceeded alpha at some time; such a block may still survive.
    impacts : tuple of Impact
        Impacts until the peak is decided, or until `duration` where one was asked for. Of the
        infinitely many impacts before a rest, those that were resolved.
    uplifts, rests : tuple of float
        Times [s] at which the block leaves its rest, and comes to rest again.
    slips, slip_times : tuple
        Displacements [m] relative to the base, signed, one a slip: from where the rate relative to
        the base leaves zero to where it vanishes; and begin and end [s] of each.
    steps, wall_s, setup_s
        Steps of the integrator or engine; seconds spent on them, without compiling; and seconds
        spent before, where that was measured.
    history : History or None
        Present when samples were asked for.
    min_normal, friction_needed : float
        Smallest normal force over weight, and largest abs(horizontal)/normal force, that the
        no-lift-off, no-slip reference needs, of a block that overturns until it passes the critical
        rotation for good; nan where a source does not report them, and for a block that
        is not homogeneous.
    slip_m, sink_m, hop_m : float
        Of an engine: the largest distance [m] that its contact slid, the largest depth of its
        lowest corner in the base, and the largest height above it.
    observables : mapping
        Name -> value of what else its scene shows: of a frame how far its bodies came apart, ...
    """

    outcome: Outcome
    peak_ratio: float
    peak_sides: tuple[float, float] = (float("nan"), float("nan"))
    crossed: bool = False
    impacts: tuple[Impact, ...] = ()
    uplifts: tuple[float, ...] = ()
    rests: tuple[float, ...] = ()
    slips: tuple[float, ...] = ()
    slip_times: tuple[tuple[float, float], ...] = ()
    steps: int = 0
    wall_s: float = 0.0
    setup_s: float = 0.0
    message: str = ""
    reason: Reason | None = None
    history: History | None = field(default=None, repr=False)
    min_normal: float = float("nan")
    friction_needed: float = float("nan")
    slip_m: float = float("nan")
    sink_m: float = float("nan")
    hop_m: float = float("nan")
    observables: Mapping[str, float] = field(default_factory=dict)

    @classmethod
    def failure(
        cls, message: str, *, reason: Reason = Reason.ERROR, steps: int = 0, wall_s: float = 0.0
    ) -> "Response":
        """Make a failed response with its reason."""
        return cls(
            outcome=Outcome.FAILED,
            peak_ratio=float("nan"),
            steps=steps,
            wall_s=wall_s,
            message=message,
            reason=reason,
        )
