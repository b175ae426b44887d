"""How MuJoCo's contact holds a block, step by step: set before a step, looked at after it.

A contact holds its points to the acceleration -b v - k r, v being their velocity and r the gap; b
and k are the two numbers of `solref`, negative. Four things are set with a step:

- b dt and k dt^2 are kept, so that b and k go with the step;
- *reflection* (`engines.parts.returned`): a pivot comes into a step h with c h/2, or with c h if it
  was held and not returned before. Were that taken out (b dt = 1), it would creep, an error of
  first order; it is given back (b dt = 1 + part), not through an impact, nor just after it;
- *margin*: a pivot rises by (theta' dt)^2 R/2 in a step, and would lose its contact: that of a
  pivot acts from a gap on (`carry`), those of the others from the depth at which they carry the
  weight, so that the free corner strikes when it touches, not before;
- *preload*: within the margin a contact pulls by k times the gap. The pivot's k is chosen so that
  this makes up for what the contact yields to its load (R f, of the last step).

The functions read and write the library's own arrays; Python calls them, or a compiled loop does
(`engines.mujoco.loop`). In all of them held is what is known of the block and of what holds it,
arrays are the library's, step is the one that follows, or that was taken, and pair is the number of
a row of arrays.pairs.
"""

import math
from dataclasses import dataclass
from typing import NamedTuple

from engines.scene import LOWER
from engines.world import ContactPhase, FloatArray, Step

FEEBLE = 1e-15
"""k dt^2 where positions are to be left alone; the library takes a zero for something else."""

LEAST_HELD = 1e-3
"""Part of what the whole weight would press a corner by, up to which landing holds one at rest."""

MOST_REFLECTION = 25.0
"""No more than this part of the velocity with which a contact comes into a step is returned: after
a far shorter step that is noise."""

MOST_GROWTH, RELEASED_GROWTH = 20.0, 80.0
"""By how much faster a block will turn is noise where it hardly turns: a velocity is returned as if
it grew by no more than the first, in p dt a step. Of a released block nothing is returned until it
grows by no more than the second: later would be an error of first order."""

FREE, WELDED = 7, 6
"""Coordinates of a free joint, and the solver's rows of a weld, which come before the contacts'."""

SIDE, PIVOT, BODY, FACE, ON, WEIGHT, YIELDS, RESISTED = range(8)
"""Columns of pairs: +1 for corners at -x, -1 for those at +x, 0 for a single pair; about which side
the body turns for it to be the pivot; whose corner it is, of which face, and on which body; the
weight [N] that it carries as a pivot; by how much [m/s2] it yields to that, and to what it carries
at rest."""


@dataclass(slots=True)
class ContactState:
    """What holds a block, and what was seen of it."""

    planar: bool = False  # bodies have three coordinates
    moving: bool = False  # the base moves
    base_velocity: bool = False  # with a velocity
    welded: bool = False  # as a body of its own
    single: bool = False  # all corners of a contact share one pair
    stacked: bool = False  # bodies rest on others
    by_phase: bool = False  # what changes with the step, as in the settings; so do the next two
    reflects: bool = False
    preload: bool = False
    width: float = 0.0  # of a body that rocks [m]
    height: float = 0.0  # the half of it [m]
    # of the reference, as are the next three; 0 where it stays as the model has it
    damping: float = 0.0
    sliding_damping: float = 0.0
    stiffness: float = 0.0
    impedance: float = 0.0
    carry: float = 0.0  # gap within which the pivot stays in contact [m]; 0 for no such thing
    touching: int = 0  # contacts of the layout
    pairs: int = 0  # that touch
    corners: int = 0  # how many pairs are at each side of a contact
    ordinary_squared: float = 0.0  # the ordinary step's square [s2]
    impedance_squared: float = 0.0
    growth: float = 0.0  # how much what is returned may grow in a step
    steady: float = 0.0  # and where the block was released
    dt: float = 0.0  # length of the last step [s]
    time: float = 0.0  # its end [s]
    sliding: float = 0.0  # the damping along the base in it
    moved: float = 0.0  # place of the base [m]
    raised: float = 0.0  # its height above where it began [m], and where that was
    level: float = 0.0
    velocity: float = 0.0  # of the base [m/s]
    lag: float = 0.0  # how far a welded base was at most from where it should have been [m]
    aloft: bool = False  # the last step was of a swing
    released: bool = False  # and so was every step since a release
    rate: float = 0.0  # the angular velocity [rad/s]
    gained: float = 0.0  # what it gained in the last step [rad/s2]
    returned: float = 0.0  # part of the pivot's velocity that was
    last_dt: float = 0.0  # length of that step [s]


