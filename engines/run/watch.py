"""Poses in, events out: the same eyes for every engine.

Nothing here knows how a block rocks. What lies between two steps is interpolated.
"""

import math
from typing import Annotated, NamedTuple

from engines.parts.compiled import State, fill, shared
from engines.scene import Body, Scene
from engines.world import FloatArray, Moment, Pose, Resolution

RESOLVED_ROWS = 3
"""An impact counts when the swing that it ends was seen aloft at the ends of this many steps."""

EDGE_ROWS = 3
"""Ends of steps from which the velocity at either end of a swing is read."""

EDGE = EDGE_ROWS + 1
"""Rows kept of either end of a swing."""

SHORTENED = 0.7
"""A step shorter than this part of the one before is one of an approach, which halves what is left;
even steps up to the next corner of the motion differ by less."""

TIME, RATE_S, THETA, RATE = range(4)
"""Columns of rows: the end of a step [s], the moment of its velocity [s], rotation, velocity."""


class Row(NamedTuple):
    """The end of a step: time [s], rotation [rad], and the angular velocity [rad/s].

    The velocity belongs to the time `rate_s` [s], in the middle of the step or at its end, as the
    engine integrates.
    """

    time: float
    rate_s: float
    theta: float
    rate: float


class Swing(State):
    """The rows during which the block is aloft on one side.

    Attributes
    ----------
    side : float
        -1 or 1; 0 where there is no swing.
    from_rest : bool
        Whether it began with an uplift.
    rows : int
        Rows until now.
    first, last : array
        Rows at both ends, without the shorter steps of an approach at the last.
    kept : int
        How many there are in `last`.
    end, end_theta, dt : float
        Time [s] and rotation [rad] at the last row of all, and the length [s] of its step.
    """

    side: float
    from_rest: bool
    rows: int
    first: Annotated[FloatArray, (EDGE, len(Row._fields))]
    last: Annotated[FloatArray, (EDGE, len(Row._fields))]
    kept: int
    end: float
    end_theta: float
    dt: float


@shared
def begin_swing(swing: Swing, side: float, from_rest: bool) -> None:
    """Forget the last swing for another one, or for none.

    Parameters
    ----------
    swing : Swing, updated
    side : float, -1 or 1, or 0 for none
    from_rest : bool, whether an uplift begins it
    """
    swing.side, swing.from_rest = side, from_rest
    swing.rows = swing.kept = 0
    swing.dt = 0.0


@shared
def begun(swing: Swing) -> bool:
    """Return whether the last row is the one that completes what is known of the beginning."""
    return swing.rows == EDGE


@shared
def resolved(swing: Swing) -> bool:
    """Return whether enough rows were seen to speak of an impact at the end."""
    return swing.rows >= RESOLVED_ROWS


@shared
def put(rows: FloatArray, number: int, row: Row) -> None:
    """Write a row.

    Parameters
    ----------
    rows : ndarray (k, 4), columns `TIME` [s], `RATE_S` [s], `THETA` [rad] and `RATE` [rad/s]
    number : int, of the row that is written
    row : Row
    """
    rows[number, TIME], rows[number, RATE_S] = row.time, row.rate_s
    rows[number, THETA], rows[number, RATE] = row.theta, row.rate


@shared
def row_of(rows: FloatArray, number: int) -> Row:
    """Read a row.

    Parameters
    ----------
    rows, number
        As for `put`.
    """
    return Row(rows[number, TIME], rows[number, RATE_S], rows[number, THETA], rows[number, RATE])


@shared
def copy(rows: FloatArray, source: int, to: int) -> None:
    """Write a row again in another place; a slice would compile for much longer.

    Parameters
    ----------
    rows : ndarray (k, n), written
    source, to : int, numbers of the row that is read, and of the one that is written
    """
    for column in range(rows.shape[1]):
        rows[to, column] = rows[source, column]


@shared
def add(swing: Swing, row: Row, dt_s: float) -> None:
    """Take in the next row.

    Parameters
    ----------
    swing : Swing, updated
    row : Row, at the end of a step
    dt_s : float, length of the step [s]
    """
    if swing.rows < EDGE:
        put(swing.first, swing.rows, row)
    swing.rows += 1
    if dt_s > SHORTENED * swing.dt:
        if swing.kept == EDGE:
            swing.kept -= 1
            for i in range(swing.kept):
                copy(swing.last, i + 1, i)
        put(swing.last, swing.kept, row)
        swing.kept += 1
    swing.end, swing.end_theta, swing.dt = row.time, row.theta, dt_s


@shared
def landing(swing: Swing) -> tuple[float, float]:
    """Return the time [s] at which the swing meets theta = 0, and the velocity [rad/s] then."""
    # in the shorter steps before an impact, and in the one that leads to them, the contact's
    # force may come later than the other forces
    count = max(swing.kept - 1, 1)
    rate = extrapolated(swing.last, 0, count, swing.end)
    if rate * swing.side >= 0.0:
        return swing.end, rate
    time = swing.end - swing.end_theta / rate
    return time, extrapolated(swing.last, 0, count, time)


