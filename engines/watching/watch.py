"""What is remembered of a block that is watched, and from when on what counts.

Rotation, lift and slide are read from the poses at the ends of the steps.
"""

import math
from typing import Annotated

from engines.layouts import Body
from engines.parts.compiled import FloatArray, State, fill
from engines.scene import Scene
from engines.watching.swing import (
    Row,
    Swing,
)
from engines.world import Moment, Resolution

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