class Arrays(NamedTuple):
    """The library's arrays, three of them of what it is asked about; a welded base's joint is last.

    A body in the plane has x, z [m] from its home and theta [rad]; a free one x, y, z [m] and a
    quaternion, its real part first; and so for velocities.
    """

    position: FloatArray
    velocity: FloatArray
    gravity: FloatArray
    pair_reference: FloatArray  # (pairs, 2), the numbers of `solref` along the normal
    pair_friction: FloatArray  # (pairs, 2), and along the base
    pair_margin: FloatArray  # (pairs,), gap from which on a pair acts [m]
    surface_velocity: FloatArray  # (geoms, 6), first that of the base [m/s, rad/s]
    base_place: FloatArray  # (bodies moved, 3), where the base is put [m]
    pairs: FloatArray  # (pairs, 8), a row for each of the library's, columns `SIDE` to `RESISTED`
    homes: FloatArray  # (bodies, 3), its centre at rest along and above the base, half height [m]
    state: FloatArray  # (bodies, 4), the last one that was read, a `Pose` a row


class Forces(NamedTuple):
    """The solver's contacts and rows, a weld's first, and R [1/kg] and f [N] of each row."""

    contacts: int
    rows: int
    resistance: FloatArray
    force: FloatArray


def read(held: ContactState, arrays: Arrays) -> None:
    """Read the state: write every body's `Pose` into a row of it."""
    q, v, state = arrays.position, arrays.velocity, arrays.state
    for body in range(len(arrays.homes)):
        if held.planar:
            i = 3 * body
            x, z = q[i] + arrays.homes[body, 0], q[i + 1] + arrays.homes[body, 1]
            theta, rate = q[i + 2], v[i + 2]
        else:
            i = 7 * body
            x, z, theta = q[i], q[i + 2], 2.0 * math.atan2(q[i + 5], q[i + 3])
            rate = v[6 * body + 4]
        state[body, 0], state[body, 1] = x - held.moved, z - held.raised
        state[body, 2], state[body, 3] = theta, rate


