"""The paper's sensitivity analysis, figures 6 to 9: every case through every named source."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import pandas as pd

from studies.cases.paper import sweep_cases
from studies.kit import provenance
from studies.kit.arguments import (
    Count,
    Place,
    Positive,
    check_sources,
    figures,
    refuse_repeats,
)
from studies.kit.executors import Executor, choose
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.kit.naming import several_sources
from studies.kit.runner import exit_code, fill_folder
from studies.measures.claims import findings_text, write_findings
from studies.measures.differences import (
    summarize,
    summary_text,
    with_reference,
    worst_cases,
    worst_text,
)
from studies.measures.findings import findings
from studies.sources.groups import core_sources
from studies.sources.registry import DEFAULT_EFFORT, Accuracy, Effort
from studies.sweep import STUDY
from studies.sweep.claims import claims, first_claim, whole

if TYPE_CHECKING:
    from matplotlib.figure import Figure


DEFAULT_SOURCES = ("exact", "housner", "modified", "onset-matched", *core_sources())


def command(
    *,
    out: Place,
    figure: Annotated[tuple[int, ...], figures(6, 7, 8, 9)] = (6, 7, 8, 9),
    sources: Annotated[tuple[str, ...], several_sources] = DEFAULT_SOURCES,
    step: Positive | None = None,
    accuracy: Accuracy | None = None,
    jobs: Count | None = None,
    time_limit: Positive = 60.0,
    cluster: str | None = None,
) -> int:
    """Run the paper's sensitivity analysis.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
    figure
        Figures of the paper: 6, 7 (half-sine), 8, 9 (full-sine); all by default.
    sources
        Who is asked.
    step
        p dt [-] of the solvers and engines, the step in units of 1/p; by default their own.
    accuracy
        loose, standard or tight, for engines whose steps land on impacts; standard by default.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine's case is given up.
    cluster
        Address of a Dask scheduler, whose workers then run all cases, as in tcp://127.0.0.1:8786.
    """
    refuse_repeats("--figure", figure)
    check_sources(sources)
    executor = choose(jobs, time_limit, cluster)
    rows = sweep(figure, sources, out, executor=executor, effort=Effort(step, accuracy))
    print(report(out))
    return exit_code(rows)


def sweep(
    numbers: Sequence[int],
    sources: Sequence[str],
    folder: Path,
    *,
    executor: Executor,
    effort: Effort = DEFAULT_EFFORT,
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
    effort : Effort, optional
        How finely the solvers and engines step.

    Returns
    -------
    list of dict
        The rows of sweep.csv, one for each case and source.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    return fill_folder(
        folder,
        "sweep",
        sweep_jobs(numbers, sources, effort),
        module=__name__,
        executor=executor,
        settings=asdict(effort),
        growing={"figure": numbers, "source": sources},
        products=STUDY.products,
    )


def sweep_jobs(numbers: Sequence[int], sources: Sequence[str], effort: Effort) -> list[Job]:
    """Return the jobs in the order of the table: case by case, source by source."""
    return [
        Job(
            labels=asdict(case),
            block=case.block,
            motion=case.motion,
            source=source,
            options=effort.options(source),
        )
        for case in sweep_cases(numbers)
        for source in sources
    ]


def report(folder: Path) -> str:
    """Reduce and draw a folder's sweep.csv; return the summary and the findings as text."""
    from studies.drawing.figures import save_all

    rows = read(folder)
    compared = with_reference(rows)
    table = summarize(compared)
    provenance.write_text(folder / "summary.csv", table.to_csv(index=False, na_rep="nan"))
    found = findings(compared)
    write_findings(folder, found)
    conclusions = findings_text(found)
    provenance.write_text(folder / "findings.txt", conclusions + "\n")
    save_all(pictures(folder), folder)
    return "\n".join(
        [
            "Difference from exact: errors of the peak θmax/θcr are relative, over cases that both",
            "survive, κ being the larger of |∂ln θmax/∂ln a_p| and |∂ln θmax/∂ln η|; outcomes",
            "right, overturned falsely, overturning missed:",
            summary_text(table),
            "\nThe case where each source errs most; κ = ∂ln θmax/∂ln a_p, κη = ∂ln θmax/∂ln η:",
            worst_text(worst_cases(compared)),
            f"\nThe paper's conclusions:\n{conclusions}",
        ]
    )


def pictures(folder: Path) -> dict[str, "Figure"]:
    """Draw every figure of a folder from its sweep.csv alone."""
    from studies.sweep.figure import draw_sweep

    rows = read(folder)
    return {f"figure-{n}": draw_sweep(rows, int(n)) for n in rows["figure"].unique()}


def headline(folder: Path) -> str:
    """Say how many outcomes each preset of the engines gets wrong, and how far peaks are off."""
    return first_claim(whole(folder))


def paragraph(folder: Path) -> str:
    """Say how many outcomes each source gets right, and how far its peaks are off."""
    return claims(whole(folder))


def read(folder: Path) -> pd.DataFrame:
    """Read a sweep.csv back."""
    rows = pd.read_csv(folder / "sweep.csv", dtype={"message": str})
    return rows.fillna({"message": ""})
