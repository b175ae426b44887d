"""Random blocks, frames or slides and pulses, and which of them the reference is sure of."""

import math
from collections.abc import Iterator
from dataclasses import asdict, dataclass, replace
from functools import cache
from itertools import count
from pathlib import Path
from typing import Literal

import numpy as np

from analytic import Rocker, RockingFrame, SlidingBlock, conditioning, frame_demands, simulate
from analytic.block import GRAVITY, RigidBlock
from analytic.motion import Motion, SinePulse
from analytic.record import Record
from engines.scene import BEAM_DEPTH, SPACING

LEAST_NORMAL = 0.2
"""Part of the weight that the reference's normal force keeps, until a block overturns for good."""
FRICTION = 1.0
"""What a frame's contacts may need: those of squat columns need more than engines may have."""
MOST_NEEDED = 0.72
"""What a box may need that stands on a floor at a friction of 0.8."""
CALM = 10.0
"""Condition number up to which a frame is calm."""
SLIPS = 1e-3, 10.0
"""Least slip and longest way, over B, of a slide: shorter is not told from a tremor."""
Drawn = Literal["block", "frame"]
"""Scenes of which random cases are drawn."""
Kind = Literal["pulse", "record", "lean"]
"""What moves a box: a pulse; the example record, at a peak; a pulse, from a lean."""
EXAMPLE = Path(__file__).parents[1] / "blocks" / "example.AT2"
"""The example record."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomCase:
    """A block and a pulse: H/B, B [m]; half cycles, amplitude [g], circular frequency over p."""

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
        omega = self.omega_over_p * self.block.p
        return SinePulse.in_g(self.amplitude_g, omega=omega, half_cycles=self.half_cycles)


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomFrame(RandomCase):
    """A frame and a pulse: sizes of a column, and the beam's mass over that of all columns."""

    columns: int
    load: float

    @property
    def block(self) -> Rocker:
        """The frame."""
        height = self.aspect * self.width_m
        return RockingFrame(width=self.width_m, height=height, columns=self.columns, load=self.load)


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomBox(RandomCase):
    """A box, what moves it, and where it starts [alpha]; a record has a peak alone of a pulse."""

    kind: Kind
    lean: float = 0.0

    @property
    def shaking(self) -> Motion:
        """The pulse, or the record."""
        return _example(self.amplitude_g) if self.kind == "record" else self.motion

    @property
    def start(self) -> tuple[float, float]:
        """Where it is let go at t = 0: rotation [rad], and no rate."""
        return self.lean * self.block.alpha, 0.0


@cache
def _example(peak_g: float) -> Record:
    return Record.read(EXAMPLE).scaled_to(peak_g * GRAVITY)


def draw(seed: int, scene: Drawn = "block") -> Iterator[RandomCase]:
    """Yield without end random cases of which the reference is sure, the same for a seed."""
    kept = filter(_is_sure, _everything(seed, scene))
    for case, drawn in enumerate(kept):
        yield replace(drawn, case=case)


def calm_frames(seed: int) -> Iterator[RandomFrame]:
    """Yield those of `draw` that survive, of 2 to 4 columns, loads from 0.2 to 6, κ below 10."""
    for drawn in _everything(seed, "frame"):
        if isinstance(drawn, RandomFrame) and drawn.columns <= 4 and 0.2 <= drawn.load <= 6.0:
            kappas = conditioning(drawn.block, drawn.motion)  # nan where it does not survive
            if max(map(abs, kappas)) < CALM and _is_sure(drawn):
                yield drawn


def free_boxes(seed: int, kind: Kind = "pulse") -> Iterator[RandomBox]:
    """Yield boxes that rock on a floor at a friction of 0.8, without end, the same for a seed."""
    generator = np.random.default_rng(seed)
    kept = count()
    while True:
        drawn = generator.uniform([0.3, 2.0, 1.1, 0.8], [1.0, 4.5, 1.8, 4.0]).tolist()
        width, aspect, onsets, frequency = drawn
        box = RandomBox(
            case=0,
            aspect=aspect,
            width_m=width,
            half_cycles=int(generator.integers(1, 3)),
            amplitude_g=onsets / aspect * (1.1 if kind == "record" else 1.0),
            omega_over_p=frequency,
            kind=kind,
            lean=float(generator.uniform(-0.6, 0.6)) if kind == "lean" else 0.0,
        )
        exact = simulate(box.block, box.shaking, start=box.start)
        swings = exact.peak_ratio > 1.01 * abs(box.lean)  # beyond where it was let go
        if swings and exact.friction_needed <= MOST_NEEDED and exact.min_normal > LEAST_NORMAL:
            yield replace(box, case=next(kept))


def slides(seed: int) -> Iterator[tuple[SlidingBlock, SinePulse]]:
    """Yield blocks whose slips can be seen and their pulses, without end, the same for a seed."""
    generator = np.random.default_rng(seed)
    while True:
        width, frequency = np.exp(generator.uniform(np.log([0.02, 0.3]), np.log([10.0, 12.0])))
        aspect, friction, onsets = generator.uniform([0.25, 0.05, 1.2], [1.0, 0.6, 5.0]).tolist()
        box = SlidingBlock(width=float(width), height=aspect * float(width), friction=friction)
        omega, half_cycles = float(frequency) * box.p, int(generator.integers(1, 5))
        pulse = SinePulse.in_g(onsets * friction, omega=omega, half_cycles=half_cycles)
        slips = [abs(slip) / box.width for slip in simulate(box, pulse).slips]
        if slips and SLIPS[0] < min(slips) and sum(slips) < SLIPS[1]:
            yield box, pulse


def _everything(seed: int, scene: Drawn) -> Iterator[RandomCase]:
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
        yield drawn


def _is_sure(drawn: RandomCase) -> bool:
    """Return whether the exact motion needs no hold: nothing lifts off, slides or tips."""
    system = drawn.block
    if not isinstance(system, RockingFrame):
        return simulate(system, drawn.motion).min_normal > LEAST_NORMAL
    apart, depth = SPACING * system.height, BEAM_DEPTH * system.height
    needs = frame_demands(system, drawn.motion, spacing=apart, depth=depth)
    holds = max(needs.base, needs.top) <= FRICTION and needs.spacing < apart
    return holds and needs.pressing > LEAST_NORMAL
