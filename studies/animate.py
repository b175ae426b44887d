"""A film of one scene: several sources side by side, on the same shaken base and clock."""

import math
from collections.abc import Sequence
from importlib.util import find_spec

import numpy as np

from analytic import Outcome, SlidingBlock
from analytic.motion import BothWays
from studies.cases.refusal import BadInputError
from studies.kit.arguments import Computing, Place, Sources, Yours, check_file
from studies.kit.jobs import Job, Question, Row
from studies.kit.run import Place as Where
from studies.kit.run import exit_code, here, place_of, run, with_response
from studies.kit.scene_options import Excitation, Height, Standing, Width, window_of
from studies.sources.registry import core_sources

DEFAULT_SOURCES = ("exact", "housner", *core_sources("default"), *core_sources())
FRAMES_A_SECOND, MOST_FRAMES, MOST_SOURCES = 25, 1500, 8
"""At most a minute of film, which holds up to 1 GB of memory while it is drawn."""


def command(
    *,
    out: Place,
    width: Width,
    height: Height,
    excitation: Excitation = Excitation(),  # noqa: B008
    standing: Standing = Standing(),  # noqa: B008
    yours: Yours = Yours(),  # noqa: B008
    sources: Sources = DEFAULT_SOURCES,
    computing: Computing = Computing(),  # noqa: B008
) -> int:
    """Film one block, frame or slide as several sources compute it, side by side.

    Parameters
    ----------
    out
        The film: a .gif, or an .mp4 (which needs the extra [video]).
    sources
        As in `rocking compare`, at most 8; the models are not asked by default where nothing rocks.
    """
    check_file("--out", out, ".gif", ".mp4")
    if out.suffix == ".mp4" and find_spec("imageio_ffmpeg") is None:
        words = "that needs the extra [video]: pip install imageio-ffmpeg"
        raise BadInputError(f"--out is an .mp4; {words}")
    if len(sources) > MOST_SOURCES:
        raise BadInputError(
            f"--sources has {len(sources)} names; it may have at most {MOST_SOURCES}"
        )
    system = standing.system(width, height, yours.friction)
    motion, start = excitation.pose(system)
    nonlinear = standing.scene == "slide" or isinstance(motion, BothWays)
    if nonlinear and sources == DEFAULT_SOURCES:
        sources = tuple(name for name in sources if name != "housner")
    window = window_of(system, motion, dt=yours.dt)
    frames = window * FRAMES_A_SECOND
    if not frames < MOST_FRAMES:
        words = f"{window:g} s are {frames:.3g} frames"
        raise BadInputError(f"{words}; a film must have fewer than {MOST_FRAMES}")
    times = np.linspace(0.0, window, math.ceil(frames) + 1)
    shown = Question(system=system, motion=motion, start=start, duration=window, times=times)
    rows = moved(shown, sources, yours, place_of(computing, at_once=True))
    if usable := [row for row in rows if row["outcome"] != Outcome.FAILED.value]:
        from studies.drawing.film import write_film

        write_film(out, system, motion, times, usable, FRAMES_A_SECOND)
        print(out)
    return exit_code(rows)


def moved(case: Question, sources: Sequence[str], yours: Yours, place: Where = here) -> list[Row]:
    """Run the sources; return their rows with the rotation [rad] or place [m] at every time."""
    own = yours.options(sources, case.system)
    jobs = [Job(labels={}, case=case, source=name, options=own[name]) for name in sources]
    rows, times = run(jobs, with_response, place), np.asarray(case.times)
    for row in rows:
        if (history := row["response"].history) is not None:
            row["theta"] = np.interp(times, history.time, history.theta)
            if row["outcome"] == "overturned" and not isinstance(case.system, SlidingBlock):
                # a block that is lost from sight when its outcome is decided has fallen
                beyond = times > history.time[-1]
                row["theta"][beyond] = math.copysign(math.pi / 2, history.theta[-1])
    return rows