@shared
def lift_off(swing: Swing, earliest: float) -> float:
    """Return the time [s] at which the swing left the rest.

    The base's acceleration passes the onset steadily, so that theta'' grows in proportion to time
    (EQUATIONS.md, "From (1) and (2)") and so does the square root of the angular velocity.

    Parameters
    ----------
    swing : Swing, of which the first rows are used
    earliest : float, it left no earlier [s]
    """
    a, b = row_of(swing.first, 1), row_of(swing.first, 2)
    root = math.sqrt(max(b.rate / a.rate, 0.0)) if a.rate != 0.0 else 0.0
    if root <= 1.0:
        return earliest
    return max((root * a.rate_s - b.rate_s) / (root - 1.0), earliest)


@shared
def launch(swing: Swing, time: float) -> float:
    """Return the velocity [rad/s] with which the swing left theta = 0.

    Parameters
    ----------
    swing : Swing, of which the first rows are used
    time : float, when it did [s]
    """
    rows = min(swing.rows, EDGE)
    # the step to the first row may contain the impact
    return extrapolated(swing.first, min(1, rows - 1), rows, time)


@shared
def extrapolated(rows: FloatArray, first: int, stop: int, time: float) -> float:
    """Return the angular velocity [rad/s] at a time by the polynomial through some rows.

    Parameters
    ----------
    rows : ndarray (k, 4), a `Row` each
    first, stop : int, numbers of the first row and of the one after the last
    time : float, [s]
    """
    total = 0.0
    for i in range(first, stop):
        weight = 1.0
        for j in range(first, stop):
            if j != i:
                weight *= (time - rows[j, RATE_S]) / (rows[i, RATE_S] - rows[j, RATE_S])
        total += weight * rows[i, RATE]
    return total


LIFT_WIDTHS = 1e-8
"""Part of the width. A block has lifted when its free corner is higher above the base than this, or
than the length that the engine's numbers tell apart, and what `LIFT_FALL` adds. It is above the
noise of a tuned contact at rest and below the smallest lift of interest."""

LIFT_FALL = 1e-3
"""Part of g dt^2, twice the way fallen in one step, which no engine resolves. With it are added the
depth to which the contact was seen to give way under the resting block, and twice the height to
which the pivot of the last swing hopped, by the curvature of its steps."""

FALL_PART = 0.5
"""Part of the squared rate that its weight gives a block on the way to upright. One that rocks
falls back with more than this; one that leans in a soft contact comes back as its load does."""

FALL_STEPS = 2.0
"""Least number of steps of a fall: a shorter one is not told from a tremor of the contact."""

HOVER_WIDTHS = 1e-3
"""A contact that holds a block at rest higher above the base than this part of the width, and by
more than it leans, has a skin: such a block has not lifted."""

REST_TIME = 0.05
"""A block at rest has not lifted for this time, in units of 1/p."""

REST_RATE = 0.01
"""A block at rest turns no faster than this, in units of p alpha."""

SLIDE_WIDTHS = 0.1
"""A pivot that slides further than this part of the width has left the problem."""

HOLD_WIDTHS = 0.01
"""A pivot that slides further than this part of the width does not hold, as steps that land on
impacts assume: with a friction that a scene asks for such a run fails, and all others say so. Where
it holds it slides by 1.1e-4 at most in the paper's cases."""

PROPPED_PART = 0.5
"""Part of alpha. A block that leans by less, and is neither held nor shaken, turns faster within
`REST_TIME` than one at rest may."""

THROWN_WIDTHS = 1.0
"""A pivot higher above the base than this part of the width has been thrown off."""

LYING = 0.5 * math.pi
"""Rotation [rad] at which the block lies on its side."""

LYING_PART = 0.9
"""A block that stays where it is, turned by more than this part of that, lies on a soft contact."""


NO_PROBLEM, DIVERGED, SANK, THROWN, SLID, SLIPPED, BEAM_SLIPPED = range(7)
"""Why the response is no longer that of a rocking block; see `answer.problem_of`."""

UPLIFT, IMPACT, REST = 0.0, 1.0, 2.0
"""Kinds of events."""

KIND, WHEN, BEFORE, AFTER = range(4)
"""Columns of events: the kind, the time [s], and velocities [rad/s] before and after an impact."""

EVENTS_A_LOOK = 3
"""Events that a look adds at most: the impact before, an uplift, and the impact between."""


