"""Poses in, response out: the same eyes for every engine.

Nothing here knows how a block rocks. What lies between two steps is interpolated.
"""

import math

from engines.parts.compiled import FloatArray, shared
from engines.watching.swing import (
    TIME,
    Row,
    add,
    begin_swing,
    begun,
    copy,
    extrapolated,
    landing,
    launch,
    lift_off,
    put,
    resolved,
    row_of,
)
from engines.watching.watch import (
    AFTER,
    BEAM_SLIPPED,
    BEFORE,
    DIVERGED,
    HOLD_WIDTHS,
    HOVER_WIDTHS,
    IMPACT,
    KIND,
    LYING,
    LYING_PART,
    PROPPED_PART,
    REST,
    SANK,
    SLID,
    SLIDE_WIDTHS,
    SLIPPED,
    THROWN,
    THROWN_WIDTHS,
    UPLIFT,
    WHEN,
    Watch,
)
from engines.world import Pose


@shared
def see(
    watch: Watch, rows: FloatArray, events: FloatArray, time: float, dt_s: float, pose: Pose
) -> None:
    """Take in a pose at the end of a step.

    Parameters
    ----------
    watch : Watch, updated
    rows : ndarray (k, 4), where a history is kept, columns as in `swing`
    events : ndarray (k, 4), where events are written, columns as in `watch`
    time, dt_s : float, end and length of the step [s]
    pose : Pose
    """
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
        begin_swing(watch.swing, 0.0, False)
    if watch.lifted:
        watch.hop = max(watch.hop, level - reach)
    if abs(theta) <= watch.alpha:
        inward = math.copysign(watch.half_width * (1.0 - cosine), theta)
        shifted = pose.x - watch.home - watch.half_height * sine - inward
        watch.slide = max(watch.slide, abs(shifted))
    check(watch, level - reach, pose.z)
    if abs(theta) <= LYING_PART * LYING:
        watch.sunk = max(watch.sunk, reach - level)
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


@shared
def props(watch: Watch, row: Row) -> bool:
    """Say whether the contact holds a block that leans, and no longer rocks, where it is."""
    swing, since = watch.swing, max(watch.turned_at, watch.motion_end)
    if swing.side != 0.0 and not watch.props:
        since = max(since, swing.first[0, TIME]) if swing.side * row.theta > 0.0 else math.inf
    elif not watch.props:
        return False
    return row.time - since >= watch.rest_time and abs(row.theta) < PROPPED_PART * watch.alpha


@shared
def lean(watch: Watch, row: Row) -> None:
    """See whether a block at rest turns and falls back, however deep in its base or high above."""
    size, side = abs(row.theta), math.copysign(1.0, row.theta)
    if side != watch.lean_side or 2.0 * watch.half_width * size < watch.lift:
        watch.lean_side, watch.lean_peak, watch.lean_since = side, 0.0, row.time
    watch.lean_peak = max(watch.lean_peak, size)
    inward = max(-row.rate * side, 0.0)
    falls = watch.lean_peak > watch.least_fall and inward * inward > watch.fall * watch.lean_peak
    watch.loose = watch.loose or falls or (watch.hovers and abs(row.rate) > watch.rest_rate)


@shared
def check(watch: Watch, low: float, centre: float) -> None:
    """Look at the heights [m] of the lowest corner and the centre, and at the slide."""
    width = 2.0 * watch.half_width
    watch.sink, watch.highest = max(watch.sink, -low), max(watch.highest, low)
    if centre < 0.0:
        watch.problem, watch.far = SANK, -low
    elif low > THROWN_WIDTHS * width:
        watch.problem, watch.far = THROWN, low
    elif watch.slides:
        return
    elif watch.lands and watch.slide > HOLD_WIDTHS * width:
        watch.problem, watch.far = SLIPPED, watch.slide
    elif watch.lands and watch.beam_slide > HOLD_WIDTHS * width:
        watch.problem, watch.far = BEAM_SLIPPED, watch.beam_slide
    elif watch.slide > SLIDE_WIDTHS * width:
        watch.problem, watch.far = SLID, watch.slide


@shared
def aloft(watch: Watch, events: FloatArray, row: Row, dt_s: float) -> None:
    """Take in a row at which the block is aloft."""
    swing, side = watch.swing, math.copysign(1.0, row.theta)
    if swing.side != side:
        land(watch, events)
        begin_swing(swing, side, watch.resting and not watch.loose)
        watch.hop = 0.0
        if watch.resting:
            watch.uplift = watch.events
            since = watch.lean_since if watch.loose else watch.two[1, TIME]
            note(watch, events, UPLIFT, since, 0.0, 0.0)
            watch.resting, watch.rocked = False, True
    add(swing, row, dt_s)
    if begun(swing):
        complete(watch, events)
        if swing.from_rest:
            events[watch.uplift, WHEN] = lift_off(swing, watch.last_rest)
    watch.low_since = math.nan


@shared
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


@shared
def land(watch: Watch, events: FloatArray) -> None:
    """End the present swing, if there is one, with an impact."""
    swing = watch.swing
    if swing.side != 0.0:
        complete(watch, events)
        if resolved(swing):
            watch.landed = True
            watch.landed_s, watch.landed_rate = landing(swing)
        begin_swing(swing, 0.0, False)


@shared
def complete(watch: Watch, events: FloatArray) -> None:
    """Complete the last impact with the velocity after it, zero if no swing followed.

    Parameters
    ----------
    watch : Watch, updated
    events : ndarray (k, 4), columns as in `watch`
    """
    if watch.landed:
        time, swing = watch.landed_s, watch.swing
        after = launch(swing, time) if swing.side != 0.0 else 0.0
        note(watch, events, IMPACT, time, watch.landed_rate, after)
        watch.landed = False


@shared
def note(
    watch: Watch, events: FloatArray, kind: float, time: float, before: float, after: float
) -> None:
    """Write an event down."""
    number = watch.events
    events[number, KIND], events[number, WHEN] = kind, time
    events[number, BEFORE], events[number, AFTER] = before, after
    watch.events += 1


@shared
def turning(watch: Watch) -> None:
    """Note the largest rotation near the last row but one."""
    b, c = row_of(watch.two, 0), row_of(watch.two, 1)
    side = math.copysign(1.0, b.theta)
    peak = abs(c.theta)
    if b.rate * side > 0.0 >= c.rate * side:
        bend = (b.rate - c.rate) / (c.rate_s - b.rate_s) * side
        rate = extrapolated(watch.two, 0, 2, b.time)
        peak = max(peak, abs(b.theta) + 0.5 * rate * rate / bend)
        watch.turned = b.time >= watch.motion_end and watch.lifted
    if peak > watch.peak:
        watch.peak = peak
        watch.crossed = peak > watch.alpha


@shared
def decide(watch: Watch, row: Row) -> None:
    """Say whether the response is decided.

    After the motion a block overturns that moves outward beyond alpha, where its weight no longer
    brings it back (EQUATIONS.md, "From (1) and (2)").
    """
    size, outward = abs(row.theta), row.theta * row.rate > 0.0
    over = row.time >= watch.motion_end
    still = row.time - watch.turned_at >= watch.rest_time
    lies = size >= LYING or (still and size > LYING_PART * LYING)
    watch.overturned = lies or (over and size > watch.alpha and outward)
    settled = over and watch.end == math.inf and (watch.turned or (watch.resting and still))
    watch.done = watch.overturned or settled or row.time >= watch.end
