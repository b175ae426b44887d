"""Extreme cases: each takes one thing far beyond where anybody would tune a method."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import Any

from analytic import GRAVITY, Outcome, RigidBlock, SinePulse, simulate
from engines.declaration import AT_REST, RECOMMENDED
from engines.scene import free_rocking_window
from studies.sources.registry import resolve

SPRINGS: Mapping[str, Callable[[float, float], Mapping[str, float]]] = {
    "mujoco": lambda time, step: {"stiffness": (step / time) ** 2, "damping": 2.0 * (step / time)},
    "pybullet": lambda time, step: {"contact_stiffness": time**-2, "contact_damping": 2.0 / time},
}
"""Engine -> its settings of a critically damped contact of a time, which may depend on the step."""

WITH_A_TIME = {("mujoco", preset) for preset in ("default", AT_REST, RECOMMENDED)}
"""Engines and presets whose contact has a time of its own."""
MOST_FRICTION = {"pybullet": 10.0}
"""Engine -> the largest coefficient of friction that it takes, where that is bounded."""
EDGE = 1e-6
"""Relative distance of an amplitude from the onset, or from the overturning boundary."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Extreme:
    """A block, a pulse and what is extreme about them; None stands for a preset's own value."""

    name: str
    group: str
    width_m: float = 0.5
    aspect: float = 3.0
    onsets: float = 1.2  # the amplitude over g B/H
    omega_over_p: float = 3.0
    half_cycles: int = 2
    restitution: float | None = None  # velocity ratio of impacts; engines have their own
    rest_s: float = 0.0  # that all is watched at least after the pulse
    density: float = 1000.0  # [kg/m3]
    friction: float | None = None
    contact: float | None = None  # p T of a spring m/T^2 that holds the block, damped critically
    step_s: float | None = None

    @property
    def block(self) -> RigidBlock:
        """The block."""
        height = self.aspect * self.width_m
        return RigidBlock(width=self.width_m, height=height, restitution=self.restitution)  # type: ignore[arg-type]

    @property
    def motion(self) -> SinePulse:
        """The pulse."""
        return SinePulse(
            amplitude=self.onsets * GRAVITY / self.aspect,
            omega=self.omega_over_p * self.block.p,
            half_cycles=self.half_cycles,
        )

    @property
    def duration(self) -> float:
        """Time of observation [s]: the pulse and some free rocking."""
        window = free_rocking_window(self.block, self.motion)
        return max(window, self.motion.duration + self.rest_s)

    def applies(self, source: str) -> bool:
        """Say whether the source has what is extreme here."""
        asked = resolve(source)
        if self.contact is not None:
            own_time = (asked.engine, asked.preset) in WITH_A_TIME
            return asked.engine in SPRINGS and not own_time
        if self.density != 1000.0 or self.friction is not None:
            return asked.kind == "engine"
        if self.step_s is not None:
            return asked.stepping
        return asked.kind != "engine" or self.restitution is None

    def options(self, source: str) -> dict[str, Any]:
        """Return the options with which a source meets the case."""
        asked, found = resolve(source), dict[str, Any]()
        if self.step_s is not None:
            found["step"] = self.step_s * self.block.p
        if self.density != 1000.0:
            found["density"] = self.density
        if self.friction is not None:
            found["friction"] = min(self.friction, MOST_FRICTION.get(asked.engine, math.inf))
        if self.contact is not None:
            step = asked.used.ordinary_step()
            found["settings"] = SPRINGS[asked.engine](self.contact, step)
        return found


def _boundary(case: Extreme, surviving: float, overturned: float) -> float:
    """Return the amplitude [onsets] at which the exact solution begins to overturn."""
    while overturned - surviving > 1e-13 * surviving:
        middle = 0.5 * (surviving + overturned)
        tried = replace(case, onsets=middle)
        falls = simulate(tried.block, tried.motion).outcome is Outcome.OVERTURNED
        surviving, overturned = (surviving, middle) if falls else (middle, overturned)
    return surviving


QUICK = (
    *("H/B 50", "H/B 0.8", "H/B 0.8, violent", "1 cm high", "onset + 1e-6", "boundary − 1e-6"),
    *("ω/p 100", "density 1e9", "friction 1e-3", "friction 1", "contact of 1e-5/p", "step 1/30 s"),
)


@cache
def extremes(quick: bool) -> tuple[Extreme, ...]:
    """Return the cases; quick leaves out neighbours and what takes long."""
    if quick:
        return tuple(case for case in extremes(False) if case.name in QUICK)
    half = Extreme(name="boundary", group="amplitude", half_cycles=1)
    full = replace(half, name="boundary after impact", half_cycles=2)
    # the largest rotation that survives lies before the first impact, and after it
    edges = ((half, _boundary(half, 1.0, 5.0)), (full, _boundary(full, 1.0, 1.5)))
    pulse = Extreme(name="", group="frequency", half_cycles=1)
    steps = {"1/30": 1.0 / 30.0, "1/240": 1.0 / 240.0, "1e-3": 1e-3, "1e-4": 1e-4, "1e-5": 1e-5}
    return (
        *(Extreme(name=f"H/B {k:g}", group="shape", aspect=k) for k in (20, 50, 100, 1.0, 0.8)),
        Extreme(name="H/B 0.8, violent", group="shape", aspect=0.8, onsets=1.5),
        Extreme(name="η 0.01 (H/B 0.72)", group="impact", aspect=0.72),
        Extreme(name="η 0.001, set", group="impact", restitution=0.001),
        Extreme(name="η 0.999, set", group="impact", restitution=0.999),
        Extreme(name="1 cm high", group="size", width_m=0.01 / 3.0),
        Extreme(name="20 m high", group="size", width_m=20.0 / 3.0),
        Extreme(name="onset − 1e-6", group="amplitude", onsets=1.0 - EDGE),
        Extreme(name="onset + 1e-6", group="amplitude", onsets=1.0 + EDGE),
        *(
            replace(case, name=f"{case.name} {sign} 1e-6", onsets=boundary * (1.0 + nudge))
            for case, boundary in edges
            for sign, nudge in (("−", -EDGE), ("+", EDGE))
        ),
        replace(pulse, name="ω/p 0.01", omega_over_p=0.01, onsets=1.00001),
        replace(pulse, name="ω/p 0.01, over", omega_over_p=0.01, onsets=1.2),
        replace(pulse, name="ω/p 10", omega_over_p=10.0, onsets=3.0),
        replace(pulse, name="ω/p 100", omega_over_p=100.0, onsets=10.0),
        Extreme(name="20 half-cycles", group="time", half_cycles=20, omega_over_p=4.0, onsets=1.5),
        Extreme(name="60 s at rest", group="time", onsets=0.9, rest_s=60.0),
        Extreme(name="60 s after rocking", group="time", rest_s=60.0),
        Extreme(name="density 1e-6", group="mass", density=1e-3),
        Extreme(name="density 1e9", group="mass", density=1e12),
        *(
            Extreme(name=f"friction {name}", group="friction", friction=float(name))
            for name in ("1e-3", "0.3", "1", "1e9")
        ),
        *(
            Extreme(name=f"contact of {name}/p", group="contact", contact=float(name))
            for name in ("0.1", "0.01", "1e-3", "1e-5")
        ),
        *(Extreme(name=f"step {name} s", group="step", step_s=s) for name, s in steps.items()),
    )
