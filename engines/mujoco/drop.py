"""A sphere dropped on a plane in MuJoCo: which solref gives which coefficient of restitution.

The library has no such coefficient: its contact is a spring with a damper, which may push but not
pull, and lets go when its force is zero (Schwager and Poeschel, Granular Matter 9, 2007).
"""

import math
from collections.abc import Callable
from functools import partial
from importlib import import_module
from typing import Any

from engines.parts.drop import Bouncing, Drop, rebound

IMPEDANCE = 0.9999
"""Largest that the library takes, by which it scales a contact's acceleration."""

FEEBLE = 1e-9
"""In place of a zero."""

LIBRARY_TIME_S = 0.02
"""Time constant [s] of the library's own contact."""


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


def direct(drop: Drop, steps: float) -> tuple[float, float]:
    """Return solref in the direct form, for a contact of so many steps without damping.

    Where nothing is to be given back, the form that takes all speed out in one step.
    """
    if drop.restitution == 0.0:
        return -FEEBLE / drop.dt_s**2, -1.0 / drop.dt_s
    frequency = math.pi / (steps * drop.dt_s)
    # a pair with one zero would be replaced by the library's default
    return -(frequency**2), min(-2.0 * damping_ratio(drop.restitution) * frequency, -FEEBLE)


def _ratio_setting(drop: Drop) -> str:
    """Return the library's own time constant, and the damping ratio."""
    ratio = max(damping_ratio(drop.restitution), FEEBLE) if drop.restitution else 1.0
    return f'solref="{LIBRARY_TIME_S} {ratio!r}"'


def _dropped(drop: Drop, setting: Callable[[Drop], str]) -> float:
    """Drop a sphere with what a setting says, as it says it."""
    mj, contact = import_module("mujoco"), setting(drop)
    model = mj.MjModel.from_xml_string(
        f'<mujoco><option timestep="{drop.dt_s!r}" gravity="0 0 {-drop.gravity!r}"/>'
        '<size memory="64K"/><worldbody>'
        f'<geom type="plane" size="1 1 1" {contact}/>'
        f'<body pos="0 0 {drop.radius!r}"><joint type="slide" axis="0 0 1"/>'
        f'<geom type="sphere" size="{drop.radius!r}" mass="{drop.mass!r}" {contact}/>'
        "</body></worldbody></mujoco>"
    )
    data = mj.MjData(model)
    data.qpos[0], data.qvel[0] = drop.height, -drop.speed
    # the library would write its warnings to a file; they are counted and read below
    mj.set_mju_user_warning(_ignore)

    def step() -> tuple[float, float]:
        mj.mj_step(model, data)
        return float(data.qpos[0]), float(data.qvel[0])

    found = rebound(drop, step)
    mj.set_mju_user_warning(None)
    return math.nan if any(warning.number for warning in data.warning) else found


def _ignore(message: str) -> None:
    """Take a warning without writing it anywhere."""


FIRM = f'solimp="{IMPEDANCE} {IMPEDANCE} 0.001 0.5 2"'


def _direct_setting(drop: Drop, steps: float) -> str:
    k, b = direct(drop, steps)
    return f'solref="{k!r} {b!r}" {FIRM}'


def _held(restitution: float, steps: int) -> dict[str, float]:
    """Return the settings of a block for the same contact: k dt^2 and b dt; see `direct`."""
    k, b = direct(Drop(restitution=restitution, dt_s=1.0), steps)
    return {"stiffness": -k, "damping": -b}


def _way(name: str, setting: Callable[[Drop], str], **options: Any) -> Bouncing:
    dropped = partial(_dropped, setting=setting)
    return Bouncing(name=name, setting=setting, dropped=dropped, **options)


def _over(steps: int) -> Bouncing:
    setting = partial(_direct_setting, steps=steps)
    return _way(f"spring and damper over {steps} steps", setting, block=partial(_held, steps=steps))


BOUNCING = (
    _way("the library's solref, whatever e", lambda drop: f'solref="{LIBRARY_TIME_S} 1"'),
    _way("the damping ratio for e alone", _ratio_setting),
    _over(5),
    _over(20),
)
"""From the library's own contact to a spring that the step resolves."""
