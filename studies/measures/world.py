"""The model check: what a world does with one block, beside what it must do, seen from outside."""

import math
from collections.abc import Iterator, Sequence
from contextlib import closing
from typing import NamedTuple

import numpy as np

from analytic import History, RigidBlock, SlidingBlock
from analytic.motion import FloatArray, Still
from analytic.start import REST
from engines.declaration import Stepping
from engines.run.run import build
from engines.scene import System
from engines.world import ContactPhase, Moment, Step
from studies.measures.history import energy
from studies.sources.registry import Source, presets_of, resolve, scene_of

BLOCK = RigidBlock(width=0.5, height=1.5)
BOX = SlidingBlock(width=1.0, height=0.5, friction=0.3)
G, DEPTH = BLOCK.gravity, 0.8
"""Gravity [m/s2], and a depth [m] that is no width: an inertia about another axis is seen."""
LONG_S, DT_S, PULL = 5e-3, 1e-3, 10.0 * G
"""Steps [s] in the air and on the base, and what pulls a block into the air [m/s2]."""
LEAN, RATE = 0.25 * BLOCK.alpha, 0.1 * BLOCK.alpha * BLOCK.p
"""Rotation and rate to which a block is put."""
ONSET, INCLINE = G * math.tan(BLOCK.alpha), 0.6 * G
"""What lifts the block, and the pull along the base under which the box slides [m/s2]."""
OFF = 0.47
"""Part of a step from which on a moment is another one; 16 steps within a step are less off."""
WEIGHT = (0.0, -G)
Pull = tuple[float, float]


class Line(NamedTuple):
    """A quantity of a world: what it must be, what it is found to be, and what they may differ."""

    quantity: str
    expected: float
    found: float
    within: float
    refused: bool = False  # whether no case can be right where it is wrong

    @property
    def wrong(self) -> str:
        """What is wrong with it, or nothing."""
        if abs(self.found - self.expected) <= self.within:
            return ""
        return f"{self.quantity} is {self.found:.4g} and must be {self.expected:.4g}"


def checked(engine: str) -> str:
    """Return the preset of an engine whose contact is checked, too: the best of equal steps."""
    uses = [resolve(f"{engine}:{preset}") for preset in presets_of(resolve(engine))]
    fixed = [use for use in uses if use.used.stepping is Stepping.FIXED]
    return (fixed or uses)[-1].name


def in_the_air(source: Source) -> Iterator[Line]:
    """Yield what a block shows that turns in the air and is pulled for one step, and its moment."""
    # all of the velocity gained moves it within that step where the velocity is changed first, half
    # where both go together, else none
    own, along = source.used.stepping is Stepping.OWN, "base" in source.declared.frames
    kick = (PULL if along else 0.0, -PULL)
    pulls = [(0.0, PULL)] * 4 + [REST] * 24 + [kick] + [REST] * 4
    moment, poses = moved(source, [] if own else pulls, (LEAN, RATE), LONG_S)
    put = _farthest(poses[0, 2] / LEAN, poses[0, 3] / RATE)
    yield Line("rotation or rate at the start, over what it was put to,", 1.0, put, 1e-3, True)
    if own:
        return
    before, within, after = np.diff(poses[:, :2], axis=0)[[-6, -5, -1]]
    gained = (after - before) / np.array([PULL, -PULL]) / LONG_S**2
    gained = gained if along else gained[1:]
    yield Line("velocity gained in the air, over pull times step,", 1.0, _farthest(*gained), 1e-3)
    spin = (poses[28, 2] - poses[8, 2]) / (20.0 * LONG_S * RATE)
    yield Line("rate of turning in the air, over that at the start,", 1.0, spin, 2e-3)
    if after[1] != before[1]:  # what does not move has no moment
        part = float((within - before)[1] / (after - before)[1])
        words = "moment of a step at which its velocities hold"
        yield Line(words, Moment.NEXT.value - part, moment.value, OFF, True)


def on_the_base(source: Source) -> Iterator[Line]:
    """Yield how a block rebounds from its base, and where it turns when pulled past its onset."""
    pulls = [(0.0, PULL)] * 4 + [WEIGHT] * 196 + [(2.0 * ONSET, -G)] * 100
    _, poses = moved(source, pulls, each=steps_of(source))
    speed = np.diff(poses[:200, 1]) / DT_S
    lands = int(np.argmin(speed))
    rebound = float(speed[lands:].max() / -speed[lands])
    yield Line("speed after a fall flat on the base, over that before,", 0.0, rebound, 0.05)
    side = float(np.sign(np.round(poses[-1, 2], 3)))
    yield Line("sign of theta where a block is pulled towards +x", 1.0, side, 0.0, True)


