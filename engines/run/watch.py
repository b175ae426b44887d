"""Poses in, events out: the same eyes for every engine.

Nothing here knows how a block rocks. A block is aloft while its free corner is higher than the
contact gives way. What it does between two steps is interpolated; the times and velocities of
impacts are extrapolated from the steps before and after, for no step need end on one.
"""

import math
from dataclasses import dataclass, field

import numpy as np

from engines.run.rows import TIME, Row, copy, extrapolated, put, row_of
from engines.scene import FREE_ROCKING, Body, Scene
from engines.world import FloatArray, Moment, Pose, Resolution

RESOLVED_ROWS = 3
"""An impact counts when the swing that it ends was seen aloft at the ends of this many steps."""

EDGE = 4
"""Rows kept of either end of a swing: from the velocities of three that at the end is read."""

SHORTENED = 0.7
"""A step shorter than this part of the one before is one of an approach, which halves what is left;
even steps up to the next corner of the motion differ by less."""

LIFT_WIDTHS, LIFT_FALL = 1e-8, 1e-3
"""A block has lifted when its free corner is higher than this part of the width, or than the
engine's resolution, and this part of g dt^2, twice the way fallen in one step; and than the contact
was seen to give way at rest, and twice what the pivot hopped in the last swing, by the curvature of
its steps. It is above the noise of a tuned contact and below the smallest lift of interest."""

FALL_PART, FALL_STEPS = 0.5, 2.0
"""A block that leans comes back as its load does; one that rocks falls back with more than this
part of the squared rate that its weight gives it, in more than so many steps: no tremor does."""

HOVER_WIDTHS = 1e-3
"""A contact that holds a block at rest higher above the base than this part of the width, and by
more than it leans, has a skin: such a block has not lifted."""

REST_TIME, REST_RATE = 0.05, 0.01
"""A block at rest has not lifted for this time [1/p], nor turned faster than this [p alpha]."""

SLIDE_WIDTHS, THROWN_WIDTHS = 0.1, 1.0
"""A pivot that slides further than this part of the width has left the problem, and one higher
above the base than this has been thrown off it."""

HOLD_WIDTHS = 0.01
"""A pivot that slides further than this part of the width does not hold, as steps that land
assume. Where it holds it slides by 1.1e-4 at most in the paper's cases."""

SINK_WIDTHS = 0.05
"""Of a corner deeper in the base than this part of the width a reader should know."""

PARTED_PART = 0.1
"""Columns of a frame whose rotations differ by more than this part of alpha have parted: below the
beam their tops slide by as much of the width as a pivot may."""

PROPPED_PART = 0.5
"""Part of alpha. A block that leans by less, and is neither held nor shaken, turns faster within
`REST_TIME` than one at rest may."""

LYING, LYING_PART = 0.5 * math.pi, 0.9
"""Rotation [rad] at which the block lies on its side, and the part of it from which one that stays
where it is lies on a soft contact."""

NO_PROBLEM, DIVERGED, SANK, THROWN, SLID, SLIPPED, BEAM_SLIPPED = range(7)
BEAM_LOST, BEAM_THROWN, PARTED = range(7, 10)
"""Why the response is no longer that of a rocking block."""

UPLIFT, IMPACT, REST = 0.0, 1.0, 2.0
"""Kinds of events."""

KIND, WHEN, BEFORE, AFTER = range(4)
"""Columns of events: the kind, the time [s], and velocities [rad/s] before and after an impact."""

EVENTS_A_LOOK = 3
"""Events that a look adds at most: the impact before, an uplift, and the impact between."""


