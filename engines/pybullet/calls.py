"""A scene as calls of PyBullet, before any is made: what the adapter does and a script prints."""

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from engines.parts import Point, floor_half_size, half_size, hull_points, touching_spheres
from engines.pybullet.settings import SOLVERS, BulletSettings
from engines.scene import Body, Scene
from engines.settings import given

KEPT_GAP = 4.0
"""Gap up to which landing keeps a contact, in units of (p dt sin(alpha))^2 half diagonals. A pivot
rises by (theta' dt)^2 H/4 in a step, so that it is kept up to theta' = 2.8 p alpha. The free corner
must be let go: an anchor that is still kept at the next impact pulls it back to where it stood."""

ROLLED = 0.75
"""Part of that gap at most by which a corner sphere rolls while the block turns by alpha. An anchor
stays where it was made: from a gap away the library adds a contact, then another, and keeps all."""


FLOOR_MASSES = 100.0
"""Mass of a held base over that of the bodies on it; from ten on it does not matter."""

FLOOR_G = 50.0
"""Most force that holds it, over its weight, as in the library's example of such a constraint: 50 N
on a cube of 0.1 kg. By its weight alone a base sinks; from twice as much on it does not matter."""

NOWHERE, UPRIGHT = (0.0, 0.0, 0.0), (0.0, 0.0, 0.0, 1.0)


class Constant(str):
    """A number of the library's, by its name there."""

    __slots__ = ()


@dataclass(frozen=True, slots=True)
class Call:
    """A call of the library: the name of a function, and its arguments by name."""

    name: str
    arguments: Mapping[str, Any]


def engine_call(scene: Scene, s: BulletSettings, dt_s: float) -> Call:
    """Return the call that sets the contact solver; dt_s [s] is the ordinary step.

    Parameters
    ----------
    scene : Scene
    s : BulletSettings
    dt_s : float, ordinary step [s], from which the gap follows up to which contacts are kept
    """
    wanted = {
        "numSolverIterations": s.iterations_of(scene),
        "solverResidualThreshold": s.residual,
        "contactERP": s.contact_erp,
        "frictionERP": s.friction_erp,
        "erp": s.constraint_erp,
        "contactSlop": s.contact_slop,
        "contactBreakingThreshold": kept_gap(scene, s, dt_s),
        "constraintSolverType": s.solver and Constant(SOLVERS[s.solver]),
        "warmStartingFactor": s.warm_starting,
        "useSplitImpulse": s.split_impulse,
        "enableConeFriction": s.cone_friction,
        "enableSAT": s.separating_axis,
        "restitutionVelocityThreshold": s.restitution_threshold,
    }
    return Call("setPhysicsEngineParameter", given(wanted))


def kept_gap(scene: Scene, s: BulletSettings, dt_s: float) -> float:
    """Return the gap, over the half diagonal, up to which a contact is kept."""
    if s.gap_by_step:
        return KEPT_GAP * (math.sin(scene.system.alpha) * scene.system.p * dt_s) ** 2
    return s.breaking_threshold


def corner_radius(scene: Scene, s: BulletSettings, dt_s: float) -> float:
    """Return the radius [m] of the corner spheres."""
    radius = s.corner_radius * scene.system.width
    if s.gap_by_step:
        gap = kept_gap(scene, s, dt_s) * scene.system.R
        radius = min(radius, ROLLED * gap / scene.system.alpha)
    return radius


def constrained(scene: Scene, s: BulletSettings) -> bool:
    """Return whether the base is a body with a mass, held by a constraint that moves it.

    Parameters
    ----------
    scene, s
        As for `engine_call`.
    """
    return scene.frame == "world" and s.floor == "constraint"


def _boxed(scene: Scene, s: BulletSettings) -> bool:
    """Return whether the base is a box; a plane has no inertia with which to be held."""
    return s.base_geometry == "box" or constrained(scene, s)


def base_shape(scene: Scene, s: BulletSettings) -> Call:
    """Return the call that makes the shape of the base; it answers the shape's number.

    Parameters
    ----------
    scene, s
        As for `engine_call`.
    """
    if _boxed(scene, s):
        return _shape("GEOM_BOX", halfExtents=floor_half_size(scene))
    return _shape("GEOM_PLANE", planeNormal=(0.0, 0.0, 1.0))


def body_shape(scene: Scene, number: int, s: BulletSettings, dt_s: float) -> Call:
    """Return the call that makes what a body touches others with, or is touched on.

    Parameters
    ----------
    scene, s, dt_s
        As for `engine_call`.
    number : int, of the body in the scene
    """
    body = scene.bodies[number]
    if s.geometry == "box" or scene.layout.rests(number):
        return _shape("GEOM_BOX", halfExtents=half_size(body))
    if s.geometry == "hull":
        return _shape("GEOM_MESH", vertices=hull_points(body))
    radius = corner_radius(scene, s, dt_s)
    corners = touching_spheres(scene, number, radius, planar=s.planar)
    spheres = {
        "shapeTypes": [Constant("GEOM_SPHERE")] * len(corners),
        "radii": [radius] * len(corners),
        "collisionFramePositions": corners,
    }
    return Call("createCollisionShapeArray", spheres)


