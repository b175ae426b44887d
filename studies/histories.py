"""The paper's time histories, figures 2, 4 and 5, and what it says about them."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Annotated

import numpy as np
import pandas as pd

from analytic.response import Outcome
from engines.scene import free_rocking_window
from studies.cases.paper import HISTORIES, HistoryCase
from studies.kit.arguments import figures as some_figures
from studies.kit.arguments import sources_option
from studies.kit.jobs import Job, Question, Row, ask, summary
from studies.kit.say import capital, out_of
from studies.kit.study import Figures, Study, Tables, claim, stages
from studies.measures.history import samples

LINEAR = ("exact", "housner", "modified")
DRAWN = {2: ("exact", "rk4", "average-acceleration"), 4: LINEAR, 5: LINEAR}
"""What the paper draws; its numerical solution is the exact model's."""
WHICH = "Figures of the paper: 2 (two solvers), 4 (half-sine) and 5 (full-sine); all by default."
FIRST = "By default what the paper draws: "
SAMPLES = ["time_s", "ground_g", "theta_ratio", "velocity_rad_s"]
"""Columns of a figure's samples."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """Which figures, and whose lines."""

    figure: Annotated[tuple[int, ...], some_figures(WHICH, 2, 4, 5)] = (2, 4, 5)
    sources: Annotated[tuple[str, ...] | None, sources_option(FIRST, default=False)] = None


def jobs(_: tuple[str, ...], quick: bool, options: Options) -> list[Job]:
    """Return a job for each line in each panel."""
    return [
        _job(case, source)
        for number in options.figure
        for case in HISTORIES[number]
        for source in options.sources or DRAWN[number]
    ]


def _job(case: HistoryCase, source: str) -> Job:
    labels, window = asdict(case), free_rocking_window(case.block, case.motion)
    labels.pop("omega_rad_s")
    times = np.linspace(0.0, window, 1501)
    question = Question(system=case.block, motion=case.motion, duration=window, times=times)
    return Job(labels=labels, case=question, source=source)


def measure(job: Job) -> Row:
    """Return the summary, and the samples as lists; none of a response that has no history."""
    response, case = ask(job), job.case
    if response.history is None:
        return summary(response) | {name: [] for name in SAMPLES}
    drawn = samples(response, case.system, case.motion, {})
    return summary(response) | {name: drawn[name].tolist() for name in SAMPLES}


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the rows, the samples of each figure that has any, and the paper's statements."""
    tables, found = {"histories": rows.drop(columns=SAMPLES, errors="ignore")}, []
    for number, lines in rows.groupby("figure", sort=False):
        name, failed = f"figure-{number}", lines["outcome"] == Outcome.FAILED.value
        if not failed.all():
            hidden = ["peak_ratio", "impacts", "steps", "wall_s", "message"]
            drawn = lines[~failed].drop(columns=hidden, errors="ignore")
            drawn = drawn.explode(SAMPLES, ignore_index=True)
            tables[name] = drawn.astype(dict.fromkeys(SAMPLES, float))
        tested = tables.get(name, lines) if number == 2 else lines
        silent = tested["source"].isin(lines.loc[failed, "source"])
        found.append(FIGURES[name][1](tested[~silent]))
    return {**tables, "findings": pd.DataFrame(found)}


def finding(tables: Tables) -> str:
    """Say how many of the paper's statements about its histories hold."""
    tested = tables["findings"].dropna(subset="holds")
    if tested.empty:
        return "No statement was tested: --sources lacks what the paper compares."
    held = out_of(int(tested["holds"].eq(True).sum()), len(tested))
    return f"{capital(held)} statements of the paper about its time histories hold."


def shown(tables: Tables) -> Tables:
    """Return the paper's statements, and the largest rotation of each line."""
    peaks = tables["histories"][["figure", "panel", "source", "outcome", "peak_ratio"]]
    return {"The paper's statements": tables["findings"], "Largest rotations": peaks}


def figures(tables: Tables) -> Figures:
    """Draw each figure; where lines coincide, also what separates them."""
    from studies.drawing.figures import draw_histories

    return {
        name: draw_histories(tables[name], title, errors=name == "figure-2")
        for name, (title, _) in FIGURES.items()
        if name in tables
    }


@claim(
    "Runge–Kutta and average acceleration coincide (within 0.001 of θcr)",
    *("average-acceleration", "rk4"),
)
def solvers_coincide(table: pd.DataFrame) -> tuple[bool, str]:
    """Compare the samples of both solvers."""
    lines = table.pivot(index=["panel", "time_s"], columns="source", values="theta_ratio")
    apart = (lines["rk4"] - lines["average-acceleration"]).abs().groupby("panel").max()
    words = ", ".join(f"2-{panel} {value:.1e}" for panel, value in apart.items())
    return bool((apart < 1e-3).all()), f"largest difference of θ/θcr: {words}"


@claim(
    "Housner's error grows as H/B falls, and the modified linearization's stays smaller", *LINEAR
)
def housner_strays(rows: pd.DataFrame) -> tuple[bool, str]:
    """Compare the errors of both linearizations from panel to panel."""
    peaks = rows.pivot(index="panel", columns="source", values="peak_ratio")
    errors = peaks[["housner", "modified"]].div(peaks["exact"], axis=0) - 1.0
    far, near = errors["housner"].abs(), errors["modified"].abs()
    holds = bool((far.diff().iloc[1:] > 0.0).all() and (near < far).all())
    words = [f"{name} {', '.join(map('{:+.1%}'.format, errors[name]))}" for name in errors]
    return holds, f"error of the peak in 4-a, b, c (H/B 6, 3, 2): {'; '.join(words)}"


@claim("In 5-b and 5-c the block overturns by Housner alone, and survives otherwise", *LINEAR)
def housner_overturns(rows: pd.DataFrame) -> tuple[bool, str]:
    """Look at the outcomes in 5-b and 5-c."""
    table = rows.pivot(index="panel", columns="source", values="outcome")
    found = {panel: table.loc[panel, list(LINEAR)] for panel in ("b", "c")}
    holds = all(list(outcomes) == ["rocked", "overturned", "rocked"] for outcomes in found.values())
    words = {panel: (f"{name} {it}" for name, it in row.items()) for panel, row in found.items()}
    return holds, "; ".join(f"5-{panel}: {', '.join(text)}" for panel, text in words.items())


FIGURES = {
    "figure-2": ("Figure 2: fourth-order Runge–Kutta and average acceleration", solvers_coincide),
    "figure-4": ("Figure 4: half-sine pulse", housner_strays),
    "figure-5": ("Figure 5: full-sine pulse", housner_overturns),
}
"""Figure -> its title, and what the paper says about it."""

STUDY = Study(
    name="histories",
    question="Do the paper's statements about its time histories hold?",
    help="""The paper's time histories, figures 2, 4 and 5.

Tests what the paper says about them. Takes a few seconds. Writes histories.csv, findings.csv,
findings.txt, and a table and a picture for each figure.""",
    options=Options,
    captions={
        "figure": "Rotation against time: a line for each source, a panel for each case.",
        "figure-2": "Rotation against time, and below it the difference of each solver from the "
        "exact solution; a pair of panels for each pulse.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
