"""Poses in, response out: the same eyes for every engine.

Nothing here knows how a block rocks. Rotation, lift and slide are read from the poses at the ends
of the steps; what lies between two steps is interpolated.
"""

import math

from analytic.response import Impact, Outcome, Problem, Reason, Response
from engines.scene import Scene
from engines.watching.history import sample
from engines.watching.swing import Row, Swing, extrapolated
from engines.world import UNLIMITED, Moment, Pose, Resolution

LIFT_WIDTHS = 1e-8
"""A block has lifted when its free corner is higher above the base than this part of its width,
above the noise of a tuned contact at rest and below the smallest lift of interest, or than the
length that the engine's numbers tell apart, ..."""

LIFT_FALL = 1e-3
"""... plus this part of g dt^2, twice the way fallen in one step, which no engine resolves,
plus the depth to which the contact was seen to give way under the resting block, and twice
the height to which the pivot of the last swing hopped, by the curvature of its steps."""

REST_TIME = 0.05
"""A block that has not lifted for this time, in units of 1/p, ..."""

REST_RATE = 0.01
"""... and turns no faster than this, in units of p alpha, is at rest."""

SLIDE_WIDTHS = 0.1
"""A pivot that slides further than this part of the width has left the problem."""

SINK_WIDTHS = 0.05
"""A pivot deeper in the base than this part of the width has fallen through it, ..."""

THROWN_WIDTHS = 1.0
"""... and one higher above the base than this has been thrown off."""


