"""What an engine's world shows before any case: its methods, its signs, its moment, its inertia.

A block is thrown off its base, left alone, and pulled during one step. How much of the velocity
gained moves it within that step says what comes first: all of it where the velocity is changed
first, half where both go together, none where the position is changed first. And a block is let go
that leans: the second half of its turn, over twice the first, does not depend on that moment, and
misses the exact one by a second order of the step, unless inertia, size or gravity are others.
"""

from __future__ import annotations

import math
from contextlib import closing
from typing import cast

import numpy as np
import pandas as pd

from analytic import RigidBlock, SinePulse, simulate
from analytic.motion import FloatArray, Still
from engines.declaration import UNTUNED, Stepping
from engines.run.run import NotAvailableError, build
from engines.world import ContactPhase, Moment, Step, SteppedWorld
from studies.kit.jobs import Job, Row
from studies.kit.say import brief, listed, one_line
from studies.measures.presets import preset_of
from studies.sources.registry import Source, resolve, scene_of

BLOCK = RigidBlock(width=0.5, height=1.5)
UNFELT = SinePulse(amplitude=1e-9, omega=6.2832)
"""A motion is posed, and never reached: the steps here leave the base where it is."""
FLIGHT_STEP, TURN_STEP = 0.02, 2e-3
"""p dt of a flight, and of a turn, which is made once more with half of it."""
THROWN, ALONE, AFTER = 4, 24, 4
"""Steps of the throw, those in which nothing pulls, and those after the one that pulls."""
PULL = 10.0
"""Pull up, and later down, in units of gravity."""
OFF = 0.47
"""Part of a step from which on a moment is another one: what takes 16 steps within a step has
less."""
LEANING, RELEASED = 0.25, 0.4
"""Rotation from which a block is let go, in units of alpha, and for how long, in units of 1/p;
farther out small balls, which some engines have for corners, change the lever of the weight."""
MOST, SHRUNK = 1e-3, 0.7
"""Part by which a turn may be off, a third of what a gravity of 9.80665 m/s2 makes, and the part of
its error that is left at most when its step is halved."""
WEIGHTS = np.array([1.0, -2.0, 1.0])
"""Of the rotations at the begin, in the middle and at the end of a turn."""
UNKNOWN = dict.fromkeys(("declared", "measured", "turn_error", "turn_error_half"), math.nan)
TURNED = "the sign is wrong; theta is positive where it leans towards +x"


def world_of(source: Source, step: float, start: tuple[float, float] = (0.0, 0.0)) -> SteppedWorld:
    """Build the block, on a base that is not moved, in steps of p dt."""
    frame = "base" if "base" in source.declared.frames else None  # a base that moves is pulled, too
    scene = scene_of(BLOCK, UNFELT, source.preset, step=step, frame=frame, start=start)
    return cast(SteppedWorld, build(source.declared.use(scene)))


def take(
    world: SteppedWorld, step: float, pulls: FloatArray, pull_x: float = 0.0, theta: bool = True
) -> FloatArray:
    """Let a world take equal steps of p dt; return its angles or heights, the first one before any.

    It is pulled up and along the base [m/s2]; nothing moves that.
    """
    dt_s, place = step / BLOCK.p, 2 if theta else 1
    phase = ContactPhase.SWING, 1.0 if theta else 0.0
    found = [float(np.asarray(world.state(), float)[0, place])]
    for number, pull in enumerate(pulls.tolist(), start=1):
        world.step(Step(dt_s, number * dt_s, dt_s, pull_x, pull, 0.0, 0.0, 0.0, *phase))
        found.append(float(np.asarray(world.state(), float)[0, place]))
    return np.array(found)


def weight(step: float) -> FloatArray:
    """Return the pull of gravity in each step of a turn [m/s2]."""
    return np.full(2 * round(0.5 * RELEASED / step), -BLOCK.gravity)


def problem_of(name: str) -> str:
    """Say in a line what a source's world lacks, or how it turns the wrong way round.

    What it raises is no matter of this: its cases will say so.
    """
    source = resolve(name)
    lean, rate = LEANING * BLOCK.alpha, 0.1 * BLOCK.alpha * BLOCK.p
    steps = source.used.stepping is not Stepping.OWN
    whole = ("state", "fault", "close", "step" if steps else "advance")
    try:
        world = world_of(source, TURN_STEP, (lean, rate))
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
        if steps and "base" in source.declared.frames:
            world = world_of(source, TURN_STEP)
            onset = BLOCK.gravity * math.tan(BLOCK.alpha)
            theta = take(world, TURN_STEP, weight(TURN_STEP), 2.0 * onset)[-1]
            world.close()
            if theta < -1e-3:
                return f"pulled towards +x, its block turns to theta {theta:.3g}: {TURNED}"
    except BaseException:
        return ""
    return ""


