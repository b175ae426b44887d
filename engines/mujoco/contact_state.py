"""What holds a block in MuJoCo: the memory of it, and the library's arrays that it is set in."""

from typing import Any, NamedTuple

import numpy as np

from engines.mujoco.model import welded
from engines.mujoco.settings import MujocoSettings
from engines.parts.compiled import State, fill
from engines.parts.reflection import Reflection, begin_reflection
from engines.scene import Scene
from engines.world import FloatArray, Pose

UNSET, SCALED, DIRECT = range(3)
"""Forms of the contact's reference: the library's own, its time constant in steps, b and k."""


class ContactState(State):
    """What holds a block, and what was seen of it.

    Attributes
    ----------
    planar, moving, base_velocity, welded : bool
        Whether the block has three coordinates, whether the base moves, with a velocity, or as a
        body of its own.
    width, height : float
        Of a body that rocks, the half of the latter [m].
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
    touching, pairs, corners : int
        Contacts of the layout, pairs that touch, and how many of them at each side of a contact.
    single, stacked : bool
        Whether all corners of a contact share one pair, and whether bodies rest on others.
    ordinary_squared, impedance_squared : float
        Squares of the ordinary step and of the impedance.
    dt, time : float
        Length and end of the last step [s].
    sliding : float
        Damping along the base in this step.
    moved, raised, velocity : float
        Place [m] and velocity [m/s] of the base, and its height above where it began.
    lag : float
        How far [m] a welded base was at most from where it should have been.
    reflection : Reflection
    """

    planar: bool
    moving: bool
    base_velocity: bool
    welded: bool
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
    touching: int
    pairs: int
    corners: int
    single: bool
    stacked: bool
    ordinary_squared: float
    impedance_squared: float
    dt: float
    time: float
    sliding: float
    moved: float
    raised: float
    velocity: float
    lag: float
    reflection: Reflection


SIDE, PIVOT, BODY, FACE, ON, WEIGHT, YIELDS, RESISTED = range(8)
"""Columns of pairs.

+1 for corners at -x, -1 for those at +x, 0 for a single pair; about which side the body turns for
it to be the pivot; whose corner it is, of which face, and on which body (a `Contact`);
the weight [N] that it carries as a pivot; by how much [m/s2] it yields to that, and to what it
carries at rest.
"""


class Arrays(NamedTuple):
    """The library's arrays, and three of what it is asked about.

    Attributes
    ----------
    position, velocity : ndarray (nq,), (nv,)
        Of every joint, a welded base's last. A body in the plane has x, z [m] from its home, theta
        [rad], and their rates; a free one x, y, z [m] and a quaternion, its real part first, and a
        velocity [m/s] and angular velocity [rad/s].
    gravity : ndarray (3,)
        [m/s2].
    pair_reference, pair_friction : ndarray (pairs, 2)
        The reference along the normal, and along the base: minus a stiffness [1/s2] and minus a
        damping [1/s], or a time constant [s] and a damping ratio.
    pair_margin : ndarray (pairs,)
        Gap [m] from which on a pair acts.
    geom_reference : ndarray (geoms, 2)
        The reference of shapes that touch without a pair.
    surface_velocity : ndarray (geoms, 6)
        Of each shape's surface [m/s, rad/s], first that of a base with one; none in older releases.
    base_place : ndarray (bodies moved, 3)
        Where bodies are [m] that are moved by their place.
    pairs : ndarray (pairs, 8)
        A row for each of the library's, columns `SIDE` to `RESISTED`.
    homes : ndarray (bodies, 3)
        Where the centre is at rest, along and above the base, and half of the height [m].
    state : ndarray (bodies, 4)
        The last one that was read, a `Pose` a row.
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
    pairs: FloatArray
    homes: FloatArray
    state: FloatArray


class Forces(NamedTuple):
    """What the solver says of a step.

    Attributes
    ----------
    contacts, rows : int
        How many contacts there are, and rows of the solver: those of a weld first, then as many for
        each contact.
    resistance, force : ndarray (rows,)
        Of each row R [1/kg] and the force [N].
    """

    contacts: int
    rows: int
    resistance: FloatArray
    force: FloatArray


def begin_contact(
    held: ContactState, scene: Scene, s: MujocoSettings, dt_s: float, pairs: int
) -> None:
    """Prepare for a scene in ordinary steps of `dt_s` [s], of which so many pairs touch.

    Parameters
    ----------
    held : ContactState, blank, to be filled
    scene : Scene
    s : MujocoSettings
    dt_s : float, ordinary step [s]
    pairs : int, pairs of the model; 0 where shapes touch without one
    """
    impedance = 1.0 if s.impedance is None else s.impedance[1]
    sliding = 1.0 if s.sliding_damping is None else s.sliding_damping
    fill(
        held,
        planar=s.planar,
        moving=scene.frame == "world",
        base_velocity=s.floor == "surfacevel",
        welded=welded(scene, s),
        width=scene.system.width,
        height=0.5 * scene.system.height,
        damping=s.damping or 0.0,
        sliding_damping=sliding,
        sliding=sliding,
        stiffness=s.stiffness or 0.0,
        impedance=impedance,
        by_step=s.by_phase or s.reflection or s.carry is not None,
        by_phase=s.by_phase,
        reflects=s.reflection,
        preload=s.preload,
        carry=(s.carry or 0.0) * scene.system.width,
        touching=len(scene.layout.contacts),
        pairs=pairs,
        corners=max(pairs // len(scene.layout.contacts) // 2, 1),
        single=s.geometry != "corners",
        stacked=scene.stacked,
        ordinary_squared=dt_s**2,
        impedance_squared=impedance**2,
    )
    if s.solref is not None:
        fill(held, form=SCALED, time_constant=s.solref[0], ratio=s.solref[1])
    elif s.damping is not None:
        held.form = DIRECT
    begin_reflection(held.reflection, scene, dt_s)


def pairs_of(held: ContactState, scene: Scene) -> FloatArray:
    """Return what is known of each pair, in the library's order: by contacts, those at -x first."""
    rows, yields = [], (1.0 - held.impedance) * scene.system.gravity
    for contact in scene.layout.contacts if held.pairs else ():
        weight = scene.layout.carried(contact) * scene.system.gravity / held.corners
        for side in (0.0,) if held.single else (1.0, -1.0):
            pivot = contact.face * side
            row = (side, pivot, *contact, weight, yields, 0.5 * yields)
            rows += [row] * (1 if held.single else int(held.corners))
    return np.array(rows).reshape(-1, 8)


def arrays_of(model: Any, data: Any, held: ContactState, scene: Scene) -> Arrays:
    """Return the library's arrays, which share its memory.

    Parameters
    ----------
    model, data : MjModel, MjData, of the scene
    held : ContactState, from `begin_contact`
    scene : Scene
    """
    homes = np.array([(*body.home, 0.5 * body.height) for body in scene.bodies])
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
        pairs_of(held, scene),
        homes,
        np.zeros((len(homes), len(Pose._fields))),
    )
