"""What adapters share: fall, iterations, a pivot's velocity, silence."""

import contextlib
import math
import os
import sys
import warnings
from collections.abc import Iterator
from importlib import import_module
from typing import Any

import numpy as np

from engines.run.export import Notes
from engines.scene import Scene
from engines.world import ContactPhase, Moment, Pose, Script, Step

NO_JAM = 1.3
"""Friction just below 4/3, from which on a corner of a homogeneous block may jam (Painlevé's
paradox): a solver by impulses finds no force then, and lets the corner through the base."""

MOST_ITERATIONS = 2**31 - 1
"""What fits into a library's own integer."""


def fall(scene: Scene, dt_s: float) -> float:
    """Return (alpha p dt)^2 H [m], by which a gap grows in a step dt [s] that opens at a pivot."""
    return (scene.system.alpha * scene.system.p * dt_s) ** 2 * scene.system.height


def iterations_for(scene: Scene, iterations: int | None, sweeps: float | None) -> int | None:
    """Return a solver's iterations: as asked, or sweeps/sin^2(alpha) for two corners, or None."""
    if iterations is not None or sweeps is None:
        return iterations
    return min(math.ceil(sweeps / math.sin(scene.system.alpha) ** 2), MOST_ITERATIONS)


def yaw_of(w: float, x: float, y: float, z: float) -> float:
    """Return how far a quaternion, its real part first, turns about the vertical [rad]."""
    return math.atan2(2.0 * (x * y + w * z), 1.0 - 2.0 * (y * y + z * z))


MOST_RETURNED = 2.0
"""A step that is much longer than the one before returns no more than this part of a velocity."""


def returned(step: Step, before: float) -> float:
    """Return the part of a pivot's velocity to give back, so that its mean over a step is zero.

    By its centripetal acceleration c a pivot that leaves with -c h/2 is back at the end of a step
    h, and comes into the next with c h/2, by the turn of the last (of `before` [s]). Through an
    impact, and in the first step after it, nothing is given back.
    """
    if not (before and step.side and step.phase in (ContactPhase.SWING, ContactPhase.APPROACH)):
        return 0.0
    return min(step.dt_s / before, MOST_RETURNED)


@contextlib.contextmanager
def silence() -> Iterator[None]:
    """Let nothing reach the process's output and error streams while the context lasts."""
    for stream in (sys.stdout, sys.stderr):
        if stream is not None:
            stream.flush()
    kept = {number: os.dup(number) for number in (1, 2)}
    nowhere = os.open(os.devnull, os.O_WRONLY)
    try:
        for number in kept:
            os.dup2(nowhere, number)
        yield
    finally:
        os.close(nowhere)
        for number, copy in kept.items():
            os.dup2(copy, number)
            os.close(copy)


def imported(library: str) -> Any:
    """Import a library without what it writes past Python, and without its warnings."""
    if library in sys.modules:
        return sys.modules[library]
    with silence(), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        return import_module(library)


class Adapter:
    """What worlds have alike: their settings, a base that may move, and what is read back.

    An engine has `_build`, `_read_back` and `_script`; `_way` is how a base is moved, "" at rest.
    """

    library: Any  # the name of a library, or what imports it
    moment = Moment.MIDDLE
    lag_m: Any
    _unit = 1.0
    _build: Any
    _read_back: Any
    _script: Any
    bodies: list[Any]
    called = ""  # what a script calls the library, where that is not its own name
    without: tuple[str, ...] = ()

    def __init__(self, scene: Scene, settings: Any, dt_s: float, library: Any = None) -> None:
        own = self.library
        self._library: Any = library or (own() if callable(own) else imported(own))
        self._s, self._scene, self._ordinary = settings, scene, dt_s
        self._way: str = settings.floor if scene.frame == "world" else ""
        self._dt = self._speed = self._place = self.lag_m = 0.0
        self._state = np.zeros((len(scene.bodies), len(Pose._fields)))
        self._fault: str | None = None
        self._build(scene, dt_s)

    def _came(self, step: Step, place: float | None) -> None:
        """Note where a step leads the base to: as the library says [units], or where it is put."""
        if place is not None:
            self._place, self.lag_m = place, max(self.lag_m, abs(place / self._unit - step.base_x))
        elif self._way:
            self._place = step.base_x * self._unit

    @classmethod
    def script(cls, scene: Scene, settings: Any, dt_s: float) -> Script:
        """Return a scene as calls of the library; see `engines.run.export`."""
        notes, own = Notes(cls.without), cls.library
        library = own() if callable(own) else imported(own)
        made = cls(scene, settings, dt_s, notes.of(library, cls.called or own))
        notes.name_bodies(made.bodies)
        said: Script = made._script(notes, made._way)
        return said

    def fault(self) -> str:
        """Say which setting was not taken."""
        if self._fault is None:
            self._fault = str(self._read_back(self._scene))
        return self._fault
