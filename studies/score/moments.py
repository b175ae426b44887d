"""Whether a world's velocity holds at the `Moment` of a step that it declares.

A block is thrown off its base, left alone, and pulled during one step: it moves by one straight
line before and by another after. How much of the velocity gained moves it within that step says
what comes first: all of it where the velocity is changed first, half where both go together, none
where the position is changed first.
"""

from __future__ import annotations

import math

import numpy as np
import pandas as pd

from analytic.motion import FloatArray
from analytic.response import Outcome, Response
from engines.declaration import Stepping
from engines.run.drive import NotAvailableError
from engines.world import ContactPhase, Moment, Step, SteppedWorld
from studies.old.jobs import Job
from studies.old.journal import Row
from studies.old.refusing import brief, one_line
from studies.measures.words import listed
from studies.score.release import turn_errors, world_of
from studies.sources.registry import Source

STEP = 0.02
"""p dt."""
THROWN, ALONE, AFTER = 4, 24, 4
"""Steps of the throw, those in which nothing pulls, and those after the one that pulls."""
FOUND = ("declared", "measured", "turn_error", "turn_error_half")
"""What is observed, and the columns of the table."""
PULL = 10.0
"""Pull up, and later down, in units of gravity."""
OFF = 0.47
"""Part of a step from which on a lag is half a step: what takes 16 steps within a step has less."""
CLOSE = 0.03
"""Part of a step up to which a moment is the declared one."""


def ask_for_moment(job: Job, source: Source) -> Response:
    """Fly a block by a source, and read at which moment of a step its velocity holds.

    Parameters
    ----------
    job : Job
        Of BLOCK under UNFELT.
    source : Source
        An engine's preset.

    Returns
    -------
    Response
        Its observables are declared and measured, moments in steps from the begin of one, and the
        errors of `turn_errors`. Failed, with the reason, of a preset that takes its own steps, an
        engine that is not available or raises, and one that a pull does not move as it should.

    Raises
    ------
    KeyError
        If the source is no engine.
    """
    if source.used.stepping is Stepping.OWN:
        return Response.failure("not asked: it takes no steps that others choose")
    try:
        world = world_of(source, STEP)
    except NotAvailableError as error:
        return Response.failure(str(error))
    try:
        heights, declared = flown(world, STEP / job.block.p, job.block.gravity), world.moment.value
        turn_error, turn_error_half = turn_errors(source)
    except Exception as error:  # it is anybody's code
        return Response.failure(one_line(error))
    finally:
        world.close()
    before, within, after = np.diff(heights)[-AFTER - 2 :][[0, 1, -1]]
    gain = (after - before) / (-PULL * job.block.gravity * (STEP / job.block.p) ** 2)
    if not 0.5 < gain < 2.0:
        return Response.failure(
            f"a pull for one step gave {gain + 0.0:.3g} of the velocity that it should"
        )
    measured = Moment.NEXT.value - (within - before) / (after - before)
    observed = {"declared": declared, "measured": float(measured)}
    observed |= {"turn_error": turn_error, "turn_error_half": turn_error_half}
    return Response(outcome=Outcome.SLID, peak_ratio=0.0, observables=observed)


def flown(world: SteppedWorld, dt_s: float, gravity: float) -> FloatArray:
    """Return the heights [m] of a block's centre at the ends of the steps of its flight."""
    pulls = np.array([*[PULL] * THROWN, *[0.0] * ALONE, -PULL, *[0.0] * AFTER]) * gravity
    heights = [float(world.state()[0][1])]
    for number, pull in enumerate(pulls.tolist(), start=1):
        world.step(
            Step(dt_s, number * dt_s, dt_s, 0.0, pull, 0.0, 0.0, 0.0, ContactPhase.SWING, 0.0)
        )
        heights.append(float(world.state()[0][1]))
    return np.array(heights)


def reduced(response: Response) -> Row:
    """Return the columns of a row: the moments, in steps from the begin of one, and the errors."""
    found = {name: response.observables.get(name, math.nan) for name in FOUND}
    return {"outcome": response.outcome.value, **found, "message": brief(response.message)}


def judged(table: pd.DataFrame) -> pd.DataFrame:
    """Return the table of moments as a reader sees it, with what each preset's is."""
    numbers = table[["declared", "measured"]].to_numpy(float)
    said = [_said(*pair) or str(why) for pair, why in zip(numbers, table["message"], strict=True)]
    return table[["source", "declared", "measured"]].assign(velocity=said)


def _said(declared: float, measured: float) -> str:
    lag = abs(measured - declared)
    if math.isnan(lag) or lag <= CLOSE:
        return "" if math.isnan(lag) else "as declared"
    if lag < OFF:
        count = 0.5 / max(abs(1.0 - measured), CLOSE)
        several = round(count) > 1 and abs(count - round(count)) < 0.1
        cause = f", as by {count:.0f} steps within a step" if several else ""
        return f"between two moments{cause}"
    return f"{lag:.2g} of a step off: {_nearest(measured).name}, not {Moment(declared).name}"


def _nearest(measured: float) -> Moment:
    return min(Moment, key=lambda moment: abs(moment.value - measured))


def accusation(table: pd.DataFrame) -> str:
    """Say which presets declare a moment half a step or more from theirs, and what shows it."""
    off = table[(table["measured"] - table["declared"]).abs() >= OFF]
    if off.empty:
        return ""
    source, (declared, measured) = off["source"].iloc[0], off[["declared", "measured"]].iloc[0]
    parts = [f"{max(Moment.NEXT.value - moment, 0.0):.0%}" for moment in (measured, declared)]
    name, later = Moment(declared).name, "later" if measured > declared else "earlier"
    return (
        f"Wrong moment: {listed([*off['source']])}. {source} declares Moment.{name} and does not "
        "step so: of the velocity that a pull for one step gives a block in the air, "
        f"{parts[0]} moves it within that step, where {name} means {parts[1]}. Velocities hold "
        f"{abs(measured - declared):.2g} of a step {later} than they are taken to below, as forces "
        f"act and as rates are read. Declare Moment.{_nearest(measured).name}."
    )