class Watch(State):
    """What was seen of a block until now.

    Attributes
    ----------
    ahead : float
        Part of a step that its velocity is ahead of its end.
    home : float
        Where the block's centre is at rest [m].
    half_width, half_height, alpha : float
        Of the block [m, m, rad].
    lift, rest_time, rest_rate : float
        Height of the free corner above which the block is aloft [m]; time without that after which
        it is at rest [s]; and the rate up to which it may turn then [rad/s].
    fall, least_fall : float
        Rate squared over the rotation [rad/s2] with which a block falls back, and the least
        rotation [rad] from which a fall is seen as one.
    motion_end, end : float
        End of the motion, and of the observation [s].
    slides, lands : bool
        Whether the block is meant to slide, and whether steps land on impacts of a pivot that has
        to hold.
    keeps_rows : bool
        Whether a history is wanted.
    rows, events : int
        How many there are.
    lifted : bool
        Whether the block is aloft at the last row.
    resting, rocked, crossed, overturned, turned : bool
        Whether it is at rest, has left it at some time, has exceeded alpha, has overturned, and has
        turned back after the motion.
    peak : float
        Largest rotation [rad].
    slide, sink, sunk, highest : float
        Of the pivot [m]; sunk is how deep it was before the block lay.
    beam_slide : float
        How far the beam of a frame slid along the columns' tops [m].
    give, hop : float
        How deep the block at rest was in its base, and how high its last swing's pivot hopped [m].
    low_since : float
        Since when it has not been aloft [s]; nan while it is.
    last_rest, turned_at : float
        When it last came to rest, and when it last turned faster than a block at rest may [s].
    lean_side, lean_peak, lean_since : float
        Of the block at rest: to which side it leans, how far it did [rad], and since when [s].
    hovers, loose, props : bool
        Whether a skin of the contact holds it above its base, whether it was seen to rock although
        no corner's height shows it, and whether its contact holds it leaning.
    uplift : int
        Which event is the last uplift.
    landed : bool
        Whether a swing ended and the next has not begun, its end at landed_s [s] with the
        velocity landed_rate [rad/s].
    swing : Swing
        The present swing.
    two : array
        The last two rows.
    done : bool
        Whether the response is decided.
    problem : int
        Why it is no longer that of a rocking block, and by how much [m]: far.
    """

    ahead: float
    home: float
    half_width: float
    half_height: float
    alpha: float
    lift: float
    rest_time: float
    rest_rate: float
    fall: float
    least_fall: float
    motion_end: float
    end: float
    slides: bool
    lands: bool
    keeps_rows: bool
    rows: int
    events: int
    lifted: bool
    resting: bool
    rocked: bool
    crossed: bool
    overturned: bool
    turned: bool
    peak: float
    slide: float
    sink: float
    sunk: float
    highest: float
    beam_slide: float
    give: float
    hop: float
    low_since: float
    last_rest: float
    turned_at: float
    lean_side: float
    lean_peak: float
    lean_since: float
    hovers: bool
    loose: bool
    props: bool
    uplift: int
    landed: bool
    landed_s: float
    landed_rate: float
    swing: Swing
    two: Annotated[FloatArray, (2, len(Row._fields))]
    done: bool
    problem: int
    far: float


def begin_watch(
    watch: Watch,
    scene: Scene,
    body: Body,
    dt_s: float,
    lands: bool,
    moment: Moment,
    resolution: Resolution,
) -> None:
    """Begin at rest, or in a swing that no uplift began.

    Parameters
    ----------
    watch : Watch
        What is filled.
    scene : Scene
        What is being simulated.
    body : Body
        Which of its bodies is watched: one that rocks.
    dt_s : float
        Ordinary step [s], which bounds what can be resolved.
    lands : bool
        Whether the steps land on impacts of a pivot that has to hold.
    moment : Moment
        At which moment of a step the engine's velocity holds.
    resolution : Resolution
        What the engine's numbers tell apart.
    """
    block, (theta, rate) = scene.system, scene.start
    lift = max(LIFT_WIDTHS * block.width, resolution.length_m)
    lift += LIFT_FALL * block.gravity * dt_s**2
    aloft, peak = bool(scene.side), abs(theta)
    weight = block.p**2 * math.sin(block.alpha)
    fill(
        watch,
        ahead=1.0 - moment.value,
        home=body.home[0],
        half_width=0.5 * block.width,
        half_height=0.5 * block.height,
        alpha=block.alpha,
        lift=lift,
        rest_time=REST_TIME / block.p,
        rest_rate=REST_RATE * block.p * block.alpha,
        fall=2.0 * FALL_PART * weight,
        least_fall=0.5 * weight * (FALL_STEPS * dt_s) ** 2,
        motion_end=scene.motion.duration,
        end=math.inf if scene.duration is None else scene.duration,
        slides=scene.friction == 0.0,
        lands=lands,
        keeps_rows=scene.times is not None,
        resting=not aloft,
        rocked=aloft,
        low_since=math.nan if aloft else 0.0,
        turned_at=-math.inf,
        peak=peak,
        crossed=peak > block.alpha,
        lifted=block.width * math.sin(peak) > lift,
    )
    watch.swing.side = scene.side
    watch.two[1] = Row(0.0, 0.0, theta, rate)


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
