"""PyBullet stepped from a compiled loop: C functions of its extension, on the clients of Python's.

What Python sets by two calls a step is one command here, and what it reads by two is another.
"""

import ctypes
import math
import sys
from collections.abc import Sequence
from contextlib import suppress
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from engines.parts.compiled import (
    CFunction,
    FloatArray,
    State,
    exclusive,
    fill,
    shared,
    switched_off,
)
from engines.pybullet.addresses import spans
from engines.pybullet.calls import base_place
from engines.pybullet.clients import given_back, taken
from engines.pybullet.settings import BulletSettings
from engines.run.monitor import Lists, Run, onward, undecided
from engines.scene import Scene
from engines.world import ContactPhase, Step

HANDLE, NUMBER, REAL = "intp", "intc", "float64"

submit = CFunction("b3SubmitClientCommandAndWaitStatus", HANDLE, HANDLE, HANDLE)
parameters = CFunction("b3InitPhysicsParamCommand", HANDLE, HANDLE)
put_time_step = CFunction("b3PhysicsParamSetTimeStep", NUMBER, HANDLE, REAL)
put_gravity = CFunction("b3PhysicsParamSetGravity", NUMBER, HANDLE, REAL, REAL, REAL)
put_contact_erp = CFunction("b3PhysicsParamSetDefaultContactERP", NUMBER, HANDLE, REAL)
put_friction_erp = CFunction("b3PhysicsParamSetDefaultFrictionERP", NUMBER, HANDLE, REAL)
pose = CFunction("b3CreatePoseCommandInit", HANDLE, HANDLE, NUMBER)
put_place = CFunction("b3CreatePoseCommandSetBasePosition", NUMBER, HANDLE, REAL, REAL, REAL)
put_turn = CFunction(
    "b3CreatePoseCommandSetBaseOrientation", NUMBER, HANDLE, REAL, REAL, REAL, REAL
)
put_velocity = CFunction("b3CreatePoseCommandSetBaseLinearVelocity", NUMBER, HANDLE, HANDLE)
advance = CFunction("b3InitStepSimulationCommand", HANDLE, HANDLE)
state = CFunction("b3RequestActualStateCommandInit", HANDLE, HANDLE, NUMBER)
state_in = CFunction("b3GetStatusActualState", NUMBER, HANDLE, *7 * (HANDLE,))

FUNCTIONS = (
    *(submit, parameters, put_time_step, put_gravity, put_contact_erp, put_friction_erp),
    *(pose, put_place, put_turn, put_velocity, advance, state, state_in),
)

EXPORTED, CLIENTS, DIRECT = "b3ConnectPhysicsDirect", "sPhysicsClients1", "_ZTV13PhysicsDirect"
"""A function, by whose address the others are known: of the clients that Python has connected, and
of what all clients without a server begin with."""

WORD, VIRTUAL = 8, 16
"""Bytes of an address, and of what stands there before the part to which a client points."""


class ContactState(State):
    """What a step sets.

    Attributes
    ----------
    block, base : int
        Numbers of the first body, after which the others come, and of the base.
    by_phase, moving, base_velocity : bool
        Whether positions are corrected in ordinary steps alone, whether the base moves, and with a
        velocity.
    contact_erp, friction_erp : float
        Part of a position error that an ordinary step corrects.
    level : float
        Height of the base's centre [m].
    ordinary, dt : float
        The ordinary step, and the last one [s].
    """

    block: int
    base: int
    by_phase: bool
    moving: bool
    base_velocity: bool
    contact_erp: float
    friction_erp: float
    level: float
    ordinary: float
    dt: float


def begin_contact(held: ContactState, scene: Scene, s: BulletSettings, dt_s: float) -> None:
    """Prepare for a scene in ordinary steps of `dt_s` [s], but for its bodies.

    Parameters
    ----------
    held : ContactState, blank, to be filled; the numbers of body and base are left to the caller
    scene : Scene
    s : BulletSettings
    dt_s : float, ordinary step [s]
    """
    fill(
        held,
        by_phase=s.by_phase,
        moving=scene.frame == "world",
        base_velocity=s.floor == "velocity",
        contact_erp=s.contact_erp or 0.0,
        friction_erp=s.friction_erp or 0.0,
        level=base_place(scene, s)[2],
        ordinary=dt_s,
    )


