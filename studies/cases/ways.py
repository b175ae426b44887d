"""The plainest and the best way to ask an engine for a coefficient of restitution e."""
# MuJoCo has none: its contact is a spring with a damper, which may push but not pull, and lets go
# when its force is zero (Schwager and Poeschel, Granular Matter 9, 2007).

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

Settings = Mapping[str, Any]

FEEBLE = 1e-9
"""In place of a zero: MuJoCo takes a pair with one zero for its own default."""
SOFT_S = 0.02
"""Time constant [s] of MuJoCo's own contact, ..."""
SOFT: Settings = {
    **{"damping": None, "sliding_damping": None, "stiffness": None},
    "impedance": (0.9, 0.95, 0.001, 0.5, 2.0),
}
"""... its direct form given up for the other one, with the library's own impedance."""


@dataclass(frozen=True, slots=True)
class Way:
    """What is set, in the library's own words, and as settings: besides e, or ``(e, dt_s) ->``."""

    words: str
    own: Settings | Callable[[float, float], Settings]

    def settings(self, e: float, dt_s: float) -> Settings:
        """Return settings of the engine for a coefficient, in steps of dt_s [s]."""
        return self.own(e, dt_s) if callable(self.own) else {"restitution": e, **self.own}

    def literal(self, e: float) -> str:
        """Return what is set for a coefficient, DT being the step in seconds."""
        return self.words.format(e=e, **self.settings(e, 1.0))


def given_back(ratio: float) -> float:
    """Return the part of the speed that a spring gives back by its damping ratio, below 1."""
    root = math.sqrt(1.0 - ratio * ratio)
    return math.exp(-ratio / root * 2.0 * math.atan2(root, ratio))


def damping_ratio(e: float) -> float:
    """Return the damping ratio of a spring that gives back e > exp(-2), by bisection."""
    low, high = 0.0, 1.0
    while e and low < (middle := 0.5 * (low + high)) < high:
        low, high = (middle, high) if given_back(middle) > e else (low, middle)
    return high


def _over(steps: int) -> Way:
    """Return the way by a spring that, were it not damped, would push for so many steps."""

    def spring(e: float, _: float) -> Settings:
        if e == 0.0:  # all speed is taken out in one step
            return {"stiffness": FEEBLE, "damping": 1.0}
        frequency = math.pi / steps
        damping = max(2.0 * damping_ratio(e) * frequency, FEEBLE)
        return {"stiffness": frequency**2, "damping": damping}

    solref = 'solref="-{stiffness:.10g}/DT**2 -{damping:.10g}/DT"'
    return Way(f'{solref} solimp="0.9999 0.9999 0.001 0.5 2"', spring)


PYBULLET = "changeDynamics(block, -1, restitution={e:g})"
PYMUNK = "shape.elasticity = {e:g} of the block's shapes"
BOX2D = "restitution={e:g} of the block's fixtures"
DART = "setRestitutionCoeff({e:g}) on the block"
RAPIER = "Collider.restitution({e:g}) of "
NEWTON = "ShapeConfig.restitution = {e:g}"
PHYSX = "PhysxMaterial(1.3, 1.3, {e:g}) of block and base"
ALONE = {"base_restitution": 0.0}

WAYS: dict[str, dict[str, Way]] = {
    # the product of two bodies' coefficients counts; what is nearer than a gap is slowed before it
    # touches, and gives back of that; a depth that is corrected adds to the speed
    "pybullet": {
        "e on the block alone": Way(PYBULLET, ALONE),
        "1 on the base, no thresholds, no depth corrected": Way(
            f"changeDynamics(base, -1, restitution=1), {PYBULLET}, "
            "setPhysicsEngineParameter(restitutionVelocityThreshold=0, "
            "contactBreakingThreshold=1e-09, contactERP=0)",
            {"restitution_threshold": 0.0, "breaking_threshold": 1e-9, "contact_erp": 0.0},
        ),
    },
    "mujoco": {
        "the library's solref, whatever e": Way(f'solref="{SOFT_S} 1"', lambda *_: SOFT),
        "spring and damper over 20 steps": _over(20),
    },
    # the product of two shapes' elasticities counts, which are 0 unless they are set
    "pymunk": {
        "e on the block alone": Way(PYMUNK, ALONE),
        "e on the block, 1 on the base": Way(f"{PYMUNK}, 1 of the base's", {}),
    },
    # the larger one counts; what comes in at less than 1 unit of length a second does not bounce
    "box2d": {
        "e on the block, in metres": Way(BOX2D, {"units": None}),
        "e on the block, in the preset's units": Way(f"{BOX2D}, 50 units to its height", {}),
    },
    # the product counts; what comes in at less than 0.1 units of length a second does not bounce,
    # and nothing comes off at more than 100
    "dart": {
        "e on the block alone": Way(f"{DART}, 0 on the base", {**ALONE, "unit": 1.0}),
        "1 on the base, in tenths of a metre": Way(
            f"{DART}, 1 on the base, 10 units to the metre", {"unit": 10.0}
        ),
    },
    # the mean of two colliders' coefficients counts, which are 0 unless they are set; a bounce is
    # an impulse along the normal alone, after that of friction: a corner that bounces slides
    "rapier": {
        "e on the block alone": Way(f"{RAPIER}the block", ALONE),
        "e on both": Way(f"{RAPIER}block and base", {}),
    },
    # of two shapes' coefficients the smaller counts in Kamino, which is the preset's; in XPBD the
    # mean, where it is told to heed them
    "newton": {
        "e on both": Way(f"{NEWTON} of block and base", {}),
        "e on both, by XPBD": Way(
            f"{NEWTON}, SolverXPBD(model, enable_restitution=True)",
            {"solver": "xpbd", "baumgarte": None, "iterations": 20},
        ),
    },
    # the mean of two materials' coefficients counts; what comes in at less than 2 m/s does not
    # bounce
    "physx": {
        "e on both": Way(PHYSX, {}),
        "at all speeds, by TGS": Way(
            f"{PHYSX}, set_scene_config(bounce_threshold=1e-09, enable_tgs=True)",
            {"bounce_threshold": 1e-9, "tgs": True},
        ),
    },
}
"""Name of an engine -> the plainest way to ask it, and the best of those that were tried."""

WITHOUT = {
    "drake": "its contact yields and dissipates, by Hunt and Crossley's law or a relaxation time; "
    "what comes back depends on the speed"
}
"""Name of an engine without a coefficient of restitution -> what it has instead."""