class Observer:
    """Watches a block step by step and says what its response was.

    Parameters
    ----------
    scene : Scene
        What is being simulated.
    dt_s : float
        Ordinary step [s], which bounds what can be resolved.
    moment : Moment, optional
        At which moment of a step the engine's velocity holds.
    resolution : Resolution, optional
        What the engine's numbers tell apart.

    Attributes
    ----------
    lifted : bool
        Whether the block is aloft at the last row.
    done : bool
        Whether the response is decided.
    broken : Problem or None
        Why the response is no longer that of a rocking block.
    """

    def __init__(
        self,
        scene: Scene,
        dt_s: float,
        moment: Moment = Moment.MIDDLE,
        resolution: Resolution = UNLIMITED,
    ) -> None:
        block, motion = scene.block, scene.motion
        self._scene = scene
        self._ahead = 1.0 - moment.value
        self._half_width, self._half_height = 0.5 * block.width, 0.5 * block.height
        self._alpha = block.alpha
        self._lift = max(LIFT_WIDTHS * block.width, resolution.length_m)
        self._lift += LIFT_FALL * block.gravity * dt_s**2
        self._rest_time, self._rest_rate = REST_TIME / block.p, REST_RATE * block.p * block.alpha
        self._motion_end = motion.duration
        self._end = math.inf if scene.duration is None else scene.duration
        start = Row(0.0, 0.0, *scene.start)
        self._rows: list[Row] | None = None if scene.times is None else [start]
        self._before, self._now = start, start
        self._landed: tuple[float, float] | None = None
        self._uplifts: list[float] = []
        self._rests: list[float] = []
        self._impacts: list[Impact] = []
        self._slide = self._sink = self._give = self._hop = self._highest = 0.0
        self._overturned = self._turned = False
        self._begin(scene)
        self.done = False
        self.broken: Problem | None = None

    def _begin(self, scene: Scene) -> None:
        """Begin at rest, or in a swing that no uplift began."""
        theta, _ = scene.start
        self._resting = not scene.side
        self._rocked = not self._resting
        self._swing = None if self._resting else Swing(scene.side, from_rest=False)
        self._low_since: float = 0.0 if self._resting else math.nan
        self._peak = abs(theta)
        self._crossed = self._peak > self._alpha
        self.lifted = 2.0 * self._half_width * math.sin(self._peak) > self._lift

    def see(self, time: float, dt_s: float, pose: Pose) -> None:
        """Take in the pose at `time` [s], at the end of a step of `dt_s` [s]."""
        x, z, theta, rate = pose
        if not math.isfinite(x + z + theta + rate):
            self.broken = Problem(Reason.DIVERGED, "the engine's state is not finite")
            return
        row = Row(time, time - self._ahead * dt_s, theta, rate)
        sine, cosine = math.sin(theta), math.cos(theta)
        reach = self._half_width * abs(sine)
        level = z - self._half_height * cosine
        if self._resting:
            self._give = max(self._give, reach - level)
        self.lifted = level + reach > self._lift + self._give + 2.0 * self._hop
        if self.lifted:
            self._hop = max(self._hop, level - reach)
        if abs(theta) <= self._alpha:
            inward = math.copysign(self._half_width * (1.0 - cosine), theta)
            self._slide = max(self._slide, abs(x - self._half_height * sine - inward))
        self._check(level - reach)
        if self._rows is not None:
            self._rows.append(row)
        if self.lifted:
            self._aloft(row, dt_s)
        else:
            self._low(row)
        self._turning(self._before, self._now, row)
        self._before, self._now = self._now, row
        self._decide(row)

    def _check(self, depth: float) -> None:
        """Look at the lowest corner's height [m] above the base, and at the slide."""
        width = 2.0 * self._half_width
        self._sink, self._highest = max(self._sink, -depth), max(self._highest, depth)
        if depth < -SINK_WIDTHS * width:
            words = f"the pivot sank {-depth:.3g} m into the base"
            self.broken = Problem(Reason.SANK, words)
        elif depth > THROWN_WIDTHS * width:
            words = f"the block was thrown {depth:.3g} m off the base"
            self.broken = Problem(Reason.THROWN, words)
        elif self._slide > SLIDE_WIDTHS * width and self._scene.friction != 0.0:
            words = f"the pivot slid {self._slide:.3g} m along the base"
            self.broken = Problem(Reason.SLID, words)

    def _aloft(self, row: Row, dt_s: float) -> None:
        side = math.copysign(1.0, row.theta)
        if self._swing is None or self._swing.side != side:
            self._land()
            self._swing = Swing(side, from_rest=self._resting)
            self._hop = 0.0
            if self._resting:
                self._uplifts.append(self._now.time)
                self._resting, self._rocked = False, True
        self._swing.add(row, dt_s)
        if self._swing.begun:
            self._launch()
            if self._swing.from_rest:
                earliest = self._rests[-1] if self._rests else 0.0
                self._uplifts[-1] = self._swing.lift_off(earliest)
        self._low_since = math.nan

    def _low(self, row: Row) -> None:
        self._land()
        if math.isnan(self._low_since):
            self._low_since = row.time
        if self._resting or abs(row.rate) > self._rest_rate:
            return
        if row.time - self._low_since >= self._rest_time:
            self._resting = True
            self._rests.append(self._low_since)
            self._launch()

    def _land(self) -> None:
        """End the present swing, if there is one, with an impact."""
        if self._swing is not None:
            self._launch()
            if self._swing.resolved:
                self._landed = self._swing.landing()
            self._swing = None

    def _launch(self) -> None:
        """Complete the last impact with the velocity after it, zero if no swing followed."""
        if self._landed is not None:
            time, velocity = self._landed
            after = 0.0 if self._swing is None else self._swing.launch(time)
            self._impacts.append(Impact(time, velocity, after))
            self._landed = None

    def _turning(self, a: Row, b: Row, c: Row) -> None:
        """Note the largest rotation near the middle one of three rows."""
        side = math.copysign(1.0, b.theta)
        peak = abs(c.theta)
        if b.rate * side > 0.0 >= c.rate * side:
            bend = (b.rate - c.rate) / (c.rate_s - b.rate_s) * side
            rate = extrapolated((b, c), b.time)
            peak = max(peak, abs(b.theta) + 0.5 * rate * rate / bend)
            self._turned = b.time >= self._motion_end and self.lifted
        if peak > self._peak:
            self._peak = peak
            self._crossed = peak > self._alpha

    def _decide(self, row: Row) -> None:
        size, outward = abs(row.theta), row.theta * row.rate > 0.0
        over = row.time >= self._motion_end
        self._overturned = size >= 0.5 * math.pi or (over and size > self._alpha and outward)
        settled = over and self._end == math.inf and (self._turned or self._resting)
        self.done = self._overturned or settled or row.time >= self._end

    def response(self, *, steps: int, wall_s: float) -> Response:
        """Return what was seen until now."""
        self._launch()
        if self._overturned:
            outcome, ratio = Outcome.OVERTURNED, math.inf
        elif self._rocked:
            outcome, ratio = Outcome.ROCKED, self._peak / self._alpha
        else:
            outcome, ratio = Outcome.AT_REST, 0.0
        times = self._scene.times
        return Response(
            outcome=outcome,
            peak_ratio=ratio,
            crossed=self._crossed or self._overturned,
            impacts=tuple(self._impacts),
            uplifts=tuple(self._uplifts),
            rests=tuple(self._rests),
            steps=steps,
            wall_s=wall_s,
            history=None if times is None or self._rows is None else sample(self._rows, times),
            slip_m=self._slide,
            sink_m=self._sink,
            hop_m=self._highest,
        )
