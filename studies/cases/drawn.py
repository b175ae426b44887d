"""Random blocks or frames and pulses, and which of them the reference is sure of."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from itertools import count
from typing import Literal

import numpy as np

from analytic import RockingFrame, frame_demands, simulate
from analytic.block import GRAVITY, RigidBlock, Rocker
from analytic.motion import SinePulse
from analytic.response import Response
from engines.layouts import BEAM_DEPTH, SPACING

LEAST_NORMAL = 0.2
"""Cases are kept where the reference's normal force stays above this part of the weight.

That of a block that overturns until it passes the critical rotation for good.
"""


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomCase:
    """A block and a pulse drawn at random.

    Attributes
    ----------
    case : int
        Its number, from 0.
    aspect, width_m : float
        H/B, and B [m].
    half_cycles, amplitude_g, omega_over_p : int, float, float
        Length, amplitude [g] and circular frequency over p of the pulse.
    """

    case: int
    aspect: float
    width_m: float
    half_cycles: int
    amplitude_g: float
    omega_over_p: float

    @property
    def block(self) -> Rocker:
        """The block."""
        return RigidBlock(width=self.width_m, height=self.aspect * self.width_m)

    @property
    def motion(self) -> SinePulse:
        """The pulse."""
        return SinePulse(
            amplitude=self.amplitude_g * GRAVITY,
            omega=self.omega_over_p * self.block.p,
            half_cycles=self.half_cycles,
        )


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomFrame(RandomCase):
    """A frame and a pulse drawn at random; aspect and width are a column's.

    Attributes
    ----------
    columns : int
    load : float
        Mass of the beam over that of all columns.
    """

    columns: int
    load: float

    @property
    def block(self) -> Rocker:
        """The frame."""
        height = self.aspect * self.width_m
        return RockingFrame(width=self.width_m, height=height, columns=self.columns, load=self.load)


Drawn = Literal["block", "frame"]
"""Scenes of which random cases are drawn."""

KINDS: dict[Drawn, type[RandomCase]] = {"block": RandomCase, "frame": RandomFrame}
"""Scene -> its random cases."""

KEPT, NEAR, LIFTED, SLIDES, TIPS = "kept", "near", "lifted", "slides", "tips"
"""What becomes of what was drawn: all but the first are left out."""

FRICTION = 1.0
"""What a frame's contacts may need: those of squat columns need more than engines may have."""


def draw(seed: int, scene: Drawn = "block") -> Iterator[RandomCase]:
    """Yield random cases without end, the same ones for the same seed.

    H/B from 1.2 to 12, B from 0.02 to 10 m, 1 to 4 half cycles, amplitudes from 1.02 to 4 onsets
    and omega/p from 0.3 to 12, width and frequency with uniform logarithms; only where the
    reference's normal force stays above LEAST_NORMAL weights. Frames have 2 to 5 columns and loads
    from 0.1 to 10, with uniform logarithms; only where their beam would not tip, nor anything slide
    by a friction of FRICTION.

    Parameters
    ----------
    seed : int
        Of `numpy.random.default_rng`; not negative.
    scene : {"block", "frame"}, optional

    Yields
    ------
    RandomCase
        Of frames, a `RandomFrame`; `case` counts from 0 those that are kept.
    """
    kept = (drawn for drawn, exact in everything(seed, scene) if fate_of(drawn, exact) == KEPT)
    for case, drawn in enumerate(kept):
        yield replace(drawn, case=case)


def fate_of(drawn: RandomCase, exact: Response) -> str:
    """Say whether a case is kept, or why it is left out.

    Parameters
    ----------
    drawn : RandomCase
    exact : Response
        Its exact response, of which a block's `min_normal` is used; a frame's contacts are looked
        at by `analytic.frame_demands`.

    Returns
    -------
    str
        KEPT; NEAR, where the smallest normal force is at most LEAST_NORMAL weights; LIFTED, where
        it is not positive. Of a frame also SLIDES, where a contact needs more friction than
        FRICTION, and TIPS, where the beam would tip.
    """
    system, normal = drawn.block, exact.min_normal
    if isinstance(system, RockingFrame):
        apart, depth = SPACING * system.height, BEAM_DEPTH * system.height
        needs = frame_demands(system, drawn.motion, spacing=apart, depth=depth)
        if needs.spacing >= apart:
            return TIPS
        if needs.pressing > 0.0 and max(needs.base, needs.top) > FRICTION:
            return SLIDES
        normal = needs.pressing
    return KEPT if normal > LEAST_NORMAL else NEAR if normal > 0.0 else LIFTED


def everything(seed: int, scene: Drawn = "block") -> Iterator[tuple[RandomCase, Response]]:
    """Yield all that is drawn, kept or not, with its exact response; without end.

    Parameters
    ----------
    seed, scene
        As for `draw`.

    Yields
    ------
    RandomCase, Response
        `case` counts from 0 all that is drawn.
    """
    generator = np.random.default_rng(seed)
    for number in count():
        aspect = float(generator.uniform(1.2, 12.0))
        drawn = RandomCase(
            case=number,
            aspect=aspect,
            width_m=math.exp(generator.uniform(math.log(0.02), math.log(10.0))),
            half_cycles=int(generator.integers(1, 5)),
            amplitude_g=float(generator.uniform(1.02, 4.0)) / aspect,
            omega_over_p=math.exp(generator.uniform(math.log(0.3), math.log(12.0))),
        )
        if scene == "frame":
            columns = int(generator.integers(2, 6))
            load = math.exp(generator.uniform(math.log(0.1), math.log(10.0)))
            drawn = RandomFrame(**asdict(drawn), columns=columns, load=load)
        yield drawn, simulate(drawn.block, drawn.motion)
