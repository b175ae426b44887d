"""What was seen of a scene, as a response or as the reason why there is none."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import cast

from analytic.response import History, Impact, Outcome, Problem, Reason, Response
from engines.run.slide import DISTANCE, SINCE, Slide, end_slip
from engines.run.slide import WHEN as STOP
from engines.run.slide import observables_of as observables_of_slide
from engines.run.watch import (
    BEAM_SLIPPED,
    DIVERGED,
    HOLD_WIDTHS,
    IMPACT,
    KIND,
    REST,
    SANK,
    SLID,
    SLIPPED,
    THROWN,
    UPLIFT,
    WHEN,
    Watch,
    complete,
)
from engines.world import FloatArray

SINK_WIDTHS = 0.05
"""Of a corner deeper in the base than this part of the width a reader should know."""

PIVOT_SLID = "the pivot slid {:.3g} m along the base"
BEAM_SLID = "the beam slid {:.3g} m along the columns' tops"


def problem_of(watch: Watch | Slide) -> Problem:
    """Return why the response is no longer that of what was posed, where there is a reason."""
    if watch.problem in (SLIPPED, BEAM_SLIPPED):
        slid = (PIVOT_SLID if watch.problem == SLIPPED else BEAM_SLID).format(watch.far)
        most = HOLD_WIDTHS * 2.0 * cast(Watch, watch).half_width
        assumed = f"steps that land on impacts assume that it holds, and allow at most {most:.3g} m"
        return Problem(Reason.SLID, f"{slid}; {assumed}")
    words = {
        DIVERGED: (Reason.DIVERGED, "the engine's state is not finite"),
        SANK: (Reason.SANK, f"the block sank {watch.far:.3g} m, through the base"),
        THROWN: (Reason.THROWN, f"the block was thrown {watch.far:.3g} m off the base"),
        SLID: (Reason.SLID, PIVOT_SLID.format(watch.far)),
    }
    return Problem(*words[int(watch.problem)])


def response_of(watch: Watch, events: FloatArray, history: History | None) -> Response:
    """Return what was seen until now.

    Parameters
    ----------
    watch : Watch
    events : ndarray (>= watch.events + 1, 4), columns as in `watch`: there is room for one more
    history : History or None
    """
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
        message=_remark(watch),
        history=history,
        slip_m=float(watch.slide),
        sink_m=float(watch.sink),
        hop_m=float(watch.highest),
    )


def _remark(watch: Watch) -> str:
    """Say what a reader should know of a usable response: how deep it stood, how far it slid."""
    width, said = 2.0 * watch.half_width, []
    if watch.sunk > width * SINK_WIDTHS:
        said.append(f"the block sank {watch.sunk:.3g} m into the base")
    for words, far in ((PIVOT_SLID, watch.slide), (BEAM_SLID, watch.beam_slide)):
        if far > width * HOLD_WIDTHS and not watch.slides:
            said.append(words.format(far))
    return "; ".join(said)


def together(responses: Sequence[Response], observables: Mapping[str, float]) -> Response:
    """Return the response of bodies that rock side by side: the first one's, and how all fared.

    It has overturned if one has, and its peak is the largest.

    Parameters
    ----------
    responses : sequence of Response, one a body
    observables : mapping, what was seen beside them
    """
    first, *others = responses
    if not others:
        return replace(first, observables=observables) if observables else first
    fallen = [each for each in responses if each.outcome is Outcome.OVERTURNED]
    peaks = {f"peak_{number + 1}": each.peak_ratio for number, each in enumerate(responses)}
    return replace(
        first,
        outcome=Outcome.OVERTURNED if fallen else first.outcome,
        peak_ratio=max(each.peak_ratio for each in responses),
        crossed=any(each.crossed for each in responses),
        message=next((each.message for each in responses if each.message), ""),
        observables={**peaks, **observables},
    )


def slide_response(slide: Slide, slips: FloatArray, history: History | None) -> Response:
    """Return what was seen of a box that slides; the last slip counts as far as it got.

    Parameters
    ----------
    slide : Slide
    slips : ndarray (>= slide.slips + 1, >= 3), columns as in `sliding`: there is room for one more
    history : History or None
    """
    end_slip(slide, slips, slide.time, slide.place)
    slide.way = 0.0
    seen = slips[: slide.slips]
    slid = Outcome.SLID if slide.slips else Outcome.AT_REST
    return Response(
        outcome=Outcome.OVERTURNED if slide.overturned else slid,
        peak_ratio=math.inf if slide.overturned else 0.0,
        slips=tuple(seen[:, DISTANCE].tolist()),
        slip_times=tuple(map(tuple, seen[:, [SINCE, STOP]].tolist())),
        slip_m=float(max(abs(seen[:, DISTANCE]), default=0.0)),
        sink_m=float(slide.depth),
        history=history,
        observables=observables_of_slide(slide),
    )
