"""States in, slips out: what is seen of a box that slides flat along its base.

See EQUATIONS.md, "The sliding block".
"""

import math
from dataclasses import dataclass
from typing import cast

import numpy as np

from analytic.response import History, Outcome, Response
from engines.run.rows import Row, put
from engines.run.watch import DIVERGED, LYING, LYING_PART, SANK, THROWN, THROWN_WIDTHS
from engines.scene import Scene
from engines.world import FloatArray, Pose

SLIP_RATE, LEAST_SLIP = 3e-4, 1e-5
"""A box slides when it is faster than this part of sqrt(g B): what it still goes when it is slower,
v^2/(2 mu g), is below 1e-7 B/mu. A slip shorter than this part of the width is a tremor."""

STILL_TIME, TREMORS = 0.05, 20.0
"""A box is at rest when it has not slid for this time, in units of sqrt(B/g); one that trembles
where it is, after this many times as long."""

LEAST_LIFT = 1e-4
"""A box is thrown off when it rises by more than this part of its width and than its contact gives
way, or holds it above the base, from the lowest place after a tremor's time."""

STOP, DISTANCE, SINCE = range(3)
"""Columns of slips: the end [s], the distance with its sign [m], the beginning [s]."""


@dataclass(slots=True)
class Slide:
    """What was seen of a box until now; on says whether there is one."""

    on: bool = False
    home: float = 0.0  # where its centre begins [m]
    half_height: float = 0.0
    width: float = 0.0
    slow: float = 0.0  # velocity up to which it does not slide [m/s]
    still: float = 0.0  # time after which it is at rest [s]
    motion_end: float = 0.0
    latest: float = 0.0  # by when it should have stopped twice over [s]
    end: float = 0.0  # of the observation [s]
    keeps_rows: bool = False  # a history is wanted
    place: float = 0.0  # last one relative to the base [m]
    origin: float = 0.0  # where it slides or rests from, `since` when
    stays_at: float = 0.0  # where it has moved by no more than a tremor, `stays_since` when
    time: float = 0.0
    since: float = 0.0
    stays_since: float = 0.0
    way: float = 0.0  # which way it slides, 0 while it does not
    rows: int = 0
    slips: int = 0  # how many have ended
    lift: float = 0.0  # how high its centre was beyond where it begins [m]
    turn: float = 0.0  # how far it turned [rad]
    depth: float = 0.0  # how deep its centre was [m]
    level: float = 0.0  # where it lies [m]
    overturned: bool = False
    done: bool = False
    problem: int = 0  # as of `watch`
    far: float = 0.0


def begin_slide(scene: Scene) -> Slide:
    """Return where a box that slides begins."""
    body, gravity, motion = scene.bodies[0], scene.system.gravity, scene.motion
    place = body.at.x - body.home[0]
    still = STILL_TIME * math.sqrt(body.width / gravity)
    fastest = 2.0 * abs(motion.velocity(np.linspace(0.0, motion.duration, 1001))).max()
    slows = max(cast(float, scene.friction), 1e-3) * gravity
    return Slide(
        on=True,
        home=body.home[0],
        half_height=0.5 * body.height,
        width=body.width,
        slow=SLIP_RATE * math.sqrt(gravity * body.width),
        still=still,
        motion_end=motion.duration,
        latest=motion.duration + 2.0 * (fastest + abs(scene.start[1])) / slows + TREMORS * still,
        end=math.inf if scene.duration is None else scene.duration,
        keeps_rows=scene.times is not None,
        place=place,
        origin=place,
        stays_at=place,
    )


def see_slide(slide: Slide, rows: FloatArray, slips: FloatArray, time: float, pose: Pose) -> None:
    """Take in a pose at the end [s] of a step; a row has place [m] and velocity [m/s]."""
    if not math.isfinite(pose.x + pose.z + pose.theta + pose.rate):
        slide.problem = DIVERGED
        return
    place = pose.x - slide.home
    velocity = (place - slide.place) / (time - slide.time)
    if slide.keeps_rows:
        put(rows, slide.rows, Row(time, 0.5 * (slide.time + time), place, velocity))
        slide.rows += 1
    way = math.copysign(1.0, velocity) if abs(velocity) > slide.slow else 0.0
    if way != slide.way:
        end_slip(slide, slips, time, place)
        slide.since, slide.origin, slide.way = slide.time, slide.place, way
        if way == 0.0:
            slide.since, slide.origin = time, place
    slide.place, slide.time = place, time
    if abs(place - slide.stays_at) > LEAST_SLIP * slide.width:
        slide.stays_since, slide.stays_at = time, place
    raised = pose.z - slide.half_height
    slide.lift, slide.depth = max(slide.lift, raised), max(slide.depth, -raised)
    settled = time >= TREMORS * slide.still
    slide.level = min(slide.level, raised) if settled else raised
    slide.turn = max(slide.turn, abs(pose.theta))
    if pose.z < 0.0:
        slide.problem, slide.far = SANK, slide.depth
    elif raised > THROWN_WIDTHS * slide.width + slide.half_height:
        slide.problem, slide.far = THROWN, raised
    slide.overturned = abs(pose.theta) > LYING_PART * LYING
    stays = time - slide.stays_since >= TREMORS * slide.still
    rests = stays or (slide.way == 0.0 and time - slide.since >= slide.still)
    # an engine may let it creep on for ever
    over = slide.end == math.inf and time >= (slide.motion_end if rests else slide.latest)
    slide.done = slide.overturned or over or time >= slide.end


def end_slip(slide: Slide, slips: FloatArray, time: float, place: float) -> None:
    """Write the slip that is under way, if there is one, down as ended at a time and place."""
    if slide.way != 0.0 and abs(place - slide.origin) > LEAST_SLIP * slide.width:
        put(slips, slide.slips, (time, place - slide.origin, slide.since, 0.0))
        slide.slips += 1


def slide_response(slide: Slide, slips: FloatArray, history: History | None) -> Response:
    """Return what was seen of a box that slides; the last slip counts as far as it got."""
    end_slip(slide, slips, slide.time, slide.place)
    slide.way = 0.0
    seen = slips[: slide.slips]
    slid = Outcome.SLID if slide.slips else Outcome.AT_REST
    lift, flat = slide.lift - max(slide.level, 0.0), max(abs(slide.level), LEAST_LIFT * slide.width)
    thrown = f"thrown off: it rose {lift:.3g} m, and slides flat up to {flat:.3g} m"
    return Response(
        outcome=Outcome.OVERTURNED if slide.overturned else slid,
        peak_ratio=math.inf if slide.overturned else 0.0,
        slips=tuple(seen[:, DISTANCE].tolist()),
        slip_times=tuple(map(tuple, seen[:, [SINCE, STOP]].tolist())),
        slip_m=float(max(abs(seen[:, DISTANCE]), default=0.0)),
        sink_m=float(slide.depth),
        message=thrown if lift > flat else "",
        history=history,
        observables={
            "lift_m": float(lift),
            "flat_m": float(flat),
            "turn_rad": float(slide.turn),
            "place_m": float(slide.place),
        },
    )