@dataclass(slots=True)
class Watch:
    """What was seen of a block until now."""

    ahead: float  # part of a step that its velocity is ahead of its end
    home: float  # where its centre is at rest [m]
    half_width: float
    half_height: float
    alpha: float  # to the right, as is `peak`, the largest rotation [rad]
    alpha_left: float
    lift: float  # height of the free corner above which it is aloft [m]
    rest_time: float  # time without that after which it is at rest [s]
    rest_rate: float  # rate up to which it may turn then [rad/s]
    fall: float  # rate squared over the rotation with which it falls back [rad/s2]
    least_fall: float  # least rotation from which a fall is seen as one [rad]
    motion_end: float
    watched: float  # end of the observation at the least [s]
    timed: bool  # it ends then, decided or not
    slides: bool  # it is meant to slide
    lands: bool  # steps land on impacts of a pivot that has to hold
    keeps_rows: bool  # a history is wanted
    resting: bool
    rocked: bool  # it has left its rest at some time
    lifted: bool  # it is aloft at the last row
    crossed: bool  # it has exceeded alpha
    peak: float
    peak_left: float
    low_since: float  # since when it has not been aloft [s], nan while it is
    side: float  # of the swing, 0 where there is none
    last_rest: float = 0.0  # when it last came to rest [s]
    turned_at: float = -math.inf  # when it last turned faster than a block at rest may [s]
    overturned: bool = False
    # it has turned back after the motion, from both sides where they are unlike
    turned: bool = False
    turned_side: float = 0.0  # from which at last
    done: bool = False  # the response is decided
    rows: int = 0
    events: int = 0
    uplift: int = 0  # which event is the last uplift
    slide: float = 0.0  # of the pivot [m], as are the next three
    sink: float = 0.0
    sunk: float = 0.0  # how deep it was before the block lay
    highest: float = 0.0
    beam_slide: float = 0.0  # how far the beam of a frame slid along the columns' tops [m]
    give: float = 0.0  # how deep it was in its base at rest [m]
    hop: float = 0.0  # how high its last swing's pivot hopped [m]
    lean_side: float = 0.0  # where it leans at rest
    lean_peak: float = 0.0  # how far it did [rad]
    lean_since: float = 0.0  # since when [s]
    hovers: bool = False  # a skin of the contact holds it above its base
    loose: bool = False  # it was seen to rock although no corner's height shows it
    props: bool = False  # its contact holds it leaning
    landed: bool = False  # a swing ended and the next has not begun
    landed_s: float = 0.0  # when [s], and how fast [rad/s]
    landed_rate: float = 0.0
    from_rest: bool = False  # an uplift began the swing
    count: int = 0  # rows of the swing until now
    kept: int = 0  # how many of them are in `last`
    # rows at both ends of the swing, the last ones without the shorter steps of an approach
    first: FloatArray = field(default_factory=lambda: np.zeros((EDGE, 4)))
    last: FloatArray = field(default_factory=lambda: np.zeros((EDGE, 4)))
    two: FloatArray = field(default_factory=lambda: np.zeros((2, 4)))  # the last two of all
    swing_end: float = 0.0  # time at the swing's last row [s]
    swing_theta: float = 0.0  # rotation there [rad]
    swing_dt: float = 0.0  # length of its step [s]
    problem: int = NO_PROBLEM  # why it is no longer that of a rocking block
    far: float = 0.0  # by how much [m]