class Client(NamedTuple):
    """A client, and the memory in which it is told and answers.

    Attributes
    ----------
    handle : int
        Its address.
    velocity : array (3,)
        A velocity [m/s] for it to read.
    answer : array (2,) of int
        Where it says that the two stand that follow.
    place : array (7,)
        Of a body: its position [m] and orientation, a quaternion with its real part last.
    motion : array (6,)
        And its velocity [m/s] and angular velocity [rad/s].
    state : array
        The last that was read; see `engines.world.World.state`.
    """

    handle: int
    velocity: FloatArray
    answer: NDArray[np.int64]
    place: FloatArray
    motion: FloatArray
    state: FloatArray


@exclusive
def drive(
    holds: Sequence[ContactState], client: Client, runs: Sequence[Run], lists: Lists, most: int
) -> int:
    """Take up to so many steps while the run goes on; return how many were taken.

    Parameters
    ----------
    holds : sequence of ContactState (1,), updated
    client : Client, of which state (bodies, 4) is written
    runs, lists
        As for `engines.run.monitor.onward`, updated.
    most : int, how many; with 0 the state is read, and nothing is taken

    Raises
    ------
    RuntimeError
        If the library does not say where a body is, or says it elsewhere than before.
    """
    held = holds[0]
    read(held, client)
    for before in range(most):
        take(held, client, onward(runs, lists, client.state))
        read(held, client)
        if not undecided(runs, lists, client.state):
            return before + 1
    return most


@shared
def take(held: ContactState, client: Client, step: Step) -> None:
    """Set what a step needs, and take it; held and the client are updated."""
    command = parameters(client.handle)
    put_time_step(command, step.dt_s)
    put_gravity(command, step.pull_x, 0.0, step.pull_z)
    if held.by_phase:
        normal, across = corrected(step.phase, step.dt_s, held.ordinary)
        put_contact_erp(command, normal * held.contact_erp)
        put_friction_erp(command, across * held.friction_erp)
    submit(client.handle, command)
    if held.moving:
        move_base(held, client, step)
    submit(client.handle, advance(client.handle))
    held.dt = step.dt_s


@shared
def corrected(phase: ContactPhase, dt_s: float, ordinary_s: float) -> tuple[float, float]:
    """Return the parts of a position's error to correct, along a contact's normal and across it.

    None in a step around an impact: a short step would make a velocity of it. None across at rest,
    where the places that two corners are held at contradict each other by a rounding, and the
    solver would look for a compromise until its iterations end.

    Parameters
    ----------
    phase : ContactPhase, of the step
    dt_s, ordinary_s : float, its length, and that of an ordinary one [s]

    Returns
    -------
    (float, float)
        Each from 0 to 1.
    """
    if phase == ContactPhase.APPROACH or phase == ContactPhase.STRIKE:
        return 0.0, 0.0
    part = min(1.0, dt_s / ordinary_s)
    return part * part, 0.0 if phase == ContactPhase.REST else part * part


@shared
def move_base(held: ContactState, client: Client, step: Step) -> None:
    """Give the base its velocity, or its place."""
    command = pose(client.handle, held.base)
    if held.base_velocity:
        client.velocity[0] = step.base_velocity
        put_velocity(command, client.velocity.ctypes.data)
    else:
        put_place(command, step.base_x, 0.0, held.level)
        put_turn(command, 0.0, 0.0, 0.0, 1.0)
    submit(client.handle, command)


@shared
def read(held: ContactState, client: Client) -> None:
    """Read the bodies' poses."""
    moved, q = 0.0, client.place
    if held.moving:
        ask(client, held.base)
        moved = q[0]
    for body in range(len(client.state)):
        ask(client, held.block + body)
        client.state[body, 0], client.state[body, 1] = q[0] - moved, q[2]
        client.state[body, 2], client.state[body, 3] = (
            2.0 * math.atan2(q[4], q[6]),
            client.motion[4],
        )


