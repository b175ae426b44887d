"""The paper's time histories, figures 2, 4 and 5, and what it says about them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from itertools import chain
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import pandas as pd

from analytic.response import Outcome, Response
from studies.cases.paper import HISTORIES, HistoryCase, free_rocking_window
from studies.drawing.kept import Pictures, as_text
from studies.histories import STUDY
from studies.old.arguments import Out, figures, refuse_repeats
from studies.old.jobs import Job, summary
from studies.old.journal import Row
from studies.old.naming import sources_option
from studies.old.options import DEFAULT_RUNNING, Running
from studies.old.plan import Plan, Tables, blaming_its_rows, fill
from studies.old.provenance import seal, write_text
from studies.old.runner import exit_code
from studies.measures.claims import TABLE, Finding, claim, read_findings, tally, write_findings
from studies.measures.samples import samples

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DEFAULT_SOURCES = {
    2: ("exact", "rk4", "average-acceleration"),
    4: ("exact", "housner", "modified"),
    5: ("exact", "housner", "modified"),
}
"""What the paper draws; its numerical solution is the exact model's."""

PAPERS = sources_option(
    "By default what the paper draws, exact, rk4 and average-acceleration in figure 2, exact, "
    "housner and modified in 4 and 5: ",
    default=False,
)

TITLES = {
    2: "Figure 2: fourth-order Runge–Kutta and average acceleration",
    4: "Figure 4: half-sine pulse",
    5: "Figure 5: full-sine pulse",
}