def in_contact(source: Source) -> Iterator[Line]:
    """Yield friction, balance, inertia and restitution, from a slide and from two falls."""
    # a fall's acceleration K sin(theta - alpha) on either side of alpha gives alpha, K and inertia
    steps = steps_of(source)
    if source.used.stepping is Stepping.FIXED:
        _, poses = moved(source, [(INCLINE, -G)] * 200, system=BOX, each=steps)
        speed = np.diff(poses[:, 0])[[40, -1]] / DT_S
        found = (INCLINE - (speed[1] - speed[0]) / (159.0 * DT_S)) / G
        yield Line("friction on an incline", BOX.friction, float(found), 0.01)
    falls = [
        moved(source, [WEIGHT] * count, (lean * BLOCK.alpha, 0.0), each=steps)[1][:, 2]
        for lean, count in ((0.4, 440), (1.6, 150))
    ]
    parts, gained = [], []
    for theta in (fall[20:150] for fall in falls):
        parts.append([np.sin(theta[1:-1]).sum(), -np.cos(theta[1:-1]).sum()])
        gained.append((theta[-1] - theta[-2] - theta[1] + theta[0]) / DT_S**2)
    upright, across = np.linalg.solve(parts, gained)
    balance, stiffness = math.atan2(across, upright), math.hypot(upright, across)
    yield Line("rotation at which a block balances", BLOCK.alpha, balance, 5e-3 * BLOCK.alpha)
    inertia = (BLOCK.width**2 + BLOCK.height**2) / 12.0
    found = G * BLOCK.R / stiffness - BLOCK.R**2
    yield Line("inertia over mass [m2]", inertia, found, 0.015 * inertia)
    theta, struck = falls[0], int(np.argmax(falls[0] < 0.0))
    rate = (theta[2:] - theta[:-2]) / (2.0 * DT_S)
    energies = energy(BLOCK, History(np.empty(0), theta[1:-1], rate))
    before, after = energies[struck - 60 : struck - 10], energies[struck + 10 : struck + 60]
    kept = math.sqrt(np.median(after) / np.median(before)) if struck > 60 else math.nan
    yield Line("ratio of rates after and before an impact", BLOCK.restitution, kept, 0.02)


def check(source: Source) -> list[Line]:
    """Return what a world shows: of the preset that `checked` names all, of others what refuses."""
    with np.errstate(all="ignore"):  # what never moves has no rebound: nan, which is wrong
        lines = list(in_the_air(source))
        if source.used.stepping is Stepping.OWN:
            return lines
        if "base" in source.declared.frames:
            lines += on_the_base(source)
        if source.name != checked(source.engine):
            return [line for line in lines if line.refused]
        refused = any(line.refused and line.wrong for line in lines)
        return lines if refused else [*lines, *in_contact(source)]


def steps_of(source: Source) -> int:
    """Return into how many steps DT_S is divided, so that none is longer than the preset's own."""
    longest = source.used.step / BLOCK.p
    return math.ceil(DT_S / longest) if longest < DT_S else 1


def moved(
    source: Source,
    pulls: Sequence[Pull],
    start: Pull = REST,
    time_s: float = DT_S,
    system: System = BLOCK,
    each: int = 1,
) -> tuple[Moment, FloatArray]:
    """Return a world's moment, and its block's poses: at first, and after each pull."""
    frame = "base" if "base" in source.declared.frames else None  # a base that moves is pulled, too
    dt_s = time_s / each
    how = {"step": dt_s * system.p, "frame": frame, "start": start, "depth": DEPTH, "rest_s": 0.0}
    scene = scene_of(system, Still(), source.preset, **how)
    with closing(build(source.declared.use(scene))) as world:
        poses = [np.array(world.state(), float)[0]]
        for number in range(len(pulls) * each):
            pull = (*pulls[number // each], 0.0, 0.0, 0.0)
            world.step(Step(dt_s, (number + 1) * dt_s, dt_s, *pull, ContactPhase.SWING, 0.0))
            poses.append(np.array(world.state(), float)[0])
        if problem := world.fault():
            raise ValueError(f"its world reports a fault: {problem}")
        return world.moment, np.array(poses)[::each]


def _farthest(*parts: float) -> float:
    return float(max(parts, key=lambda part: abs(part - 1.0)))
