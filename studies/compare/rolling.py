"""A cylinder that rolls: every named source after five turns and after fifty."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from analytic.cylinder import RollingCylinder
from analytic.motion import Still
from studies.compare.records import as_lines
from studies.compare.rendering import right_aligned
from studies.kit.executors import Executor
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.kit.options import Yours
from studies.kit.runner import exit_code, run_jobs
from studies.measures.differences import scientific
from studies.measures.rolling import ERRORS, TURNS, reduced
from studies.sources.registry import Effort

COLUMNS = ("tilt [rad]", "phase [rad]", "up [m]", "aside [m]", "energy")
"""Those of the errors."""


def compare_rolling(
    cylinder: RollingCylinder,
    sources: Sequence[str],
    *,
    duration: float | None,
    effort: Effort,
    yours: Yours,
    executor: Executor,
    json: bool,
) -> int:
    """Ask every source, print a row for each and each number of turns; return the exit code.

    Parameters
    ----------
    cylinder : RollingCylinder
    sources : sequence of str
    duration : float or None
        Watch until this time [s]; by default five turns, and fifty.
    effort : Effort
    yours : Yours
    executor : Executor
    json : bool
        Print JSON objects, one a line, instead of a table.

    Returns
    -------
    int
        0 if every row is usable, 1 if some failed.

    Raises
    ------
    BadInputError
        If a source does not take what `effort` or `yours` says, or cannot be asked about it.
    """
    own = yours.options(sources, cylinder)
    turns = TURNS if duration is None else (duration / cylinder.turn,)
    jobs = [
        Job(
            labels={"turns": count},
            block=cylinder,
            motion=Still(),
            source=name,
            duration=count * cylinder.turn,
            options={**effort.options(name), **own[name]},
        )
        for name in sources
        for count in turns
    ]
    rows = run_jobs(jobs, executor=executor, reduce=reduced)
    print(as_lines(rows) if json else table_text(cylinder, turns, rows))
    return exit_code(rows)


def table_text(cylinder: RollingCylinder, turns: Sequence[float], rows: list[Row]) -> str:
    """Return the table with its head."""
    columns: dict[str, list[Any]] = {
        "source": [row["source"] for row in rows],
        "turns": [f"{row['turns']:g}" for row in rows],
        "outcome": [row["outcome"] for row in rows],
        **{
            name: [scientific(row[error]) for row in rows]
            for name, error in zip(COLUMNS, ERRORS, strict=True)
        },
        "steps": [row["steps"] for row in rows],
        "µs/step": [
            f"{1e6 * row['wall_s'] / row['steps']:.0f}" if row["steps"] else "-" for row in rows
        ],
    }
    swing = math.sqrt(abs(cylinder.wobble))
    change = f"swings at {swing:.4g} rad/s" if cylinder.wobble > 0.0 else f"grows by {swing:.4g}/s"
    grown = [(count, *cylinder.growth(count * cylinder.turn)) for count in turns]
    become = "; ".join(
        f"{tilt:.2g} in tilt and {phase:.2g} in phase after {count:g} turns"
        for count, tilt, phase in grown
    )
    notes = dict.fromkeys(f"{row['source']}: {row['message']}" for row in rows if row["message"])
    return "\n".join(
        [
            f"cylinder a = {cylinder.radius:g} m, H = {cylinder.height:g} m, "
            f"β = {cylinder.tilt:g} rad: Ω = {cylinder.precession:.6g} rad/s, "
            f"p = {cylinder.p:.5g} rad/s",
            f"rolling  steadily about its own centre; a small change of the tilt {change}",
            f"growth   a disturbance of 1 rad becomes {become}",
            "tilt, phase, up, aside, energy: errors at the end, the energy's relative",
            "",
            right_aligned(columns),
            *notes,
        ]
    )