def measure_moment(job: Job) -> Row:
    """Fly a block, and read at which moment of a step its velocity holds; let it turn twice.

    The moments are in steps from the begin of one, the errors parts by which it turns too far. It
    fails for a preset that takes its own steps, an engine that is not available or raises, and one
    that a pull does not move as it should.
    """
    found, message = {**UNKNOWN}, "not asked: it takes no steps that others choose"
    if job.lost is not None:
        message = job.lost.message
    elif job.asked.used.stepping is not Stepping.OWN:
        try:
            found, message = _measured(job.asked)
        except NotAvailableError as error:
            message = str(error)
        except Exception as error:  # it is anybody's code
            message = one_line(error)
    return {"outcome": "failed" if message else "slid", **found, "message": brief(message)}


def _measured(source: Source) -> tuple[dict[str, float], str]:
    pulls = np.array([*[PULL] * THROWN, *[0.0] * ALONE, -PULL, *[0.0] * AFTER]) * BLOCK.gravity
    with closing(world_of(source, FLIGHT_STEP)) as world:
        declared = world.moment.value
        heights = take(world, FLIGHT_STEP, pulls, theta=False)
    before, within, after = np.diff(heights)[-AFTER - 2 :][[0, 1, -1]]
    gain = (after - before) / (-PULL * BLOCK.gravity * (FLIGHT_STEP / BLOCK.p) ** 2)
    if not 0.5 < gain < 2.0:
        words = f"a pull for one step gave {gain + 0.0:.3g} of the velocity that it should"
        return {**UNKNOWN}, words
    measured = float(Moment.NEXT.value - (within - before) / (after - before))
    errors = turn_error(source, TURN_STEP), turn_error(source, 0.5 * TURN_STEP)
    return dict(zip(UNKNOWN, (declared, measured, *errors), strict=True)), ""


def turn_error(source: Source, step: float) -> float:
    """Return by what part the block turns too far when it is let go, in steps of p dt."""
    start = LEANING * BLOCK.alpha, 0.0
    times = np.array([0.0, 0.5, 1.0]) * RELEASED / BLOCK.p
    exact = simulate(BLOCK, Still(), start=start, times=times, duration=times[-1]).history
    assert exact is not None
    with closing(world_of(source, step, start)) as world:
        thetas = take(world, step, weight(step))
    return float(thetas[[0, len(thetas) // 2, -1]] @ WEIGHTS / (exact.theta @ WEIGHTS) - 1.0)


def nearest(measured: float) -> str:
    """Return the name of the moment that is nearest to a measured one."""
    return min(Moment, key=lambda moment: abs(moment.value - measured)).name


def wrong_moment(table: pd.DataFrame) -> str:
    """Say which presets declare a moment half a step or more from theirs, if any."""
    off = table[(table["measured"] - table["declared"]).abs() >= OFF]
    if off.empty:
        return ""
    declared, measured = off[["declared", "measured"]].iloc[0]
    later = "later" if measured > declared else "earlier"
    return (
        f"Wrong moment: the velocities of {listed(off['source'])} hold "
        f"{abs(measured - declared):.2g} of a step {later} than the Moment.{nearest(declared)} "
        f"that its world declares; declare Moment.{nearest(measured)}."
    )


def wrong_quantity(table: pd.DataFrame) -> str:
    """Say which tuned presets have an error that does not shrink with the step, and of what."""
    tuned = table[~table["source"].map(preset_of).isin(UNTUNED)]
    coarse, fine = tuned["turn_error"].abs(), tuned["turn_error_half"].abs()
    wrong = tuned[(fine > MOST) & (fine > SHRUNK * coarse)]
    if wrong.empty:
        return ""
    errors = wrong[["turn_error", "turn_error_half"]].iloc[0]
    coarse_part, fine_part = (f"{abs(error):.2%}" for error in errors)
    return (
        f"Wrong quantity: {listed(wrong['source'])} let a block turn {coarse_part} too "
        f"{'far' if errors.iloc[0] > 0.0 else 'little'}, and {fine_part} with half the step; "
        "probably mass, inertia, size or gravity is wrong, or the contact yields."
    )
