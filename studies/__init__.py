"""The questions asked of the reference and the engines.

One folder a study, listed in `catalogue`. A case flows one way: `cases` poses it, `sources`
answers, `kit` makes of both what a study leaves in a folder (`kit.plan` says how), `measures` says
what an answer is worth, `drawing` draws it, `page` shows all.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from analytic.block import RigidBlock
    from analytic.motion import FloatArray, Motion
    from analytic.response import Response

__all__ = ["respond"]


def respond(
    source: str,
    block: RigidBlock,
    motion: Motion,
    *,
    start: tuple[float, float] = (0.0, 0.0),
    duration: float | None = None,
    times: FloatArray | None = None,
    **options: Any,
) -> Response:
    """Ask any source, by its name, for the response of a block to a base motion.

    Parameters
    ----------
    source : str
        A name of `studies.sources.registry.SOURCES`; an engine takes a preset after a colon, as in
        ``"mujoco:fixed"``.
    block : RigidBlock
    motion : Motion
        For instance a `SinePulse`; `analytic.Still()` where the ground does not move.
    start : (float, float), optional
        Rotation theta [rad] and angular velocity [rad/s] at time zero; at rest by default.
    duration : float, optional
        Observe until this time [s], not before the motion ends. By default the response is
        followed until its peak is decided, and no longer.
    times : array, optional
        Ground times [s] at which `Response.history` is sampled.
    **options
        Passed on to the source: `step` of the solvers, any setting of an engine's `Scene`.

    Raises
    ------
    ValueError
        If there is no such source, preset or option, or a value is not allowed.
    """
    from studies.sources.registry import resolve

    if tuple(start) != (0.0, 0.0):
        options["start"] = start
    asked = resolve(source)
    asked.check(block, motion, duration=duration, times=times, **options)
    return asked.call(block, motion, duration=duration, times=times, **options)
