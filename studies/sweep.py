"""The paper's sensitivity analysis, figures 6 to 9: every case through every named source."""

import time
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated, Any

import pandas as pd

from studies import provenance
from studies.arguments import Count, Positive, check_sources, figures, refuse_repeats, several
from studies.cases import sweep_cases
from studies.differences import (
    CASE_COLUMNS,
    summarize,
    summary_text,
    with_reference,
    worst_cases,
    worst_text,
)
from studies.executors import Executor, Local
from studies.findings import findings, findings_text
from studies.jobs import Job, summary
from studies.journal import FolderError, Row, open_journal
from studies.runner import exit_code, run_jobs
from studies.sources import resolve

COLUMNS = [
    *CASE_COLUMNS,
    "source",
    "outcome",
    "peak_ratio",
    "impacts",
    "steps",
    "wall_s",
    "message",
]
"""The columns of sweep.csv."""

PRODUCTS = ("sweep.csv", "summary.csv", "findings.txt", "provenance.json")


DEFAULT_SOURCES = ("exact", "housner", "modified", "onset-matched", "pybullet", "mujoco")


def command(
    *,
    out: Path,
    figure: Annotated[tuple[int, ...], figures(6, 7, 8, 9)] = (6, 7, 8, 9),
    sources: Annotated[tuple[str, ...], several] = DEFAULT_SOURCES,
    step: Positive | None = None,
    jobs: Count | None = None,
    time_limit: Positive = 60.0,
) -> int:
    """Run the paper's sensitivity analysis.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
    figure
        Figures of the paper: 6, 7 (half-sine), 8, 9 (full-sine); all by default.
    sources
        exact housner modified onset-matched rk4 average-acceleration pybullet mujoco; an engine
        takes a preset after a colon, as in mujoco:fixed.
    step
        p dt [-] of the solvers and engines, the step in units of 1/p; by default their own.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine's case is given up.
    """
    refuse_repeats("--figure", figure)
    check_sources(sources)
    executor = Local(jobs or provenance.usable_cores(), time_limit)
    rows = sweep(figure, sources, out, executor=executor, step=step)
    print(report(out))
    return exit_code(rows)


def sweep(
    numbers: Sequence[int],
    sources: Sequence[str],
    folder: Path,
    *,
    executor: Executor,
    step: float | None = None,
) -> list[Row]:
    """Run the cases that the folder does not hold yet, and write its CSV.

    Parameters
    ----------
    numbers : sequence of int
        Figures, of 6, 7, 8, 9.
    sources : sequence of str
    folder : Path
        Results of another version, with other settings, or of figures and sources that are not
        named here are refused, so that nothing is lost.
    executor : Executor
    step : float, optional
        p dt of the solvers and engines; their own by default.

    Returns
    -------
    list of dict
        `COLUMNS`, one row for each case and source.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    began = time.perf_counter()
    jobs = sweep_jobs(numbers, sources, step)
    identity = provenance.identity("sweep", step=step)
    with open_journal(folder, identity, PRODUCTS) as journal:
        _refuse_a_part(folder, journal.rows.values(), numbers, sources)
        path = folder / "provenance.json"
        asked = {"figures": list(numbers), "sources": list(sources)}
        record = provenance.begin(path, identity, asked)
        try:
            rows = run_jobs(jobs, executor=executor, reduce=summary, journal=journal)
        except KeyboardInterrupt as stop:
            kept = f"{len(journal.rows)} of {len(jobs)} rows are kept in {str(folder)!r}"
            raise KeyboardInterrupt(f"{kept}; the same command goes on from there") from stop
        table = pd.DataFrame(rows, columns=COLUMNS)
        provenance.write_text(folder / "sweep.csv", table.to_csv(index=False, na_rep="nan"))
        provenance.finish(path, record, began, len(rows))
    return rows


def sweep_jobs(numbers: Sequence[int], sources: Sequence[str], step: float | None) -> list[Job]:
    """Return the jobs in the order of the table: case by case, source by source."""
    stepping = {name: resolve(name).kind != "model" for name in sources}
    options: dict[str, Any] = {} if step is None else {"step": step}
    return [
        Job(
            labels=asdict(case),
            block=case.block,
            motion=case.motion,
            source=source,
            options=options if stepping[source] else {},
        )
        for case in sweep_cases(numbers)
        for source in sources
    ]


def _refuse_a_part(folder: Path, rows: Any, numbers: Sequence[int], sources: Sequence[str]) -> None:
    left_out = [
        f"{column} {', '.join(map(str, names))}"
        for column, named in (("figure", numbers), ("source", sources))
        if (names := sorted({row[column] for row in rows} - set(named)))
    ]
    if left_out:
        problem = f"it also holds results of {' and '.join(left_out)}, which must be named too"
        raise FolderError(folder, problem)


def report(folder: Path) -> str:
    """Reduce and draw a folder's sweep.csv; return the summary and the findings as text."""
    rows = read(folder)
    compared = with_reference(rows)
    table = summarize(compared)
    provenance.write_text(folder / "summary.csv", table.to_csv(index=False, na_rep="nan"))
    conclusions = findings_text(findings(compared))
    provenance.write_text(folder / "findings.txt", conclusions + "\n")
    redraw(folder)
    return "\n".join(
        [
            "Difference from exact: errors of the peak θmax/θcr are relative, Δ is absolute, over",
            "cases that both survive; outcomes right, overturned falsely, overturning missed:",
            summary_text(table),
            "\nThe case in which each source errs most; κ = ∂ln θmax/∂ln a_p there:",
            worst_text(worst_cases(compared)),
            f"\nThe paper's conclusions:\n{conclusions}",
        ]
    )


def redraw(folder: Path) -> list[Path]:
    """Draw every figure of a folder from its sweep.csv alone; return the files."""
    from studies.figures import draw_sweep, save

    rows = read(folder)
    paths = []
    for figure in rows["figure"].unique():
        paths.append(folder / f"figure-{figure}.png")
        save(draw_sweep(rows, int(figure)), paths[-1])
    return paths


def read(folder: Path) -> pd.DataFrame:
    """Read a sweep.csv back."""
    rows = pd.read_csv(folder / "sweep.csv", dtype={"message": str})
    return rows.fillna({"message": ""})
