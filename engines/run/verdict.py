"""The response of a run, or the problem that makes it none, from what was watched."""

import math

from analytic.response import History, Impact, Outcome, Problem, Reason, Response
from engines.run import watch as seen
from engines.run.rows import THETA
from engines.run.watch import Watch, complete
from engines.world import FloatArray

PIVOT_SLID = "the pivot slid {:.3g} m along the base"
BEAM_SLID = "the beam slid {:.3g} m along the columns' tops"


def problem_of(problem: int, far: float, width: float) -> Problem | None:
    """Return why the response is no longer that of what was posed, where there is a reason."""
    if problem == seen.NO_PROBLEM:
        return None
    if problem in (seen.SLIPPED, seen.BEAM_SLIPPED):
        slid = (PIVOT_SLID if problem == seen.SLIPPED else BEAM_SLID).format(far)
        assumed = "steps that land on impacts assume that it holds, and allow at most"
        return Problem(Reason.SLID, f"{slid}; {assumed} {seen.HOLD_WIDTHS * width:.3g} m")
    words = {
        seen.DIVERGED: (Reason.DIVERGED, "the engine's state is not finite"),
        seen.SANK: (Reason.SANK, f"the block sank {far:.3g} m, through the base"),
        seen.THROWN: (Reason.THROWN, f"the block was thrown {far:.3g} m off the base"),
        seen.SLID: (Reason.SLID, PIVOT_SLID.format(far)),
        seen.BEAM_LOST: (Reason.SLID, BEAM_SLID.format(far)),
        seen.BEAM_THROWN: (Reason.THROWN, f"the beam was thrown {far:.3g} m off the columns"),
        seen.PARTED: (Reason.PARTED, f"the columns' rotations differ by {far:.3g} of alpha"),
    }
    return Problem(*words[int(problem)])


def response_of(watch: Watch, events: FloatArray, history: History | None) -> Response:
    """Return what was seen of a body; there is room for one more of its events (k, 4)."""
    complete(watch, events)
    sides = float(watch.peak / watch.alpha), float(watch.peak_left / watch.alpha_left)
    if watch.overturned:
        outcome, ratio = Outcome.OVERTURNED, math.inf
        right, left = sides
        sides = (math.inf, left) if watch.two[1, THETA] > 0.0 else (right, math.inf)
    else:
        outcome = Outcome.ROCKED if watch.rocked else Outcome.AT_REST
        ratio = max(sides)
    noted = events[: watch.events]
    uplifts, impacts, rests = (
        noted[noted[:, seen.KIND] == kind] for kind in (seen.UPLIFT, seen.IMPACT, seen.REST)
    )
    return Response(
        outcome=outcome,
        peak_ratio=ratio,
        peak_sides=sides,
        crossed=bool(watch.crossed or watch.overturned),
        impacts=tuple(Impact(*impact) for impact in impacts[:, seen.WHEN :].tolist()),
        uplifts=tuple(uplifts[:, seen.WHEN].tolist()),
        rests=tuple(rests[:, seen.WHEN].tolist()),
        message=_remark(watch),
        history=history,
        slip_m=float(watch.slide),
        sink_m=float(watch.sink),
        hop_m=float(watch.highest),
    )


def _remark(watch: Watch) -> str:
    """Say what a reader should know of a usable response: how deep it stood, how far it slid."""
    width, said = 2.0 * watch.half_width, []
    if watch.sunk > width * seen.SINK_WIDTHS:
        said.append(f"the block sank {watch.sunk:.3g} m into the base")
    for words, far in ((PIVOT_SLID, watch.slide), (BEAM_SLID, watch.beam_slide)):
        if far > width * seen.HOLD_WIDTHS and not watch.slides:
            said.append(words.format(far))
    return "; ".join(said)
