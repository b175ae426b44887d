"""How MuJoCo's contact holds a block, step by step: set before a step, looked at after it.

The functions read and write the library's own arrays; Python calls them, or a compiled loop does
(`engines.mujoco.loop`). In all of them held is what is known of the block and of what holds it,
arrays are the library's, step is the one that follows, or that was taken, and pair is the number of
a row of arrays.pairs.
"""

import math

from engines.mujoco.contact_state import (
    BODY,
    DIRECT,
    FACE,
    ON,
    PIVOT,
    RESISTED,
    SCALED,
    SIDE,
    WEIGHT,
    YIELDS,
    Arrays,
    ContactState,
    Forces,
)
from engines.mujoco.model import direct_reference
from engines.parts.compiled import shared
from engines.parts.reflection import part_of, take_in
from engines.scene import LOWER
from engines.world import ContactPhase, FloatArray, Pose, Step

FEEBLE = 1e-15
"""k dt^2 where positions are to be left alone; the library takes a zero for something else."""

LEAST_HELD = 1e-3
"""Part of what the whole weight would press a corner by, up to which landing holds one at rest."""

FREE, WELDED = 7, 6
"""Coordinates of a free joint, and the solver's rows of a weld, which come before the contacts'."""


@shared
def pose_of(held: ContactState, arrays: Arrays, body: int = 0) -> Pose:
    """Return the pose of a body [m, rad, rad/s] relative to the base, by its number."""
    q, v = arrays.position, arrays.velocity
    if held.planar:
        x, z = arrays.homes[body, 0], arrays.homes[body, 1]
        i = 3 * body
        return Pose(q[i] + x - held.moved, q[i + 1] + z - held.raised, q[i + 2], v[i + 2])
    i, j = 7 * body, 6 * body
    theta = 2.0 * math.atan2(q[i + 5], q[i + 3])
    return Pose(q[i] - held.moved, q[i + 2] - held.raised, theta, v[j + 4])


@shared
def read(held: ContactState, arrays: Arrays) -> None:
    """Read the state: write every body's `Pose` into a row of it.

    Parameters
    ----------
    held : ContactState, of which the place of the base is used
    arrays : Arrays, of which state (bodies, 4) is written
    """
    for body in range(len(arrays.homes)):
        pose = pose_of(held, arrays, body)
        arrays.state[body, 0], arrays.state[body, 1] = pose.x, pose.z
        arrays.state[body, 2], arrays.state[body, 3] = pose.theta, pose.rate


