"""Free rocking: the period and the decay of each source against the closed forms."""

import itertools
import math
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import pandas as pd
from scipy.optimize import brentq

from analytic import MODELS, RigidBlock, SinePulse, peak_ratios
from analytic.criteria import free_amplitude, quarter_period
from analytic.motion import FloatArray
from analytic.response import Outcome, Response
from studies.free import STUDY
from studies.kit import provenance
from studies.kit.arguments import Count, Place, Positive, check_sources
from studies.kit.executors import Executor, choose
from studies.kit.jobs import Job, summary
from studies.kit.journal import Row
from studies.kit.naming import several_sources
from studies.kit.runner import exit_code, fill_folder
from studies.measures.differences import scientific
from studies.sources.groups import core_sources
from studies.sources.registry import resolve

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ASPECTS = (1.5, 2.0, 3.0, 4.0, 6.0, 10.0)
TILTS = (0.1, 0.3, 0.5, 0.7, 0.9)
"""Rotations over alpha from which the blocks fall."""
QUICK_ASPECTS, QUICK_TILTS = (2.0, 4.0), (0.3, 0.9)
DEFAULT_SOURCES = ("exact", "housner", "modified", "rk4", *core_sources())
OMEGA_OVER_P = 8.0
"""Of the half-sine that tilts the block: it is over long before the block turns."""
SAMPLES = 6000
SWINGS = 3
"""Swings after the fall from the tilt that are compared."""
IMPACTS = 20
"""Impacts over which the times of a source drift from those of the closed form, ..."""
LEAST_SWING = 1e-3
"""... or fewer, as many as are followed by swings to this part of alpha or more."""


def command(
    *,
    out: Place,
    quick: bool = False,
    sources: Annotated[tuple[str, ...], several_sources] = DEFAULT_SOURCES,
    jobs: Count | None = None,
    time_limit: Positive = 60.0,
    cluster: str | None = None,
) -> int:
    """Hold free rocking of each source against the closed forms.

    A short pulse tilts the block; it falls back and rocks on. The time between two impacts is twice
    the quarter period of the rotation between them, and that rotation follows from the one before
    by the velocity ratio at the impact. What the errors of many impacts add up to is the drift: by
    how much the 20th impact comes too late, counted from the first.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
    quick
        Two aspect ratios and two tilts.
    sources
        Who is asked.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine's case is given up.
    cluster
        Address of a Dask scheduler, whose workers then run all cases, as in tcp://127.0.0.1:8786.
    """
    check_sources(sources)
    executor = choose(jobs, time_limit, cluster)
    rows = free(sources, out, quick=quick, executor=executor)
    print(report(out))
    return exit_code(rows)


def free(sources: Sequence[str], folder: Path, *, quick: bool, executor: Executor) -> list[Row]:
    """Run what the folder does not hold yet, and write its table.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    return fill_folder(
        folder,
        "free",
        free_jobs(sources, quick),
        module=__name__,
        executor=executor,
        reduce=reduce,
        settings={"quick": quick},
        growing={"source": sources},
        products=STUDY.products,
    )


def free_jobs(sources: Sequence[str], quick: bool) -> list[Job]:
    """Return a job for each aspect ratio, tilt and source."""
    return [
        released(aspect, tilt, source)
        for aspect in (QUICK_ASPECTS if quick else ASPECTS)
        for tilt in (QUICK_TILTS if quick else TILTS)
        for source in sources
    ]


def released(aspect: float, tilt: float, source: str) -> Job:
    """Return the job of a block that a pulse tilts to `tilt` alpha, of the source's own model."""
    block = RigidBlock(width=0.5, height=0.5 * aspect)
    model = resolve(source).model
    motion = SinePulse(
        amplitude=tilting_amplitude(block, tilt, model) * block.gravity,
        omega=OMEGA_OVER_P * block.p,
    )
    fall = quarter_period(block, tilt * block.alpha, model)
    sampled = motion.duration + (3.0 + 2.0 * SWINGS) * fall
    rocking = motion.duration + 3.0 * fall + sum(swing_times(block, tilt * block.alpha, model))
    return Job(
        labels={"aspect": aspect, "tilt": tilt},
        block=block,
        motion=motion,
        source=source,
        duration=max(sampled, rocking),
        times=np.linspace(0.0, sampled, SAMPLES),
    )


def tilting_amplitude(block: RigidBlock, tilt: float, model: str) -> float:
    """Return the amplitude [g] of the half-sine whose peak is `tilt`."""

    def excess(amplitude: float) -> float:
        peak, _ = peak_ratios(block.alpha, amplitude, OMEGA_OVER_P, 1, model, block.restitution)
        return min(float(peak), 2.0) - tilt

    onset = math.tan(block.alpha)
    return float(brentq(excess, onset, 40.0 * onset, xtol=1e-14))


