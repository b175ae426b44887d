"""The questions asked of the reference and the engines: one file a study, or a folder.

What is unknown or out of range is refused by a ValueError that says what is allowed.
"""
# `cases` has a case, `sources` answers, `kit` runs both and keeps the rows in a folder, `measures`
# compares an answer with the exact one, `drawing` draws it, `page` shows all.

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd
    from matplotlib.figure import Figure

    from analytic.motion import FloatArray, Motion
    from analytic.response import Response
    from engines.scene import System

__all__ = ["figure", "plot", "respond", "side_by_side"]


def respond(
    source: str,
    block: System,
    motion: Motion | None = None,
    *,
    start: tuple[float, float] = (0.0, 0.0),
    duration: float | None = None,
    times: FloatArray | None = None,
    history: bool = False,
    **options: Any,
) -> Response:
    """Ask any source, by its name, for the response of a block to a base motion.

    Parameters
    ----------
    source : str
        A name of `studies.sources.registry.SOURCES`; an engine takes a preset after a colon, as in
        ``"mujoco:tuned"``.
    block : RigidBlock, RockingFrame or SlidingBlock
        What stands on the base.
    motion : Motion, optional
        For instance a `SinePulse`, or `BothWays`; by default the ground does not move.
    start : (float, float), optional
        Rotation theta [rad] and angular velocity [rad/s] at time zero; at rest by default.
    duration : float, optional
        Observe until this time [s], not before the motion ends. By default the response is
        followed until its peak is decided, and an engine's frame for 8/p after the motion.
    times : array, optional
        Ground times [s] at which `Response.history` is sampled. Without a duration, "exact" and the
        other models go on to the last of them, and who steps as far as is needed to decide.
    history : bool, optional
        Keep a history without naming times: 1001 over the duration, by default the motion and 8/p.
    **options
        Passed on to the source: `step` of the solvers, any setting of an engine's `Scene`.

    Examples
    --------
    >>> from analytic import RigidBlock, SinePulse
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> pulse = SinePulse.in_g(0.4, omega=6.2832)
    >>> respond("exact", block, pulse).outcome.value
    'rocked'
    """
    import numpy as np

    from analytic.motion import Still
    from engines.scene import free_rocking_window
    from studies.sources.registry import resolve

    motion = Still() if motion is None else motion
    if tuple(start) != (0.0, 0.0):
        options["start"] = start
    if history and times is None:
        duration = free_rocking_window(block, motion) if duration is None else duration
        times = np.linspace(0.0, duration, 1001)
    asked = resolve(source)
    asked.check(block, motion, duration=duration, times=times, **options)
    return asked.call(block, motion, duration=duration, times=times, **options)


def plot(responses: Response | Sequence[Response] | Mapping[str, Response]) -> Figure:
    """Draw the histories of one response or several, perhaps by their names.

    The figure shows itself in a notebook; `savefig` writes it. ValueError without a history.

    Examples
    --------
    >>> from analytic import RigidBlock, SinePulse
    >>> block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse.in_g(0.4, omega=6.2832)
    >>> found = {name: respond(name, block, pulse, history=True) for name in ("exact", "housner")}
    >>> len(plot(found).axes)
    1
    """
    from analytic.response import Response
    from studies.drawing.figures import draw_responses

    if isinstance(responses, Mapping):
        return draw_responses(responses)
    each = [responses] if isinstance(responses, Response) else responses
    return draw_responses({f"response {n}": one for n, one in enumerate(each, start=1)})


def figure(number: int, sources: Sequence[str] = ("exact", "housner", "modified")) -> Figure:
    """Draw a figure of the paper, 2 or 4 to 9, with the lines of some sources; see `plot`.

    Figure 2 compares two solvers, "rk4" and "average-acceleration".

    Examples
    --------
    >>> figure(5).get_suptitle()
    'Figure 5: full-sine pulse'
    """
    import pandas as pd

    from studies import histories, sweep
    from studies.drawing.figures import shown_by_itself
    from studies.kit.run import run

    options: Any
    if number in (2, 4, 5):
        study, options = histories.STUDY, histories.Options(figure=(number,), sources=(*sources,))
    elif number in (6, 7, 8, 9):
        study, options = sweep.STUDY, sweep.Options(figure=(number,))
    else:
        raise ValueError(f"figure is {number!r}; it must be one of 2, 4, 5, 6, 7, 8, 9")
    rows = pd.DataFrame(run(study.jobs((*sources,), False, options), study.measure))
    return shown_by_itself(study.figures(study.tabulate(rows))[f"figure-{number}"])


def side_by_side(
    block: System,
    motion: Motion,
    sources: Iterable[str],
    *,
    start: tuple[float, float] = (0.0, 0.0),
    duration: float | None = None,
    friction: float | None = None,
    dt: float | None = None,
    estimate: bool = False,
) -> pd.DataFrame:
    """Ask several sources for the response of a block to the same motion of its base.

    Parameters
    ----------
    block, motion, start
        As in `respond`.
    sources : iterable of str
        Their names, each as in `respond`.
    duration : float, optional
        Observe until this time [s]; by default the motion and 8/p of free rocking.
    friction : float, optional
        Coefficient between block and base in the engines; by default their presets'. The models do
        not slide: where it is less than the exact solution needs, the message of its row says so.
    dt : float, optional
        Step [s] of the solvers, and of engines whose preset takes equal steps.
    estimate : bool, optional
        Whether every engine is also run at half its step, for an estimate of its error and what
        that bounds.

    Returns
    -------
    DataFrame
        A row for each source, with the columns of ``rocking compare --json``; the peak is inf where
        the block overturns, and what there is not is nan.

    Examples
    --------
    >>> from analytic import RigidBlock, SinePulse
    >>> block = RigidBlock(width=0.5, height=1.5)
    >>> pulse = SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
    >>> list(side_by_side(block, pulse, ["exact", "housner"])["outcome"])
    ['rocked', 'overturned']
    """
    import pandas as pd

    from analytic.checks import finite
    from studies.cases.refusal import BadInputError
    from studies.compare import compare, records
    from studies.kit.arguments import EffortOptions, Yours
    from studies.kit.jobs import Question
    from studies.kit.scene_options import window_of

    if isinstance(sources, str) or not (sources := list(sources)):
        raise ValueError(f"sources is {sources!r}; it must be a list of one name or more")
    if len(start) != 2:
        raise ValueError(f"start is {start!r}; it must be theta [rad] and theta' [rad/s]")
    start = (finite("start", start[0]), finite("start", start[1]))
    duration, friction, dt = (
        None if value is None else finite(name, value)
        for name, value in (("duration", duration), ("friction", friction), ("dt", dt))
    )
    try:
        window = window_of(block, motion, duration, dt=dt)
        case = Question(system=block, motion=motion, start=start, duration=window)
        yours = Yours(friction=friction, dt=dt)
        rows = compare(case, sources, yours, EffortOptions(), estimate=estimate)
    except BadInputError as error:
        raise ValueError(str(error).removeprefix("--")) from None
    return pd.DataFrame(records(rows))
