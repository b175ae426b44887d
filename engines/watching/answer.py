"""What was seen of a block, as a response or as the reason why there is none."""

import math

from analytic.response import History, Impact, Outcome, Problem, Reason, Response
from engines.parts.compiled import FloatArray
from engines.watching.observe import (
    DIVERGED,
    IMPACT,
    KIND,
    REST,
    SANK,
    SLID,
    THROWN,
    UPLIFT,
    WHEN,
    Watch,
    complete,
)

SINK_WIDTHS = 0.05
"""Of a corner deeper in the base than this part of the width a reader should know."""


def problem_of(watch: Watch) -> Problem | None:
    """Return why the response is no longer that of a rocking block."""
    words = {
        DIVERGED: (Reason.DIVERGED, "the engine's state is not finite"),
        SANK: (Reason.SANK, f"the block sank {watch.far:.3g} m, through the base"),
        THROWN: (Reason.THROWN, f"the block was thrown {watch.far:.3g} m off the base"),
        SLID: (Reason.SLID, f"the pivot slid {watch.far:.3g} m along the base"),
    }
    return Problem(*words[int(watch.problem)]) if watch.problem else None


def response_of(
    watch: Watch, events: FloatArray, history: History | None, *, steps: int, wall_s: float
) -> Response:
    """Return what was seen until now; `events` has room for one more."""
    complete(watch, events)
    if watch.overturned:
        outcome, ratio = Outcome.OVERTURNED, math.inf
    elif watch.rocked:
        outcome, ratio = Outcome.ROCKED, float(watch.peak / watch.alpha)
    else:
        outcome, ratio = Outcome.AT_REST, 0.0
    seen = events[: watch.events]
    uplifts, impacts, rests = (seen[seen[:, KIND] == kind] for kind in (UPLIFT, IMPACT, REST))
    return Response(
        outcome=outcome,
        peak_ratio=ratio,
        crossed=bool(watch.crossed or watch.overturned),
        impacts=tuple(Impact(*impact) for impact in impacts[:, WHEN:].tolist()),
        uplifts=tuple(uplifts[:, WHEN].tolist()),
        rests=tuple(rests[:, WHEN].tolist()),
        steps=steps,
        wall_s=wall_s,
        message=_remark(watch),
        history=history,
        slip_m=float(watch.slide),
        sink_m=float(watch.sink),
        hop_m=float(watch.highest),
    )


def _remark(watch: Watch) -> str:
    """Say what a reader should know of a usable response: how deep the block was in its base."""
    if watch.sink <= 2.0 * watch.half_width * SINK_WIDTHS:
        return ""
    return f"the block sank {watch.sink:.3g} m into the base"