def reduce(job: Job, response: Response) -> Row:
    """Return the summary, the largest errors of period and decay over the swings, and the drift."""
    model = resolve(job.source).model
    period_error = decay_error = drift = math.nan
    timed = 0
    tops = turning_points(response)
    if response.outcome is Outcome.ROCKED and len(tops) > 1:
        times = [impact.time for impact in response.impacts]
        periods = [
            (later - before) / (2.0 * quarter_period(job.block, top, model)) - 1.0
            for before, later, top in zip(times, times[1:], tops[1:], strict=False)
        ]
        period_error = max(map(abs, periods))
        decays = [
            after / next_amplitude(job.block, before, model) - 1.0
            for before, after in itertools.pairwise(tops)
        ]
        decay_error = max(map(abs, decays))
        swings = swing_times(job.block, tops[0], model)
        timed = 1 + len(swings)
        if len(times) >= timed:
            drift = (times[timed - 1] - times[0] - sum(swings)) * job.block.p
    return {
        **summary(job, response),
        "swings": max(len(tops) - 1, 0),
        "period_error": period_error,
        "decay_error": decay_error,
        "timed_impacts": timed,
        "drift_p": drift,
    }


def swing_times(block: RigidBlock, theta: float, model: str) -> list[float]:
    """Return the times [s] between the impacts that are timed, after a fall from `theta` [rad]."""
    times: list[float] = []
    top = next_amplitude(block, theta, model)
    while len(times) < IMPACTS - 1 and top >= LEAST_SWING * block.alpha:
        times.append(2.0 * quarter_period(block, top, model))
        top = next_amplitude(block, top, model)
    return times


def next_amplitude(block: RigidBlock, theta: float, model: str) -> float:
    """Return the rotation [rad] that follows the impact after `theta`, by energy."""
    law = MODELS[model].law(block.alpha, block.restitution)
    if not law.linear:
        return free_amplitude(block, theta, 1)
    left = law.eta**2 * theta * (2.0 * law.saddle - theta)
    return left / (law.saddle + math.sqrt(law.saddle**2 - left))


def turning_points(response: Response) -> list[float]:
    """Return the largest rotation [rad] before each of the first impacts, from the history."""
    history = response.history
    if history is None or not response.impacts:
        return []
    times = [0.0, *(impact.time for impact in response.impacts[: SWINGS + 1])]
    theta = np.abs(history.theta)
    tops = []
    for begin, end in itertools.pairwise(times):
        inside = np.nonzero((history.time > begin) & (history.time < end))[0]
        if inside.size < 5:
            break
        tops.append(crest(theta, inside))
    return tops


def crest(theta: FloatArray, inside: np.ndarray[tuple[int, ...], np.dtype[np.intp]]) -> float:
    """Return the maximum of the parabola through the largest sample and its neighbours."""
    place = int(inside[np.argmax(theta[inside])])
    place = min(max(place, 1), len(theta) - 2)
    left, top, right = theta[place - 1 : place + 2]
    bend = left - 2.0 * top + right
    return float(top - (right - left) ** 2 / (8.0 * bend)) if bend < 0.0 else float(top)


def report(folder: Path) -> str:
    """Reduce and draw a folder's free.csv; write and return the text."""
    from studies.drawing.figures import save_all

    save_all(pictures(folder), folder)
    text = f"{table_text(read(folder))}\n\n{paragraph(folder)}"
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def read(folder: Path) -> pd.DataFrame:
    """Read a free.csv back."""
    return pd.read_csv(folder / "free.csv", dtype={"message": str}).fillna({"message": ""})


def table_text(rows: pd.DataFrame) -> str:
    """Return, for each source and tilt, the largest errors over the aspect ratios."""
    lines = errors(rows, ["source", "tilt"])
    both = lines["period_error"].map(scientific) + " " + lines["decay_error"].map(scientific)
    tables = {
        "Largest relative error of the time between impacts and of the next rotation:": both,
        f"Largest drift over up to {IMPACTS} impacts [1/p]:": lines["drift_p"].map(scientific),
    }
    order = list(rows["source"].unique())
    return "\n\n".join(
        f"{head}\n"
        f"{cells.unstack('tilt').rename_axis(index=None, columns='θ0/α').loc[order].to_string()}"
        for head, cells in tables.items()
    )


def errors(rows: pd.DataFrame, by: list[str]) -> pd.DataFrame:
    """Return the largest errors of each group of rows."""
    sizes = rows.assign(drift_p=rows["drift_p"].abs())
    return sizes.groupby(by, sort=False)[["period_error", "decay_error", "drift_p"]].max()


def headline(folder: Path) -> str:
    """Say to what each source follows the closed forms of its model, at worst."""
    worst = errors(read(folder), ["source"])[["period_error", "decay_error"]].max(axis=1)
    words = [f"{name} {scientific(value)}" for name, value in worst.items()]
    return f"Free rocking follows the closed forms, at worst to: {', '.join(words)}."


def paragraph(folder: Path) -> str:
    """Say how far period, decay and drift of each source are from its model's closed forms."""
    words = [
        f"{source} {scientific(line['period_error'])}, {scientific(line['decay_error'])} and "
        f"{scientific(line['drift_p'])}/p"
        for source, line in errors(read(folder), ["source"]).iterrows()
    ]
    return (
        "Free rocking against the closed forms of each source's model, largest relative error of "
        "the time between two impacts, of the rotation after one, and the drift over up to "
        f"{IMPACTS} impacts: {'; '.join(words)}."
    )


def pictures(folder: Path) -> dict[str, "Figure"]:
    """Draw the errors of a folder from its free.csv alone."""
    from studies.drawing.diagrams import draw_free

    return {"free": draw_free(read(folder))}