@shared
def ask(client: Client, body: int) -> None:
    """Let a client say where a body is, and how it moves."""
    locate(client.handle, body, client.answer)
    found, place, motion = client.answer, client.place.ctypes.data, client.motion.ctypes.data
    if found[0] != place or found[1] != motion:
        raise RuntimeError("PyBullet answers elsewhere than before")


@shared
def locate(handle: int, body: int, answer: NDArray[np.int64]) -> None:
    """Let a client write down at which addresses it says so."""
    status = submit(handle, state(handle, body))
    at = answer.ctypes.data
    if state_in(status, 0, 0, 0, 0, at, at + answer.itemsize, 0) == 0:
        raise RuntimeError("PyBullet does not say where a body is")


@exclusive
def located(handle: int, body: int, answer: NDArray[np.int64]) -> None:
    """Let a client write down where it answers; for Python."""
    locate(handle, body, answer)


@exclusive
def once(holds: Sequence[ContactState], client: Client, step: tuple[Any, ...]) -> None:
    """Take a step, and read the poses after it; for Python.

    Parameters
    ----------
    holds, client
        As for `drive`.
    step : tuple (10,), in the order of `Step`, with a number for its phase

    Raises
    ------
    RuntimeError
        As `drive`.
    """
    take(holds[0], client, Step(*step))
    read(holds[0], client)


def client_of(p: Any, number: int, body: int, state: FloatArray) -> Client:
    """Return the client of a number, in which a body is; poses are read into a state.

    Parameters
    ----------
    p : module, pybullet
    number : int, of the client, one that `clients` knows
    body : int, of any body in it
    state : ndarray (bodies, 4), written whenever poses are read

    Raises
    ------
    RuntimeError
        If the library does not say where the body is.
    """
    handle, answer = int(clients(p)[number]), np.zeros(2, np.int64)
    located(handle, body, answer)
    place, motion = answer.tolist()
    return Client(
        handle,
        np.zeros(3),
        answer,
        _memory(place, 7, np.float64),
        _memory(motion, 6, np.float64),
        state,
    )


@cache
def clients(p: Any) -> NDArray[np.int64]:
    """Return the addresses of Python's clients, by their numbers; none where they are not known."""
    with suppress(Exception):  # whatever is different about another build
        import llvmlite.binding

        llvmlite.binding.load_library_permanently(p.__file__)
        if not switched_off() and all(address_of(function.symbol) for function in FUNCTIONS):
            exported, table, kind = spans(Path(p.__file__), EXPORTED, CLIENTS, DIRECT)
            loaded = address_of(EXPORTED) - exported[0]
            if _is_one(p, loaded + table[0], loaded + kind[0] + VIRTUAL):
                return _memory(loaded + table[0], table[1] // WORD, np.int64)
    return np.zeros(0, np.int64)


def _is_one(p: Any, table: int, kind: int) -> bool:
    """Return whether a table leads to a client of a kind, where one is connected."""
    number = taken(p)
    try:
        return word_at(word_at(table + WORD * number)) == kind
    finally:
        given_back(p, number)


def word_at(address: int) -> int:
    """Return what stands in this process's memory.

    Raises
    ------
    OSError
        If it has none there, or the system does not let it be read with this care.
    """
    with Path("/proc/self/mem").open("rb", buffering=0) as memory:
        memory.seek(address)
        return int.from_bytes(memory.read(WORD), sys.byteorder)


def address_of(symbol: str) -> Any:
    """Return where a function of the library's is; None where there is none."""
    import llvmlite.binding

    return llvmlite.binding.address_of_symbol(symbol)


def _memory(address: int, count: int, kind: type[np.generic]) -> NDArray[Any]:
    memory: Any = (ctypes.c_char * (count * np.dtype(kind).itemsize)).from_address(address)
    return np.frombuffer(memory, dtype=kind)
