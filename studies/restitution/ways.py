"""Ways to ask an engine for a coefficient of restitution: settings in place of the best contact's.

MuJoCo has no such coefficient: its contact is a spring with a damper, which may push but not pull,
and lets go when its force is zero (Schwager and Poeschel, Granular Matter 9, 2007).
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from typing import Any

SHOWN = 0.6
"""The coefficient for which settings are quoted."""

Settings = Mapping[str, Any]

FEEBLE = 1e-9
"""In place of a zero: MuJoCo takes a pair with one zero for its own default."""

SOFT_S = 0.02
"""Time constant [s] of MuJoCo's own contact."""

SPRUNG: Settings = {"damping": None, "sliding_damping": None, "stiffness": None}
"""MuJoCo's direct form of a contact given up for its other one, ..."""
SOFT: Settings = {**SPRUNG, "impedance": (0.9, 0.95, 0.001, 0.5, 2.0)}
"""... with the library's own impedance."""


@dataclass(frozen=True, slots=True)
class Way:
    """One way to ask an engine.

    Attributes
    ----------
    name : str
        The plainest first; "and" adds to the one before.
    settings : callable
        ``(e, dt_s) -> settings`` of the engine, in steps of dt_s [s].
    words : str
        The same in the library's own words; ``{e:g}`` is the coefficient, other names are those
        that `quoted` returns.
    quoted : callable or None
        ``(e, dt_s) -> values`` of the words that are no setting as it stands.
    """

    name: str
    settings: Callable[[float, float], Settings]
    words: str
    quoted: Callable[[float, float], Mapping[str, float]] | None = None

    def literal(self, e: float, dt_s: float) -> str:
        """Return what is set for a coefficient, in steps of dt_s [s]."""
        return self.words.format(e=e, **(self.quoted(e, dt_s) if self.quoted else {}))


def _way(name: str, words: str, **others: Any) -> Way:
    """Return a way that sets the block's coefficient and, as they stand, other settings."""
    return Way(name, lambda e, _: {"restitution": e, **others}, words)


def given_back(ratio: float) -> float:
    """Return the part of the speed that a spring gives back by its damping ratio."""
    if ratio < 1.0:
        root = math.sqrt(1.0 - ratio * ratio)
        return math.exp(-ratio / root * 2.0 * math.atan2(root, ratio))
    if ratio == 1.0:
        return math.exp(-2.0)
    root = math.sqrt(ratio * ratio - 1.0)
    return math.exp(-ratio / root * math.log((ratio + root) / (ratio - root)))


def damping_ratio(restitution: float) -> float:
    """Return the damping ratio of a spring that gives back a part of the speed, by bisection."""
    low, high = 0.0, 1.0
    while given_back(high) > restitution:
        high *= 2.0
    while low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if given_back(middle) > restitution else (low, middle)
    return high


def _ratio(e: float) -> float:
    """Return the damping ratio, that of the library where nothing is to be given back."""
    return max(damping_ratio(e), FEEBLE) if e else 1.0


def _resolved(e: float, _: float, steps: int) -> Settings:
    """Return k dt^2 and b dt of a spring over so many steps, were it not damped.

    Where nothing is to be given back, what takes all speed out in one step.
    """
    if e == 0.0:
        return {"stiffness": FEEBLE, "damping": 1.0}
    frequency = math.pi / steps
    return {
        "stiffness": frequency**2,
        "damping": max(2.0 * damping_ratio(e) * frequency, FEEBLE),
    }


def _direct(e: float, dt_s: float, steps: int) -> Mapping[str, float]:
    """Return the same as the two numbers of solref, the impedance being nearly 1."""
    held = _resolved(e, dt_s, steps)
    return {"k": held["stiffness"] / dt_s**2, "b": held["damping"] / dt_s}


def _over(steps: int) -> Way:
    return Way(
        f"spring and damper over {steps} steps",
        partial(_resolved, steps=steps),
        'solref="-{k!r} -{b!r}" solimp="0.9999 0.9999 0.001 0.5 2"',
        partial(_direct, steps=steps),
    )


PYBULLET = "changeDynamics(block, -1, restitution={e:g})"
BOTH = f"changeDynamics(base, -1, restitution=1), {PYBULLET}"
FAST = "setPhysicsEngineParameter(restitutionVelocityThreshold=0"
DART = "setRestitutionCoeff({e:g}) on the block, "
PHYSX = "PhysxMaterial(1.3, 1.3, {e:g}) of block and base"