def _shape(kind: str, **shape: Any) -> Call:
    return Call("createCollisionShape", {"shapeType": Constant(kind), **shape})


def base_place(scene: Scene, s: BulletSettings) -> Point:
    """Return where the centre of the base is [m], shape (3,).

    Parameters
    ----------
    scene, s
        As for `engine_call`.
    """
    return (0.0, 0.0, -scene.bodies[0].height if _boxed(scene, s) else 0.0)


def base_body(scene: Scene, s: BulletSettings, shape: Any) -> Call:
    """Return the call that makes the base of its shape; it answers the base's number.

    Parameters
    ----------
    scene, s
        As for `engine_call`.
    shape : int, the shape's number, or what a script calls it
    """
    mass = FLOOR_MASSES * _mass(scene) if constrained(scene, s) else 0.0
    return _body(mass, shape, base_place(scene, s), False)


def hold_call(scene: Scene, s: BulletSettings, base: Any) -> Call:
    """Return the call that holds the base where it is; it answers the constraint's number.

    Parameters
    ----------
    scene, s
        As for `engine_call`.
    base : int, the base's number, or what a script calls it
    """
    frames = {"parentFramePosition": NOWHERE, "childFramePosition": base_place(scene, s)}
    ends = {"parentBodyUniqueId": base, "parentLinkIndex": -1}
    world = {"childBodyUniqueId": -1, "childLinkIndex": -1}
    kind = {"jointType": Constant("JOINT_FIXED"), "jointAxis": NOWHERE}
    return Call("createConstraint", {**ends, **world, **kind, **frames})


def most_force(scene: Scene) -> float:
    """Return the largest force [N] by which the constraint holds the base."""
    return FLOOR_G * scene.system.gravity * FLOOR_MASSES * _mass(scene)


def _mass(scene: Scene) -> float:
    """Return the mass [kg] of the bodies."""
    return sum(body.mass for body in scene.bodies)


def body_of(body: Body, s: BulletSettings, shape: Any) -> Call:
    """Return the call that makes a body of its shape; it answers the body's number.

    Parameters
    ----------
    body : Body, which is put where it is at rest
    s : BulletSettings
    shape : int, the shape's number, or what a script calls it
    """
    x, z = body.home
    return _body(body.mass, shape, (x, 0.0, z), not s.multibody)


def _body(mass: float, shape: Any, place: tuple[float, ...], rigid: bool) -> Call:
    body = {
        "baseMass": mass,
        "baseCollisionShapeIndex": shape,
        "basePosition": place,
        "useMaximalCoordinates": rigid,
    }
    return Call("createMultiBody", body)


def aloft(scene: Scene) -> list[Point]:
    """Return places [m] at which the bodies touch nothing, above where they rest."""
    up = 2.0 * scene.bodies[0].height - scene.bodies[0].home[1]
    return [(x, 0.0, z + up) for x, z in (body.home for body in scene.bodies)]


def body_call(scene: Scene, number: int, s: BulletSettings, body: Any) -> Call:
    """Return the call that sets a body's dynamics.

    Parameters
    ----------
    scene, s
        As for `engine_call`.
    number : int, of the body in the scene
    body : int, its number in the library, or what a script calls it
    """
    p, it = scene.system.p, scene.bodies[number]
    wanted: dict[str, Any] = {
        "lateralFriction": s.friction,
        # without its mass in the same call, a block in maximal coordinates becomes NaN
        "mass": it.mass,
        "localInertiaDiagonal": it.inertia if s.exact_inertia else None,
        "linearDamping": s.damping,
        "angularDamping": s.damping,
        "restitution": s.restitution,
    }
    if s.contact_stiffness is not None and s.contact_damping is not None:
        wanted["contactStiffness"] = s.contact_stiffness * it.mass * p * p
        wanted["contactDamping"] = s.contact_damping * it.mass * p
    return _change(s, body, given(wanted))


def base_call(s: BulletSettings, body: Any) -> Call:
    """Return the call that sets the base's dynamics.

    Parameters
    ----------
    s : BulletSettings, whose restitution says whether base_restitution is set
    body : int, the base's number, or what a script calls it
    """
    bounce = None if s.restitution is None else s.base_restitution
    return _change(s, body, given({"lateralFriction": 1.0, "restitution": bounce}))


def _change(s: BulletSettings, body: Any, wanted: Mapping[str, Any]) -> Call:
    anchor = {"frictionAnchor": 1} if s.friction_anchor else {}
    return Call("changeDynamics", {"bodyUniqueId": body, "linkIndex": -1, **wanted, **anchor})
