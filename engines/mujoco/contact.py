"""How MuJoCo's contact holds a block, step by step: set before a step, looked at after it.

The functions read and write the library's own arrays. They are compiled, and serve both who steps
from Python and who steps from a compiled loop.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from engines.mujoco.model import direct_reference
from engines.mujoco.settings import MujocoSettings
from engines.parts.compiled import FloatArray, State, fill, kernel, shared
from engines.parts.reflection import Reflection, begin_reflection, part_of, take_in
from engines.scene import Scene
from engines.world import Grip, Pose, Step

FEEBLE = 1e-15
"""k dt^2 where positions are to be left alone; the library takes a zero for something else."""

LEAST_HELD = 1e-3
"""Part of what the whole weight would press a corner by, up to which landing holds one at rest."""

UNSET, SCALED, DIRECT = range(3)
"""Forms of the contact's reference: the library's own, its time constant in steps, b and k."""


class Hold(State):
    """What holds a block, and what was seen of it.

    Attributes
    ----------
    planar, moving, base_velocity : bool
        Whether the block has three coordinates, whether the base moves, and with a velocity.
    width, height : float
        Of the block, the half of the latter [m].
    form : int
        Of the contact's reference, one of `UNSET`, `SCALED`, `DIRECT`.
    time_constant, ratio : float
        The two numbers of `SCALED`, the first one over the step.
    damping, sliding_damping, stiffness, impedance : float
        Those of `DIRECT`, without units.
    by_step, by_phase, reflects, preload : bool
        Whether the contact changes with every step, and what for.
    carry : float
        Gap [m] within which the pivot stays in contact; 0 for no such thing.
    pairs, corners : int
        Pairs that touch, and how many of them at each side.
    weight : float
        Of the block, over the corners at a side [N].
    ordinary_squared, impedance_squared : float
        Squares of the ordinary step and of the impedance.
    dt, time : float
        Length and end of the last step [s].
    yields : float
        By how much [m/s2] a corner that carries the block yields to its force.
    sliding : float
        Damping along the base in this step.
    moved, velocity : float
        Place [m] and velocity [m/s] of the base.
    reflection : Reflection
    """

    planar: bool
    moving: bool
    base_velocity: bool
    width: float
    height: float
    form: int
    time_constant: float
    ratio: float
    damping: float
    sliding_damping: float
    stiffness: float
    impedance: float
    by_step: bool
    by_phase: bool
    reflects: bool
    preload: bool
    carry: float
    pairs: int
    corners: int
    weight: float
    ordinary_squared: float
    impedance_squared: float
    dt: float
    time: float
    yields: float
    sliding: float
    moved: float
    velocity: float
    reflection: Reflection


class Arrays(NamedTuple):
    """The library's arrays, and two of the same lengths as its pairs.

    resisted is by how much [m/s2] each corner yields at rest; sides is +1 for corners at -x, -1 for
    those at +x, and 0 for a single pair.
    """

    position: FloatArray
    velocity: FloatArray
    gravity: FloatArray
    pair_reference: FloatArray
    pair_friction: FloatArray
    pair_margin: FloatArray
    geom_reference: FloatArray
    surface_velocity: FloatArray
    base_place: FloatArray
    resisted: FloatArray
    sides: FloatArray


class Forces(NamedTuple):
    """What the solver says of a step: how many contacts and rows, and of each its R and force."""

    contacts: int
    rows: int
    resistance: FloatArray
    force: FloatArray


def begin_hold(held: Hold, scene: Scene, s: MujocoSettings, dt_s: float, pairs: int) -> None:
    """Prepare for a scene in ordinary steps of `dt_s` [s], of which so many pairs touch."""
    corners = max(pairs // 2, 1)
    impedance = 1.0 if s.impedance is None else s.impedance[1]
    sliding = 1.0 if s.sliding_damping is None else s.sliding_damping
    fill(
        held,
        planar=s.planar,
        moving=scene.frame == "world",
        base_velocity=s.base_velocity,
        width=scene.block.width,
        height=0.5 * scene.block.height,
        damping=s.damping or 0.0,
        sliding_damping=sliding,
        sliding=sliding,
        stiffness=s.stiffness or 0.0,
        impedance=impedance,
        by_step=s.by_phase or s.reflection or s.carry is not None,
        by_phase=s.by_phase,
        reflects=s.reflection,
        preload=s.preload,
        carry=(s.carry or 0.0) * scene.block.width,
        pairs=pairs,
        corners=corners,
        weight=scene.mass * scene.block.gravity / corners,
        ordinary_squared=dt_s**2,
        impedance_squared=impedance**2,
        yields=(1.0 - impedance) * scene.block.gravity,
    )
    if s.solref is not None:
        fill(held, form=SCALED, time_constant=s.solref[0], ratio=s.solref[1])
    elif s.damping is not None:
        held.form = DIRECT
    begin_reflection(held.reflection, scene, dt_s)


def arrays_of(model: Any, data: Any, held: Hold) -> Arrays:
    """Return the library's arrays, which share its memory."""
    pairs = int(held.pairs)
    return Arrays(
        data.qpos,
        data.qvel,
        model.opt.gravity,
        model.pair_solref,
        model.pair_solreffriction,
        model.pair_margin,
        model.geom_solref,
        getattr(model, "geom_surfacevel", np.zeros((0, 3))),  # only a base that moves needs it
        data.mocap_pos,
        np.full(pairs, 0.5 * held.yields),
        np.repeat((1.0, -1.0), pairs // 2) if pairs > 1 else np.zeros(pairs),
    )


@kernel
def pose_now(holds: Sequence[Hold], arrays: tuple[FloatArray, ...]) -> tuple[float, ...]:
    """Return the block's pose, for Python."""
    pose = pose_of(holds[0], Arrays(*arrays))
    return pose.x, pose.z, pose.theta, pose.rate


@kernel
def prepare_step(
    holds: Sequence[Hold], arrays: tuple[FloatArray, ...], step: tuple[Any, ...]
) -> None:
    """Set what a step needs, but for its length; for Python."""
    prepare(holds[0], Arrays(*arrays), Step(*step))


@kernel
def notice_step(
    holds: Sequence[Hold],
    arrays: tuple[FloatArray, ...],
    forces: tuple[int, int, FloatArray, FloatArray],
    step: tuple[Any, ...],
) -> None:
    """Note what a step has done, for the next one; for Python."""
    notice(holds[0], Arrays(*arrays), Forces(*forces), Step(*step))


@shared
def pose_of(held: Hold, arrays: Arrays) -> Pose:
    """Return the block's pose."""
    q, v = arrays.position, arrays.velocity
    if held.planar:
        return Pose(q[0] - held.moved, q[1] + held.height, q[2], v[2])
    return Pose(q[0] - held.moved, q[2], 2.0 * math.atan2(q[5], q[3]), v[4])


@shared
def prepare(held: Hold, arrays: Arrays, step: Step) -> None:
    """Set what a step needs, but for its length."""
    if step.dt_s != held.dt or held.by_step:
        held.dt = step.dt_s
        set_reference(held, arrays, step)
    arrays.gravity[0], arrays.gravity[2] = step.pull_x, step.pull_z
    if held.moving:
        move_base(held, arrays, step)


@shared
def set_reference(held: Hold, arrays: Arrays, step: Step) -> None:
    """Set the contact in units of the step."""
    dt = step.dt_s
    if held.form == SCALED:
        put_pair(arrays.pair_reference, held.time_constant * dt, held.ratio)
        put_pair(arrays.geom_reference, held.time_constant * dt, held.ratio)
    if held.form != DIRECT:
        return
    back = part_of(held.reflection, step) if held.reflects else 0.0
    firm = held.stiffness
    if held.by_phase and (step.side != 0.0 or step.grip != Grip.REST):
        firm = FEEBLE
    held.sliding = held.sliding_damping + back
    k, b = direct_reference(held.impedance, dt, firm, held.damping + back)
    put_pair(arrays.pair_reference, k, b)
    k, b = direct_reference(held.impedance, dt, firm, held.sliding)
    put_pair(arrays.pair_friction, k, b)
    if held.carry != 0.0:
        set_reach(held, arrays, step)


@shared
def put(numbers: FloatArray, value: float) -> None:
    """Write a number into every place."""
    for i in range(len(numbers)):
        numbers[i] = value


@shared
def put_pair(table: FloatArray, first: float, second: float) -> None:
    """Write two numbers into every row."""
    for row in range(len(table)):
        table[row, 0], table[row, 1] = first, second


@shared
def set_reach(held: Hold, arrays: Arrays, step: Step) -> None:
    """Set from which gap on each contact acts, and preload the one that carries the block."""
    margin, sag = arrays.pair_margin, held.yields * held.ordinary_squared
    if step.grip != Grip.REST:
        put(margin, 0.0)
        put(arrays.resisted, 0.5 * held.yields)
    elif step.side != 0.0:
        # the free corner, about to lift, is still in reach where no weight presses it
        put(margin, sag)
    else:
        hold_at_rest(held, arrays, step)
    if step.side == 0.0:
        return
    if held.pairs == 1:
        # all corners of a box share one pair, and the free one must not touch early
        lean = 0.5 * held.width * abs(pose_of(held, arrays).theta)
        put(margin, max(sag, min(held.carry, lean)))
        return
    first = 0 if step.side < 0.0 else held.corners
    for pivot in range(first, first + held.corners):
        margin[pivot] = held.carry
        if held.preload:
            preload = held.yields * step.kick_s / step.dt_s
            arrays.pair_reference[pivot, 0] = -preload * held.impedance_squared / held.carry


@shared
def hold_at_rest(held: Hold, arrays: Arrays, step: Step) -> None:
    """Hold each corner from the gap [m] on to which what it carries presses it to the base.

    Were all the same, the block would lean on the corner that carries more. A corner that is
    higher is held from where it is, and comes down.
    """
    reach = step.kick_s * step.dt_s
    all_of_it = held.yields * reach
    pose = pose_of(held, arrays)
    level = pose.z - held.height * math.cos(pose.theta)
    raised = 0.5 * held.width * math.sin(pose.theta)
    for corner in range(held.pairs):
        gap = level + arrays.sides[corner] * raised
        pressed = min(max(gap, arrays.resisted[corner] * reach), all_of_it)
        arrays.pair_margin[corner] = pressed + LEAST_HELD * all_of_it


@shared
def move_base(held: Hold, arrays: Arrays, step: Step) -> None:
    """Set the place from which the base sets out, and its surface velocity."""
    before, held.velocity = held.velocity, step.base_velocity
    # the contact turns the slip v- - V into (1 - b dt) times as much, so that a point which
    # moved with the base before moves with the base after
    if held.base_velocity:
        arrays.surface_velocity[0, 0] = before + step.base_kick / held.sliding
    arrays.base_place[0, 0] = held.moved


@shared
def notice(held: Hold, arrays: Arrays, forces: Forces, step: Step) -> None:
    """Note what a step has done, for the next one."""
    held.moved = step.base_x if held.moving else 0.0
    held.time += step.dt_s
    if held.carry != 0.0:
        look_at_yield(held, arrays, forces, step)
    if held.reflects:
        take_in(held.reflection, step, pose_of(held, arrays).rate)


@shared
def look_at_yield(held: Hold, arrays: Arrays, forces: Forces, step: Step) -> None:
    """Note by how much [m/s2] the corners yield to their forces."""
    if step.grip == Grip.REST and forces.rows > 0:
        held.yields = forces.resistance[0] * held.weight
        if forces.contacts == held.pairs and held.pairs > 1:
            stride = forces.rows // forces.contacts
            for corner in range(held.pairs):
                normal = corner * stride
                yielded = forces.resistance[normal] * forces.force[normal]
                arrays.resisted[corner] = yielded * (step.dt_s / step.kick_s)
    elif step.grip == Grip.SWING and forces.contacts == held.corners:
        yielded = forces.resistance[0] * forces.force[0]
        held.yields = yielded * step.dt_s / step.kick_s