def begin_watch(
    scene: Scene, body: Body, dt_s: float, lands: bool, moment: Moment, resolution: Resolution
) -> Watch:
    """Return what a body that rocks begins with: at rest, or in a swing that no uplift began."""
    block, (theta, rate) = scene.system, scene.start
    lift = max(LIFT_WIDTHS * block.width, resolution.length_m)
    lift += LIFT_FALL * block.gravity * dt_s**2
    aloft, (right, left) = bool(scene.side), scene.alphas
    weight = block.p**2 * math.sin(block.alpha)
    watch = Watch(
        ahead=1.0 - moment.value,
        home=body.home[0],
        half_width=0.5 * block.width,
        half_height=0.5 * block.height,
        alpha=right,
        alpha_left=left,
        lift=lift,
        rest_time=REST_TIME / block.p,
        rest_rate=REST_RATE * block.p * block.alpha,
        fall=2.0 * FALL_PART * weight * (scene.lightest / block.gravity),
        least_fall=0.5 * weight * (FALL_STEPS * dt_s) ** 2,
        motion_end=scene.motion.duration,
        watched=scene.watched,
        timed=scene.duration is not None,
        slides=scene.friction == 0.0,
        lands=lands,
        keeps_rows=scene.times is not None,
        resting=not aloft,
        rocked=aloft,
        lifted=block.width * math.sin(abs(theta)) > lift,
        crossed=abs(theta) > (right if theta > 0.0 else left),
        peak=max(0.0, theta),
        peak_left=max(0.0, -theta),
        low_since=math.nan if aloft else 0.0,
        side=scene.side,
    )
    watch.two[1] = 0.0, 0.0, theta, rate
    return watch


def see(
    watch: Watch, rows: FloatArray, events: FloatArray, time: float, dt_s: float, pose: Pose
) -> None:
    """Take in a pose at the end [s] of a step, of which rows and events (k, 4) are written."""
    theta = pose.theta
    if not math.isfinite(pose.x + pose.z + theta + pose.rate):
        watch.problem = DIVERGED
        return
    row = Row(time, time - watch.ahead * dt_s, theta, pose.rate)
    sine, cosine = math.sin(theta), math.cos(theta)
    reach = watch.half_width * abs(sine)
    level = pose.z - watch.half_height * cosine
    if watch.resting:
        watch.give = max(watch.give, reach - level)
        raised = level - reach > 2.0 * watch.half_width * HOVER_WIDTHS
        watch.hovers = watch.hovers or (raised and level > 3.0 * reach)
        lean(watch, row)
    if abs(row.rate) > watch.rest_rate:
        watch.turned_at = time
    if watch.loose:
        watch.lifted = 2.0 * reach > watch.lift
    else:
        higher = level + reach > watch.lift + watch.give + 2.0 * watch.hop
        watch.lifted = higher and not watch.hovers
    watch.props = watch.lifted and props(watch, row)
    if watch.props:
        watch.lifted = False
        begin_swing(watch, 0.0, False)
    if watch.lifted:
        watch.hop = max(watch.hop, level - reach)
    check(watch, pose, level - reach, sine, cosine)
    if watch.keeps_rows:
        put(rows, watch.rows, row)
        watch.rows += 1
    if watch.lifted:
        aloft(watch, events, row, dt_s)
    else:
        low(watch, events, row)
    copy(watch.two, 1, 0)
    put(watch.two, 1, row)
    turning(watch)
    decide(watch, row)


def alpha_of(watch: Watch, theta: float) -> float:
    """Return alpha [rad] of the side to which a rotation leans."""
    return watch.alpha if theta > 0.0 else watch.alpha_left


def props(watch: Watch, row: Row) -> bool:
    """Say whether the contact holds a block that leans, and no longer rocks, where it is."""
    since = max(watch.turned_at, watch.motion_end)
    if watch.side != 0.0 and not watch.props:
        since = max(since, watch.first[0, TIME]) if watch.side * row.theta > 0.0 else math.inf
    elif not watch.props:
        return False
    return row.time - since >= watch.rest_time and abs(row.theta) < PROPPED_PART * alpha_of(
        watch, row.theta
    )


def lean(watch: Watch, row: Row) -> None:
    """See whether a block at rest turns and falls back, however deep in its base or high above."""
    size, side = abs(row.theta), math.copysign(1.0, row.theta)
    if side != watch.lean_side or 2.0 * watch.half_width * size < watch.lift:
        watch.lean_side, watch.lean_peak, watch.lean_since = side, 0.0, row.time
    watch.lean_peak = max(watch.lean_peak, size)
    inward = max(-row.rate * side, 0.0)
    falls = watch.lean_peak > watch.least_fall and inward * inward > watch.fall * watch.lean_peak
    watch.loose = watch.loose or falls or (watch.hovers and abs(row.rate) > watch.rest_rate)


