"""What a block shows before any case: how its world is read, and how fast it turns when let go.

The second half of a turn from rest, over twice the first, does not depend on the moment at which
velocities hold: what it misses of the exact one is of the second order in the step, unless the
block has another inertia, another size or another gravity.
"""

from __future__ import annotations

import math
from typing import cast

import numpy as np
import pandas as pd

from analytic import RigidBlock, SinePulse, simulate
from analytic.motion import Still
from engines.declaration import UNTUNED, Stepping
from engines.run.drive import build
from engines.world import ContactPhase, Moment, Step, SteppedWorld
from studies.measures.presets import preset_of
from studies.measures.words import listed
from studies.sources.registry import Source, resolve, scene_of

BLOCK = RigidBlock(width=0.5, height=1.5)
UNFELT = SinePulse(amplitude=1e-9, omega=6.2832)
"""A motion is posed, and never reached: the steps here leave the base where it is."""
LEANING = 0.25
"""Rotation from which a block is let go, in units of alpha; farther out small balls, which some
engines have for corners, change the lever of the weight by more than `MOST`."""
RELEASED = 0.4
"""How long it is watched, in units of 1/p."""
STEP = 2e-3
"""p dt, and once more half of it."""
MOST = 1e-3
"""Part by which a turn may be off; gravity of 9.80665 m/s2 in place of 9.81 is a third of it."""
SHRUNK = 0.7
"""Part of its error that a turn must lose when its step is halved; a half is of the first order."""
METHODS = ("state", "fault", "close")
"""What every world has."""


def world_of(source: Source, step: float, start: tuple[float, float] = (0.0, 0.0)) -> SteppedWorld:
    """Build the block, on a base that is not moved, in steps of p dt."""
    frame = "base" if "base" in source.declared.frames else None  # a base that moves is pulled, too
    scene = scene_of(BLOCK, UNFELT, source.preset, step=step, frame=frame, start=start)
    return cast(SteppedWorld, build(source.declared, scene))


def take(world: SteppedWorld, step: float, numbers: range, pull_x: float = 0.0) -> None:
    """Let a world take equal steps of p dt, pulled down by gravity and along the base [m/s2]."""
    dt_s = step / BLOCK.p
    for number in numbers:
        pulls = pull_x, -BLOCK.gravity
        phase = ContactPhase.SWING, 1.0
        world.step(Step(dt_s, number * dt_s, dt_s, *pulls, 0.0, 0.0, 0.0, *phase))


def problem_of(name: str) -> str:
    """Say in a line what a source's world lacks, or how it turns the wrong way round.

    What it raises is no matter of this: its cases will say so.
    """
    source = resolve(name)
    lean, rate = LEANING * BLOCK.alpha, 0.1 * BLOCK.alpha * BLOCK.p
    try:
        world = world_of(source, STEP, (lean, rate))
        whole = (*METHODS, "advance" if source.used.stepping is Stepping.OWN else "step")
        for method in whole:
            if not callable(getattr(world, method, None)):
                return f"its world has no method {method}; it must have {', '.join(whole)}"
        if not isinstance(getattr(world, "moment", None), Moment):
            return "its world has no moment; it must be one of Moment.MIDDLE, END and NEXT"
        pose = np.asarray(world.state(), float)
        if pose.shape != (1, 4):
            return f"its state has the shape {pose.shape}; it must be (1, 4): x, z, theta, rate"
        for what, found, put in (("theta", pose[0, 2], lean), ("rate", pose[0, 3], rate)):
            if abs(found + put) < 0.01 * put:
                return f"its state says {what} {found:.3g} of a block put to {put:.3g}: {TURNED}"
        world.close()
        if source.used.stepping is Stepping.OWN or "base" not in source.declared.frames:
            return ""
        world = world_of(source, STEP)
        onset = BLOCK.gravity * math.tan(BLOCK.alpha)
        take(world, STEP, range(1, round(RELEASED / STEP) + 1), 2.0 * onset)
        theta = float(np.asarray(world.state(), float)[0, 2])
        world.close()
    except BaseException:
        return ""
    return f"pulled towards +x, its block turns to theta {theta:.3g}: {TURNED}" * (theta < -1e-3)


TURNED = "the sign is wrong; theta is positive where it leans towards +x"


def turn_errors(source: Source) -> tuple[float, float]:
    """Return by what part the block turns too far when it is let go, with p dt and half of it."""
    start = LEANING * BLOCK.alpha, 0.0
    times = np.array([0.0, 0.5, 1.0]) * RELEASED / BLOCK.p
    exact = simulate(BLOCK, Still(), start=start, times=times, duration=times[-1]).history
    assert exact is not None
    errors = [turned(source, step) / (exact.theta @ WEIGHTS) - 1.0 for step in (STEP, STEP / 2.0)]
    return errors[0], errors[1]


WEIGHTS = np.array([1.0, -2.0, 1.0])
"""Of the rotations at the begin, in the middle and at the end."""


def turned(source: Source, step: float) -> float:
    """Return the second half of a turn from rest less the first [rad], in steps of p dt."""
    world = world_of(source, step, (LEANING * BLOCK.alpha, 0.0))
    half = round(0.5 * RELEASED / step)
    try:
        thetas = [float(world.state()[0][2])]
        for first in (1, 1 + half):
            take(world, step, range(first, first + half))
            thetas.append(float(world.state()[0][2]))
    finally:
        world.close()
    return float(np.array(thetas) @ WEIGHTS)


def suspicion(table: pd.DataFrame) -> str:
    """Say which tuned presets have an error that does not shrink with the step, and of what."""
    tuned = table[~table["source"].map(preset_of).isin(UNTUNED)]
    coarse, fine = tuned["turn_error"].abs(), tuned["turn_error_half"].abs()
    wrong = tuned[(fine > MOST) & (fine > SHRUNK * coarse)]
    if wrong.empty:
        return ""
    source, *errors = wrong[["source", "turn_error", "turn_error_half"]].iloc[0]
    parts = [f"{abs(error):.2%} too {'far' if error > 0.0 else 'little'}" for error in errors]
    return (
        f"Wrong quantity: {listed([*wrong['source']])}. Let go at {LEANING:g} α, the block of "
        f"{source} turns {parts[0]} with p dt = {STEP:g}, and {parts[1]} with half of it: the "
        "error does not shrink with the step. Probably its mass, inertia, size or gravity is "
        "wrong, or its contact yields."
    )