@shared
def prepare(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Set what a step needs, but for its length.

    Parameters
    ----------
    held : ContactState, updated
    arrays : Arrays, written: gravity, references and margins of contacts, the column `RESISTED` of
        pairs, place and velocity of a base that moves
    step : Step, that follows
    """
    if step.dt_s != held.dt or held.by_step:
        held.dt = step.dt_s
        set_reference(held, arrays, step)
    arrays.gravity[0], arrays.gravity[2] = step.pull_x, step.pull_z
    if held.moving:
        move_base(held, arrays, step)


@shared
def set_reference(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Set the contact in units of the step."""
    dt = step.dt_s
    if held.form == SCALED:
        put_pair(arrays.pair_reference, held.time_constant * dt, held.ratio)
        put_pair(arrays.geom_reference, held.time_constant * dt, held.ratio)
    if held.form != DIRECT:
        return
    back = part_of(held.reflection, step) if held.reflects else 0.0
    firm = held.stiffness
    if held.by_phase and (step.side != 0.0 or step.phase != ContactPhase.REST):
        firm = FEEBLE
    held.sliding = held.sliding_damping + back
    k, b = direct_reference(held.impedance, dt, firm, held.damping + back)
    put_pair(arrays.pair_reference, k, b)
    k, b = direct_reference(held.impedance, dt, firm, held.sliding)
    put_pair(arrays.pair_friction, k, b)
    if held.carry != 0.0:
        set_reach(held, arrays, step)


@shared
def put_pair(table: FloatArray, first: float, second: float) -> None:
    """Write two numbers into every row of a table (k, 2)."""
    for row in range(len(table)):
        table[row, 0], table[row, 1] = first, second


@shared
def set_reach(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Set from which gap [m] on each contact acts, and preload the one that carries the block."""
    if step.phase == ContactPhase.REST and step.side == 0.0:
        hold_at_rest(held, arrays, step)
        return
    margin, pairs = arrays.pair_margin, arrays.pairs
    for i in range(held.pairs):
        # the free corner, about to lift, is still in reach where no weight presses it
        sag = pairs[i, YIELDS] * held.ordinary_squared
        margin[i] = sag if step.phase == ContactPhase.REST else 0.0
        if step.phase != ContactPhase.REST:
            pairs[i, RESISTED] = 0.5 * pairs[i, YIELDS]
        if step.side == 0.0:
            continue
        if held.single:
            # all corners of a box share one pair, and the free one must not touch early
            theta = pose_of(held, arrays, int(pairs[i, BODY])).theta
            margin[i] = max(sag, min(held.carry, 0.5 * held.width * abs(theta)))
        elif pairs[i, PIVOT] == step.side:
            hold_pivot(held, arrays, step, i)
        elif held.stacked and step.phase >= ContactPhase.APPROACH:
            # a rounding apart, those above would close a step before those below, or after
            margin[i] = held.carry if step.phase == ContactPhase.STRIKE else -held.carry


@shared
def hold_pivot(held: ContactState, arrays: Arrays, step: Step, pair: int) -> None:
    """Keep a pivot in contact, and press it."""
    arrays.pair_margin[pair] = held.carry
    if held.preload:
        preload = arrays.pairs[pair, YIELDS] * step.kick_s / step.dt_s
        arrays.pair_reference[pair, 0] = -preload * held.impedance_squared / held.carry


@shared
def hold_at_rest(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Hold each corner from the gap [m] on to which what it carries presses it to the base.

    Were all the same, the block would lean on the corner that carries more. A corner that is
    higher is held from where it is, and comes down.
    """
    reach = step.kick_s * step.dt_s
    for i in range(held.pairs):
        all_of_it = arrays.pairs[i, YIELDS] * reach
        resisted = arrays.pairs[i, RESISTED] * reach
        pressed = min(max(gap_of(held, arrays, i), resisted), all_of_it)
        arrays.pair_margin[i] = pressed + LEAST_HELD * all_of_it


@shared
def gap_of(held: ContactState, arrays: Arrays, pair: int) -> float:
    """Return the gap [m] between a corner and what it touches, both about upright."""
    row = arrays.pairs[pair]
    pose = pose_of(held, arrays, int(row[BODY]))
    raised = 0.5 * held.width * math.sin(pose.theta)
    if row[FACE] == LOWER:
        level = pose.z - held.height * math.cos(pose.theta)
        return level + row[SIDE] * raised
    on = int(row[ON])
    under = pose_of(held, arrays, on).z - arrays.homes[on, 2]
    return under - (pose.z + held.height * math.cos(pose.theta) + row[SIDE] * raised)


@shared
def move_base(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Set the place from which the base sets out, and its surface velocity; or where it goes."""
    before, held.velocity = held.velocity, step.base_velocity
    # the contact turns the slip v- - V into (1 - b dt) times as much, so that a point which
    # moved with the base before moves with the base after
    if held.base_velocity:
        arrays.surface_velocity[0, 0] = before + step.base_kick / held.sliding
    arrays.base_place[0, 0] = step.base_x if held.welded else held.moved


@shared
def notice(held: ContactState, arrays: Arrays, forces: Forces, step: Step) -> None:
    """Note what a step has done, for the next one.

    Parameters
    ----------
    held : ContactState, updated: the time, the place of the base, how fast the block turns
    arrays : Arrays, of which the columns `YIELDS` and `RESISTED` of pairs are written [m/s2]
    forces : Forces, of that step
    step : Step, that was taken
    """
    held.moved = step.base_x if held.moving else 0.0
    if held.welded:
        look_at_base(held, arrays, step)
    held.time += step.dt_s
    if held.carry != 0.0:
        look_at_yield(held, arrays, forces, step)
    if held.reflects:
        take_in(held.reflection, step, pose_of(held, arrays).rate)


@shared
def look_at_base(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Note where a welded base is [m], whose joint is the last, and how far off."""
    at = len(arrays.position) - FREE
    held.moved = arrays.position[at]
    held.raised = arrays.position[at + 2] - arrays.base_place[0, 2]
    held.lag = max(held.lag, abs(held.moved - step.base_x))


@shared
def look_at_yield(held: ContactState, arrays: Arrays, forces: Forces, step: Step) -> None:
    """Note by how much [m/s2] the corners yield to their forces.

    Where all touch, or all pivots, the solver's contacts are theirs in the order of the pairs; the
    first of those between two bodies speaks for all.
    """
    pairs, count, weld = arrays.pairs, forces.contacts, WELDED if held.welded else 0
    if count == 0:
        return
    stride, each = (forces.rows - weld) // count, held.pairs // held.touching
    whole, pivots = count == held.pairs, count == held.touching * held.corners
    if step.phase == ContactPhase.REST and (whole or not held.stacked):
        for i in range(held.pairs):
            first = weld + (i // each * each * stride if whole else 0)
            pairs[i, YIELDS] = forces.resistance[first] * pairs[i, WEIGHT]
            if whole and held.pairs > 1:
                row = weld + i * stride
                yielded = forces.resistance[row] * forces.force[row]
                pairs[i, RESISTED] = yielded * (step.dt_s / step.kick_s)
    elif step.phase == ContactPhase.SWING and pivots:
        for i in range(held.pairs):
            first = weld + i // each * held.corners * stride
            yielded = forces.resistance[first] * forces.force[first]
            pairs[i, YIELDS] = yielded * step.dt_s / step.kick_s