def check(watch: Watch, pose: Pose, low: float, sine: float, cosine: float) -> None:
    """Look at the heights of the lowest corner, `low` [m], and of the centre, and at the slide."""
    width = 2.0 * watch.half_width
    if abs(pose.theta) <= alpha_of(watch, pose.theta):
        inward = math.copysign(watch.half_width * (1.0 - cosine), pose.theta)
        shifted = pose.x - watch.home - watch.half_height * sine - inward
        watch.slide = max(watch.slide, abs(shifted))
    if abs(pose.theta) <= LYING_PART * LYING:
        watch.sunk = max(watch.sunk, -low)
    watch.sink, watch.highest = max(watch.sink, -low), max(watch.highest, low)
    if pose.z < 0.0:
        watch.problem, watch.far = SANK, -low
    elif low > THROWN_WIDTHS * width:
        watch.problem, watch.far = THROWN, low
    else:
        check_slide(watch, watch.slide, SLIPPED, SLID)


def check_slide(watch: Watch, slide: float, slipped: int, lost: int) -> None:
    """See whether what has to hold slid too far [m]."""
    width = 2.0 * watch.half_width
    if watch.slides:
        return
    if watch.lands and slide > HOLD_WIDTHS * width:
        watch.problem, watch.far = slipped, slide
    elif slide > SLIDE_WIDTHS * width:
        watch.problem, watch.far = lost, slide


def aloft(watch: Watch, events: FloatArray, row: Row, dt_s: float) -> None:
    """Take in a row at which the block is aloft."""
    side = math.copysign(1.0, row.theta)
    if watch.side != side:
        land(watch, events)
        begin_swing(watch, side, watch.resting and not watch.loose)
        watch.hop = 0.0
        if watch.resting:
            watch.uplift = watch.events
            since = watch.lean_since if watch.loose else watch.two[1, TIME]
            note(watch, events, UPLIFT, since, 0.0, 0.0)
            watch.resting, watch.rocked = False, True
    add(watch, row, dt_s)
    if watch.count == EDGE:  # all is known of the swing's beginning
        complete(watch, events)
        if watch.from_rest:
            events[watch.uplift, WHEN] = lift_off(watch)
    watch.low_since = math.nan


def low(watch: Watch, events: FloatArray, row: Row) -> None:
    """Take in a row at which the block is not aloft."""
    land(watch, events)
    if math.isnan(watch.low_since):
        watch.low_since = row.time
    if watch.resting or abs(row.rate) > watch.rest_rate:
        return
    if row.time - watch.low_since >= watch.rest_time:
        watch.resting, watch.last_rest = True, watch.low_since
        note(watch, events, REST, watch.low_since, 0.0, 0.0)
        complete(watch, events)


def land(watch: Watch, events: FloatArray) -> None:
    """End the present swing, if there is one, with an impact."""
    if watch.side != 0.0:
        complete(watch, events)
        if watch.count >= RESOLVED_ROWS:
            watch.landed = True
            watch.landed_s, watch.landed_rate = landing(watch)
        begin_swing(watch, 0.0, False)


def complete(watch: Watch, events: FloatArray) -> None:
    """Complete the last impact with the velocity after it, zero if no swing followed."""
    if watch.landed:
        after = 0.0
        if watch.side != 0.0:
            rows = min(watch.count, EDGE)
            # the step to the first row may contain the impact
            after = extrapolated(watch.first, min(1, rows - 1), rows, watch.landed_s)
        note(watch, events, IMPACT, watch.landed_s, watch.landed_rate, after)
        watch.landed = False


def note(
    watch: Watch, events: FloatArray, kind: float, time: float, before: float, after: float
) -> None:
    """Write an event down."""
    put(events, watch.events, (kind, time, before, after))
    watch.events += 1