def command(
    *,
    out: Out,
    figure: Annotated[tuple[int, ...], figures(2, 4, 5)] = (2, 4, 5),
    sources: Annotated[tuple[str, ...] | None, PAPERS] = None,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Draw the paper's time histories and test what it says about them.

    Parameters
    ----------
    figure
        Figures of the paper: 2 (two solvers), 4 (half-sine) and 5 (full-sine); all by default.
    sources
        By default what the paper draws: exact, rk4 and average-acceleration in figure 2; exact,
        housner and modified in 4 and 5. Any other source may be named.
    """
    refuse_repeats("--figure", figure)
    plan = Plan(
        jobs=[
            history_job(case, source)
            for number in figure
            for case in HISTORIES[number]
            for source in sources or DEFAULT_SOURCES[number]
        ],
        settings={"sources": sources},
        reduce=reduce,
        tabulate=tabulate,
    )
    with blaming_its_rows(out):
        rows = fill(STUDY, plan, out, running)
        print(report(out, rows))
    seal(out)
    return exit_code(rows)


def history_job(case: HistoryCase, source: str) -> Job:
    """Return the job of one line in one panel."""
    window = free_rocking_window(case.block, case.motion)
    return Job(
        labels={"figure": case.figure, "panel": case.panel},
        block=case.block,
        motion=case.motion,
        source=source,
        duration=window,
        times=np.linspace(0.0, window, 1501),
    )


def reduce(job: Job, response: Response) -> Row:
    """Return the summary and the samples, none of a response that has no history."""
    row = summary(job, response)
    if response.history is None:
        return {**row, "samples": {}}
    drawn = samples(response, job.block, job.motion, {}).drop(columns="outcome")
    return {**row, "samples": drawn.to_dict("list")}


def tabulate(rows: Sequence[Row]) -> Tables:
    """Return the samples of each figure that has any, row by row."""
    cases = {(case.figure, case.panel): case for case in chain(*HISTORIES.values())}
    parts: dict[str, list[pd.DataFrame]] = {}
    for row in rows:
        if row["samples"]:
            labels = asdict(cases[row["figure"], row["panel"]])
            labels |= {"source": row["source"], "outcome": row["outcome"]}
            drawn = pd.DataFrame({**labels, **row["samples"]}).drop(columns="omega_rad_s")
            parts.setdefault(f"figure-{row['figure']}", []).append(drawn)
    return {name: pd.concat(tables, ignore_index=True) for name, tables in parts.items()}


def report(folder: Path, rows: Sequence[Row]) -> str:
    """Draw and judge the figures of some rows; write and return the texts."""
    from studies.drawing.figures import save_all

    tables, texts, found = tabulate(rows), [], []
    save_all(pictures(folder), folder)
    for number in dict.fromkeys(row["figure"] for row in rows):
        name, told = f"figure-{number}", [row for row in rows if row["figure"] == number]
        said = judge(number, told, tables.get(name, pd.DataFrame()))
        found.append(said)
        finding = f"{TITLES[number]}. {said.verdict}: {said.statement}; {said.numbers}"
        peaks = pd.DataFrame(told)[["panel", "source", "outcome", "peak_ratio"]]
        texts.append(as_text(finding, {"Largest rotations": peaks}))
        write_text(folder / f"{name}.txt", texts[-1] + "\n")
    held = read_findings(folder) if (folder / TABLE).is_file() else []
    new = {item.statement for item in found}
    # what it holds about figures that were not drawn now stays
    write_findings(folder, [*(item for item in held if item.statement not in new), *found])
    return "\n\n".join(texts)


def pictures(folder: Path) -> Pictures:
    """Draw every figure of a folder from its CSV alone."""
    figures = [n for n in HISTORIES if (folder / f"figure-{n}.csv").is_file()]
    return {f"figure-{n}": drawn(folder, n) for n in figures}


def finding(folder: Path) -> str:
    """Say how many of the paper's statements about its histories hold."""
    return tally(read_findings(folder), "the paper's statements about its time histories")


def drawn(folder: Path, figure: int) -> Figure:
    """Draw one figure from its CSV alone."""
    from studies.drawing.figures import draw_histories

    samples = pd.read_csv(folder / f"figure-{figure}.csv")
    # lines that coincide are told apart by what separates them
    errors = figure == 2 and "exact" in set(samples["source"])
    return draw_histories(samples, TITLES[figure], errors=errors)


def judge(figure: int, rows: Sequence[Row], samples: pd.DataFrame) -> Finding:
    """Test what the paper says about a figure, of the sources that answered in every panel."""
    failed = {row["source"] for row in rows if row["outcome"] == Outcome.FAILED.value}
    asked = samples if figure == 2 and len(samples) else pd.DataFrame(rows)
    return CLAIMS[figure](asked[~asked["source"].isin(failed)])


@claim(
    "Runge–Kutta and average acceleration coincide (within 0.001 of θcr)",
    "average-acceleration",
    "rk4",
)
def solvers_coincide(table: pd.DataFrame) -> tuple[bool, str]:
    """Compare the samples of both solvers."""
    lines = table.pivot(index=["panel", "time_s"], columns="source", values="theta_ratio")
    apart = (lines["rk4"] - lines["average-acceleration"]).abs().groupby("panel").max()
    words = ", ".join(f"2-{panel} {value:.1e}" for panel, value in apart.items())
    return bool((apart < 1e-3).all()), f"largest difference of θ/θcr: {words}"


@claim(
    "Housner's error grows as H/B falls, and the modified linearization's stays smaller",
    "exact",
    "housner",
    "modified",
)
def housner_strays(rows: pd.DataFrame) -> tuple[bool, str]:
    """Compare the errors of both linearizations from panel to panel."""
    peaks = rows.pivot(index="panel", columns="source", values="peak_ratio")
    errors = peaks[["housner", "modified"]].div(peaks["exact"], axis=0) - 1.0
    far, near = errors["housner"].abs(), errors["modified"].abs()
    holds = bool((far.diff().iloc[1:] > 0.0).all() and (near < far).all())
    words = [f"{name} {', '.join(map('{:+.1%}'.format, errors[name]))}" for name in errors]
    return holds, f"error of the peak in 4-a, b, c (H/B 6, 3, 2): {'; '.join(words)}"


@claim(
    "In 5-b and 5-c the block overturns by Housner alone, and survives otherwise",
    "exact",
    "housner",
    "modified",
)
def housner_overturns(rows: pd.DataFrame) -> tuple[bool, str]:
    """Look at the outcomes in 5-b and 5-c."""
    table = rows.pivot(index="panel", columns="source", values="outcome")
    outcomes = table.loc[["b", "c"], ["exact", "housner", "modified"]]
    holds = bool((outcomes == ["rocked", "overturned", "rocked"]).all(axis=None))
    words = [
        f"5-{panel}: {', '.join(f'{name} {outcome}' for name, outcome in found.items())}"
        for panel, found in outcomes.iterrows()
    ]
    return holds, "; ".join(words)


CLAIMS = {2: solvers_coincide, 4: housner_strays, 5: housner_overturns}
"""Figure -> what the paper says about it."""