WAYS: dict[str, tuple[Way, ...]] = {
    # the product of two bodies' coefficients counts; what is nearer than a gap is slowed before it
    # touches, and gives back of that; a depth that is corrected adds to the speed
    "pybullet": (
        _way("e on the block alone", PYBULLET, base_restitution=0.0),
        _way("e on the block, 1 on the base", BOTH),
        _way("and at all speeds", f"{BOTH}, {FAST})", restitution_threshold=0.0),
        _way(
            "and where they touch alone",
            f"{BOTH}, {FAST}, contactBreakingThreshold=1e-09)",
            **{"restitution_threshold": 0.0, "breaking_threshold": 1e-9},
        ),
        _way(
            "and no depth is corrected",
            f"{BOTH}, {FAST}, contactBreakingThreshold=1e-09, contactERP=0)",
            **{"restitution_threshold": 0.0, "breaking_threshold": 1e-9, "contact_erp": 0.0},
        ),
    ),
    "mujoco": (
        Way("the library's solref, whatever e", lambda *_: SOFT, f'solref="{SOFT_S} 1"'),
        Way(
            "the damping ratio for e alone",
            lambda e, dt_s: {**SOFT, "solref": (SOFT_S / dt_s, _ratio(e))},
            f'solref="{SOFT_S} {{ratio!r}}"',
            lambda e, _: {"ratio": _ratio(e)},
        ),
        _over(5),
        _over(20),
    ),
    # the product of two shapes' elasticities counts, which are 0 unless they are set
    "pymunk": (
        _way(
            "e on the block alone",
            "shape.elasticity = {e:g} of the block's shapes",
            base_restitution=0.0,
        ),
        _way(
            "e on the block, 1 on the base",
            "shape.elasticity = {e:g} of the block's shapes, 1 of the base's",
        ),
    ),
    # the larger one counts; what comes in at less than 1 unit of length a second does not bounce
    "box2d": (
        _way(
            "e on the block, in metres",
            "restitution={e:g} of the block's fixtures",
            units=None,
        ),
        _way(
            "e on the block, in the preset's units",
            "restitution={e:g} of the block's fixtures, 50 units to its height",
        ),
    ),
    # the product counts; what comes in at less than 0.1 units of length a second does not bounce,
    # and nothing comes off at more than 100
    "dart": (
        _way("e on the block alone", f"{DART}0 on the base", base_restitution=0.0, unit=1.0),
        _way("e on the block, 1 on the base, in metres", f"{DART}1 on the base", unit=1.0),
        _way("and in tenths of a metre", f"{DART}1 on the base, 10 units to the metre", unit=10.0),
        _way("and in the preset's unit", f"{DART}1 on the base, 100000 units to the metre"),
    ),
    # the mean of two colliders' coefficients counts, which are 0 unless they are set; a bounce is
    # an impulse along the normal alone, after that of friction: a corner that bounces slides
    "rapier": (
        _way(
            "e on the block alone",
            "Collider.restitution({e:g}) of the block",
            base_restitution=0.0,
        ),
        _way("e on both", "Collider.restitution({e:g}) of block and base"),
    ),
    # of two shapes' coefficients the smaller counts in Kamino, which is the preset's; in XPBD the
    # mean, where it is told to heed them
    "newton": (
        _way("e on both", "ShapeConfig.restitution = {e:g} of block and base"),
        _way(
            "and by XPBD",
            "ShapeConfig.restitution = {e:g}, SolverXPBD(model, enable_restitution=True)",
            **{"solver": "xpbd", "baumgarte": None, "iterations": 20},
        ),
    ),
    # the mean of two materials' coefficients counts; what comes in at less than 2 m/s does not
    # bounce
    "physx": (
        _way("e on both", PHYSX),
        _way(
            "and at all speeds",
            f"{PHYSX}, set_scene_config(bounce_threshold=1e-09)",
            bounce_threshold=1e-9,
        ),
        _way(
            "and by TGS",
            f"{PHYSX}, set_scene_config(bounce_threshold=1e-09, enable_tgs=True)",
            **{"bounce_threshold": 1e-9, "tgs": True},
        ),
    ),
}
"""Name of an engine -> ways to ask it, where it was tried."""

WITHOUT = {
    "drake": "its contact yields and dissipates, by Hunt and Crossley's law or a relaxation time; "
    "what comes back depends on the speed",
}
"""Name of an engine without a coefficient of restitution -> what it has instead."""