def turning(watch: Watch) -> None:
    """Note the largest rotation near the last row but one."""
    b, c = row_of(watch.two, 0), row_of(watch.two, 1)
    side = math.copysign(1.0, b.theta)
    top(watch, c.theta)
    if b.rate * side > 0.0 >= c.rate * side:
        bend = (b.rate - c.rate) / (c.rate_s - b.rate_s) * side
        rate = extrapolated(watch.two, 0, 2, b.time)
        top(watch, side * (abs(b.theta) + 0.5 * rate * rate / bend))
        if b.time >= watch.motion_end and watch.lifted:
            other = watch.turned_side == -side
            watch.turned = watch.turned or other or watch.alpha == watch.alpha_left
            watch.turned_side = side


def top(watch: Watch, theta: float) -> None:
    """Note a rotation [rad] where it is the largest one to its side."""
    if theta > 0.0:
        watch.peak = max(watch.peak, theta)
    else:
        watch.peak_left = max(watch.peak_left, -theta)
    watch.crossed = watch.crossed or abs(theta) > alpha_of(watch, theta)


def decide(watch: Watch, row: Row) -> None:
    """Say whether it is decided; after the motion what moves outward beyond alpha overturns."""
    size, outward = abs(row.theta), row.theta * row.rate > 0.0
    over = row.time >= watch.motion_end
    still = row.time - watch.turned_at >= watch.rest_time
    lies = size >= LYING or (still and size > LYING_PART * LYING)
    watch.overturned = lies or (over and size > alpha_of(watch, row.theta) and outward)
    before = row.time - watch.rest_time * FREE_ROCKING / REST_TIME
    trembles = before >= watch.motion_end and before >= watch.low_since  # which is nan aloft
    decided = watch.timed or watch.turned or trembles or (watch.resting and still)
    watch.done = watch.overturned or (decided and row.time >= watch.watched)


def begin_swing(watch: Watch, side: float, from_rest: bool) -> None:
    """Forget the last swing for another one at a side, or for none, 0."""
    watch.side, watch.from_rest = side, from_rest
    watch.count = watch.kept = 0
    watch.swing_dt = 0.0


def add(watch: Watch, row: Row, dt_s: float) -> None:
    """Take in the next row of a swing, at the end of a step [s]."""
    if watch.count < EDGE:
        put(watch.first, watch.count, row)
    watch.count += 1
    if dt_s > SHORTENED * watch.swing_dt:
        if watch.kept == EDGE:
            watch.kept -= 1
            for i in range(watch.kept):
                copy(watch.last, i + 1, i)
        put(watch.last, watch.kept, row)
        watch.kept += 1
    watch.swing_end, watch.swing_theta, watch.swing_dt = row.time, row.theta, dt_s


def landing(watch: Watch) -> tuple[float, float]:
    """Return the time [s] at which the swing meets theta = 0, and the velocity [rad/s] then."""
    # in the shorter steps before an impact, and in the one that leads to them, the contact's
    # force may come later than the other forces
    count = max(watch.kept - 1, 1)
    rate = extrapolated(watch.last, 0, count, watch.swing_end)
    if rate * watch.side >= 0.0:
        return watch.swing_end, rate
    time = watch.swing_end - watch.swing_theta / rate
    return time, extrapolated(watch.last, 0, count, time)


def lift_off(watch: Watch) -> float:
    """Return when [s] the swing left the rest: from there theta'' grows in proportion to time."""
    a, b = row_of(watch.first, 1), row_of(watch.first, 2)
    root = math.sqrt(max(b.rate / a.rate, 0.0)) if a.rate != 0.0 else 0.0
    if root <= 1.0:
        return watch.last_rest
    return max((root * a.rate_s - b.rate_s) / (root - 1.0), watch.last_rest)