def prepare(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Set what a step needs, but for its length; `read` comes before."""
    changes = step.dt_s != held.dt or held.by_phase or held.reflects or held.carry != 0.0
    if changes and held.damping != 0.0:
        set_reference(held, arrays, step)
    arrays.gravity[0], arrays.gravity[2] = step.pull_x, step.pull_z
    if held.moving:
        # the contact turns the slip v- - V into (1 - b dt) times as much, so that a point which
        # moved with the base before moves with the base after
        if held.base_velocity:
            arrays.surface_velocity[0, 0] = held.velocity + step.base_kick / held.sliding
        held.velocity = step.base_velocity
        # the place from which the base sets out; or where it goes
        arrays.base_place[0, 0] = step.base_x if held.welded else held.moved
        arrays.base_place[0, 2] = held.level + (step.base_z if held.welded else held.raised)


def set_reference(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Set the contact in units of the step."""
    held.dt = dt = step.dt_s
    back = part_of(held, step) if held.reflects else 0.0
    firm = held.stiffness
    if held.by_phase and (step.side != 0.0 or step.phase != ContactPhase.REST):
        firm = FEEBLE
    held.sliding = held.sliding_damping + back
    put_pair(arrays.pair_reference, *direct(held.impedance, dt, firm, held.damping + back))
    put_pair(arrays.pair_friction, *direct(held.impedance, dt, firm, held.sliding))
    if held.carry != 0.0 and step.phase == ContactPhase.REST and step.side == 0.0:
        hold_at_rest(held, arrays, step)
    elif held.carry != 0.0:
        set_reach(held, arrays, step)


def direct(impedance: float, dt_s: float, stiffness: float, damping: float) -> tuple[float, float]:
    """Return solref of k dt^2 and b dt, as MuJoCo's modeling.rst has it, "Solver parameters"."""
    unit = impedance / dt_s
    return -stiffness * (unit * unit), -unit * damping


def put_pair(table: FloatArray, first: float, second: float) -> None:
    """Write two numbers into every row of a table (k, 2)."""
    for row in range(len(table)):
        table[row, 0], table[row, 1] = first, second


def part_of(held: ContactState, step: Step) -> float:
    """Return the part to give back of the velocity with which the pivot comes into a step."""
    was_aloft, before = held.aloft, held.returned
    held.aloft = step.phase == ContactPhase.SWING or step.phase == ContactPhase.APPROACH
    held.released = held.released and held.aloft
    held.returned = 0.0
    if not (was_aloft and held.aloft) or held.rate == 0.0:
        return 0.0
    faster = 1.0 + held.gained * step.kick_s / held.rate
    growth = faster * faster
    if held.released and growth > held.steady:
        return 0.0  # what is returned too soon would stay in it
    most = held.steady if held.released else held.growth
    part = min(growth, most) * step.dt_s / held.last_dt
    held.returned = min(part if before != 0.0 else 0.5 * part, MOST_REFLECTION)
    return held.returned


def set_reach(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Set from which gap [m] on each contact acts, and preload the one that carries the block."""
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
            theta = arrays.state[int(pairs[i, BODY]), 2]
            margin[i] = max(sag, min(held.carry, 0.5 * held.width * abs(theta)))
        elif pairs[i, PIVOT] == step.side:
            hold_pivot(held, arrays, step, i)
        elif held.stacked and step.phase >= ContactPhase.APPROACH:
            # a rounding apart, those above would close a step before those below, or after
            margin[i] = held.carry if step.phase == ContactPhase.STRIKE else -held.carry


def hold_pivot(held: ContactState, arrays: Arrays, step: Step, pair: int) -> None:
    """Keep a pivot in contact, and press it."""
    arrays.pair_margin[pair] = held.carry
    if held.preload:
        preload = arrays.pairs[pair, YIELDS] * step.kick_s / step.dt_s
        arrays.pair_reference[pair, 0] = -preload * held.impedance_squared / held.carry


def hold_at_rest(held: ContactState, arrays: Arrays, step: Step) -> None:
    """Hold each corner from the gap [m] to which its own load presses it: none leans on another."""
    reach = step.kick_s * step.dt_s
    for i in range(held.pairs):
        all_of_it = arrays.pairs[i, YIELDS] * reach
        resisted = arrays.pairs[i, RESISTED] * reach
        pressed = min(max(gap_of(held, arrays, i), resisted), all_of_it)
        arrays.pair_margin[i] = pressed + LEAST_HELD * all_of_it


def gap_of(held: ContactState, arrays: Arrays, pair: int) -> float:
    """Return the gap [m] between a corner and what it touches, both about upright."""
    row, state = arrays.pairs[pair], arrays.state
    z, theta = state[int(row[BODY]), 1], state[int(row[BODY]), 2]
    raised = 0.5 * held.width * math.sin(theta)
    if row[FACE] == LOWER:
        return z - held.height * math.cos(theta) + row[SIDE] * raised
    under = state[int(row[ON]), 1] - arrays.homes[int(row[ON]), 2]
    return under - (z + held.height * math.cos(theta) + row[SIDE] * raised)


def notice(held: ContactState, arrays: Arrays, forces: Forces, step: Step) -> None:
    """Note what a step has done, for the next one."""
    held.moved = step.base_x if held.moving else 0.0
    held.raised = step.base_z if held.moving else 0.0
    if held.welded:
        # the joint of the base is the last
        at = len(arrays.position) - FREE
        held.moved = arrays.position[at]
        held.raised = arrays.position[at + 2] - held.level
        held.lag = max(held.lag, abs(held.moved - step.base_x))
    held.time += step.dt_s
    if held.carry != 0.0 and forces.contacts > 0:
        look_at_yield(held, arrays, forces, step)
    if held.reflects:
        rate = arrays.velocity[2 if held.planar else 4]
        held.gained = (rate - held.rate) / step.kick_s
        held.rate, held.last_dt = rate, step.dt_s


def look_at_yield(held: ContactState, arrays: Arrays, forces: Forces, step: Step) -> None:
    """Note by how much [m/s2] corners yield to their forces, in the order of the pairs."""
    pairs, count, weld = arrays.pairs, forces.contacts, WELDED if held.welded else 0
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
