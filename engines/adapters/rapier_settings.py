"""What Rapier can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass, replace
from typing import Any

from engines.factors import (
    BEST,
    BOTH,
    BY_DEFAULT,
    DEFAULT,
    MOVING_BASE,
    Factor,
    Rule,
    factor,
    level,
)
from engines.parts.settings import check, given, setting


@dataclass(frozen=True, slots=True, kw_only=True)
class RapierSettings:
    """Settings of Rapier, by default its own; None leaves a setting to the library.

    Attributes
    ----------
    geometry : str
        "box", or "corners": small balls where the corners at the base are.
    planar : bool
        Lock the rotations that lead out of the plane, and put two corners into the middle plane
        instead of four at the edges. A box has its four corners either way.
    locked_aside : bool
        Lock the translation out of the plane, too, where `planar` is set. The contact then has no
        friction, in the plane either.
    friction : float
        Coefficient between block and base, their mean; the library's own is 0.5, with which a block
        of H/B = 2 slides before it rocks.
    substeps, iterations, stabilization : int or None
        Of the solver: substeps in a step, iterations in each, and those that take out of the
        velocities what the correction of positions has put in.
    frequency, damping_ratio : float or None
        Natural frequency [Hz] and damping ratio of the contact; both or neither. The library's are
        30 and 10, and 60 Hz on what does not move.
    by_phase : bool
        Correct no positions in the short steps around an impact; needs a frequency.
    recycling : bool or None
        Whether contacts are taken from the last step where bodies have hardly moved.
    warm_starting : float or None
        Part of the last step's impulses from which the solver starts; they are not scaled by the
        ratio of two steps.
    coulomb : bool or None
        Give each contact a friction of its own instead of one to all four.
    sleeping : bool or None
        Whether a block that has hardly moved for half a second is no longer simulated.
    corner_radius : float
        Radius of the corner balls over the width.
    reflection : bool
        Give the sliding velocity of the corner about which the block turns back to it, by the
        velocity of the base; not in the steps of an impact.
    base_velocity : bool
        Give a moving base its velocity; else it is moved by position alone.
    restitution : float
        Coefficient of block and base; the library takes their mean.
    """

    geometry: str = setting("box", names=("box", "corners"))
    planar: bool = False
    locked_aside: bool = False
    friction: float = 1.0
    substeps: int | None = setting(least=1)
    iterations: int | None = setting(least=1)
    stabilization: int | None = setting(least=0)
    frequency: float | None = setting(above=0.0, beside=("damping_ratio",))
    damping_ratio: float | None = setting(above=0.0)
    by_phase: bool = False
    recycling: bool | None = None
    warm_starting: float | None = setting(least=0.0, most=1.0)
    coulomb: bool | None = None
    sleeping: bool | None = None
    corner_radius: float = setting(1e-6, above=0.0)
    reflection: bool = False
    base_velocity: bool = True
    restitution: float = setting(0.0, least=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)
        if self.by_phase and self.frequency is None:
            raise ValueError("frequency is None; it must be given wherever by_phase is set")


def parameters(s: RapierSettings) -> dict[str, Any]:
    """Return the library's parameters that are set, by their own names; a model by its name."""
    return given(
        {
            "num_solver_iterations": s.substeps,
            "num_internal_pgs_iterations": s.iterations,
            "num_internal_stabilization_iterations": s.stabilization,
            "contact_recycling": s.recycling,
            "warmstart_coefficient": s.warm_starting,
            "friction_model": None if s.coulomb is None else "COULOMB",
        }
    )


TUNED = RapierSettings(
    geometry="corners",
    planar=True,
    substeps=1,
    iterations=100,
    stabilization=0,
    frequency=1e6,
    damping_ratio=1.0,
    recycling=False,
    warm_starting=0.0,
    sleeping=False,
)

LANDING = replace(TUNED, by_phase=True, reflection=True)

RECYCLED = "a contact of an earlier step: the block slides off its pivot"
FRICTIONLESS = "a contact whose body cannot move aside has no friction at all"
SMOOTH = "the library's own friction: a block of H/B = 2 slides before it rocks"

FACTORS = (
    Factor(
        "contact spring",
        ("frequency", "damping_ratio"),
        (
            level("1e3 Hz", frequency=1e3, damping_ratio=1.0),
            level("1e6 Hz, ratio 10", frequency=1e6, damping_ratio=10.0),
        ),
    ),
    factor("recycling", traps={"fixed": RECYCLED}, name="contact recycling"),
    factor("sleeping", level("off", (DEFAULT,), sleeping=False), by_default=False),
    factor("locked_aside", level("y locked", trap=FRICTIONLESS, locked_aside=True), name="locks"),
    factor("stabilization"),
    factor("substeps"),
    factor("iterations", level("10", BOTH, iterations=10), level("1000", iterations=1000)),
    factor("warm_starting"),
    factor("coulomb", level("Coulomb", BOTH, coulomb=True), name="friction model"),
    factor("friction", level("0.5, the library's own", (DEFAULT,), SMOOTH, friction=0.5)),
    Factor(
        "geometry",
        ("geometry", "planar"),
        (level("4 corners, free", planar=False), level("planar box", geometry="box")),
    ),
    factor("corner_radius", level("B/500", corner_radius=2e-3)),
    MOVING_BASE,
)
"""What its contact can be set to."""

RULES = (
    Rule(
        "Leave the translation out of the plane free: locked, with two rotations, no friction acts",
        *(BEST, "locks", "y locked"),
    ),
    Rule(
        "Switch `contact_recycling` off: what turns slowly slides off an old contact",
        *(BEST, "contact recycling", BY_DEFAULT),
    ),
    Rule(
        "Forbid sleep, `can_sleep(False)`: gravity that changes wakes nothing",
        *(DEFAULT, "sleeping", "off"),
        kept=True,
    ),
    Rule(
        "Stiffen contacts, `contact_softness`: they have 30 Hz, and 60 Hz on what does not move",
        *(BEST, "contact spring", BY_DEFAULT),
    ),
)
"""What its users should know first."""
