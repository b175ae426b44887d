"""What a built scene is told and must answer: steps, states, and the moment of a velocity."""

import enum
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, Protocol

import numpy as np
from numpy.typing import NDArray

FloatArray = NDArray[np.float64]


class Moment(enum.Enum):
    """At which part of a step the velocity holds that is read after it."""

    MIDDLE = 0.5
    """The velocity was changed first, and has carried the block through the step (leapfrog)."""
    END = 1.0
    """Position and velocity belong to the same time."""
    NEXT = 1.5
    """The position was changed first; the velocity will carry the block through the next step."""


ROUNDINGS = 16.0
"""Error of the height of a corner above the base, in roundings of the block's height."""

REST_FACTOR = 8.0
"""Longest step of a block at rest that nothing can lift yet, in ordinary steps."""


class Resolution(NamedTuple):
    """What numbers tell apart; rest_factor is the longest step at rest over the ordinary one."""

    length_m: float = 0.0
    time_s: float = 0.0
    part: float = 0.0
    rest_factor: float = REST_FACTOR


UNLIMITED = Resolution()


class ContactPhase(enum.IntEnum):
    """What a step is for: a rest, a turn about a corner, coming near an impact, the impact."""

    REST = 0
    SWING = 1
    APPROACH = 2
    STRIKE = 3


class Choice(NamedTuple):
    """How long a step is [s], what it is for, the corner turned about; never what comes of it."""

    dt_s: float
    phase: ContactPhase
    side: float


class Step(NamedTuple):
    """A step of a policy, and what the base does meanwhile."""

    dt_s: float  # how far it goes [s]
    end_s: float  # the time at its end [s]
    # for how long forces act on the velocity [s], from the moment of the last one to this
    kick_s: float
    # gravity [m/s2] along the base, for the body force -m u_g'', which is 0 in the frame "world"
    pull_x: float
    # gravity [m/s2] by which `dt_s` gives the velocity what `kick_s` of weight does, and the body
    # force of a base that moves vertically, too
    pull_z: float
    base_kick: float  # change of the base's velocity in `kick_s` [m/s]
    base_velocity: float  # the base's, whose mean over the step leads to its place [m/s]
    base_x: float  # the base's place at its end [m]
    phase: ContactPhase  # what it is for
    side: float  # the corner turned about, -1 or 1, or 0 where both hold
    base_rise: float = 0.0  # the base's velocity upwards [m/s], and its height at the end [m]
    base_z: float = 0.0


class Pose(NamedTuple):
    """The centre of mass from base and beginning [m], the lean towards +x [rad], its rate."""

    x: float
    z: float
    theta: float
    rate: float


class World(Protocol):
    """A built scene, its bodies where and as fast as `Scene.bodies` says.

    It may have more: ``advance(end_s)`` where the engine chooses its own steps, which goes on to a
    time [s], the base moving as the scene says, and returns the steps taken. Where its base moves,
    ``lag_m`` is the largest distance [m] of the base, at the end of a step, from where it should
    have been, and ``base_x_m`` where the base is [m] as the state is read: poses are relative to
    it. ``yaw`` is how far the first body has turned about the vertical [rad], None in the plane.
    ``drive(runs, lists, most)`` takes up to so many steps as long as the run goes on, in a
    compiled loop of the functions of `engines.run.look`, and returns how many; it is None where the
    library is not as it should be for it.
    """

    @property
    def moment(self) -> Moment:
        """At which moment of a step the velocities of a state hold."""

    def step(self, step: Step) -> None:
        """Advance by a step."""

    def state(self) -> Sequence[Sequence[float]] | FloatArray:
        """Read every body's `Pose` back, a row each; the next call may overwrite the rows."""

    def fault(self) -> str:
        """Say what the engine knows to have gone wrong, now and then, or return an empty string."""

    def close(self) -> None:
        """Release the engine's memory."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Script:
    """What an engine's declaration writes of a scene: Python for the library, without this project.

    A script that is the same for all engines shakes the base with it, and watches the rotation.
    """

    imports: tuple[str, ...]  # lines that import the library
    settings: tuple[str, ...]  # lines that set what a reader would copy
    # lines that build the scene and list its `bodies`; `HERE` is the folder of the script
    build: tuple[str, ...]
    # lines that take a step of `DT` [s] under gravity, `pull_x` and `pull_z` [m/s2]; a base that
    # moves comes to `base_x` [m] by a mean `base_velocity` [m/s]
    step: tuple[str, ...]
    pose: tuple[str, ...]  # lines that read `theta` [rad] and `rate` [rad/s] of body `number`
    place: str  # how far the first body's centre is along the base, which is to be at `base_x` [m]
    moment: Moment = Moment.MIDDLE  # of a step, at which the velocity holds
    # name -> text of what lies beside the script
    files: Mapping[str, str] = field(default_factory=dict)
