"""Random cases that no setting was tuned on: sources beside the exact solution, κ among it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from itertools import islice
from pathlib import Path
from textwrap import fill
from typing import Annotated

import pandas as pd

from studies.cases.drawn import draw
from studies.drawing.kept import Pictures, keep
from studies.kit import provenance
from studies.kit.arguments import Count, Out, check_sources
from studies.kit.jobs import Job
from studies.kit.journal import Row
from studies.kit.naming import several_sources
from studies.kit.options import DEFAULT_RUNNING, OWN_EFFORT, EffortOptions, Running
from studies.kit.plan import Plan, by_label, carry_out
from studies.kit.tables import write_table
from studies.measures.differences import (
    WELL_CONDITIONED,
    scientific,
    sensitivity_of,
    with_reference,
)
from studies.measures.halving import ELSEWHERE
from studies.measures.wrongness import WORDS, counted, wrong_in
from studies.sources.groups import core_sources
from studies.sources.registry import Effort
from studies.validate import STUDY
from studies.validate.bands import bands, bands_text
from studies.validate.bounds import HALVES, bounds_text, half_jobs, with_bounds
from studies.validate.claims import census, drawn_text, first_claim
from studies.validate.hints import CALM, HINTED, hint_jobs, leanings, leanings_text


def command(
    *,
    out: Out,
    cases: Count = 500,
    seed: Count = 1,
    sources: Annotated[tuple[str, ...], several_sources] = core_sources(),
    effort: EffortOptions = OWN_EFFORT,
    estimate: bool = False,
    running: Running = DEFAULT_RUNNING,
    yes: bool = False,
) -> int:
    """Hold the sources against the exact solution on random cases.

    The first cases are asked of engines whose steps land on impacts with false hints, too: about
    when an uplift is to be expected, about which corner, and how fast the block falls.

    Parameters
    ----------
    cases
        Number of random cases.
    seed
        Seed of the random numbers, a positive whole number; another one draws other cases.
    sources
        Who is asked.
    estimate
        Run every engine at half the step, too: the relative difference of the two peaks, and how
        many of the errors it bounds, times the published factor (`rocking estimate`).
    yes
        Begin even what takes longer than a day.
    """
    check_sources(sources)
    # the exact solution is asked, too, whether a case is kept
    everyone = ("exact", *(3 if estimate else 1) * sources)
    running.refuse_too_much(f"--cases is {cases}", cases, everyone, yes=yes, effort=effort)
    asked = plan(cases, seed, sources, effort, estimate=estimate)
    return carry_out(STUDY, asked, out, running, report)


def plan(
    cases: int,
    seed: int,
    sources: Sequence[str],
    effort: Effort = OWN_EFFORT,
    *,
    estimate: bool = False,
) -> Plan:
    """Return the plan that puts random cases to some sources, the first with false hints too.

    With `estimate` all of them are asked at half the step, too.
    """
    drawn = list(islice(draw(seed), cases))
    jobs = [
        Job(
            labels={"table": STUDY.name, **asdict(case)},
            block=case.block,
            motion=case.motion,
            source=source,
            options=effort.options(source),
        )
        for case in drawn
        for source in sources
    ]
    finer = half_jobs(jobs) if estimate else []
    return Plan(
        jobs=[*jobs, *hint_jobs(drawn[:HINTED], sources, effort), *finer],
        settings={"seed": seed, **asdict(effort)},
        growing={"case": range(cases), "source": sources},
        tabulate=by_label("table"),
        needed=without_hints,
    )


def without_hints(rows: Sequence[Row]) -> list[Row]:
    """Return the rows of validate.csv: what becomes of a false hint is an answer.

    A run at half the step that failed leaves a row without an estimate.
    """
    return [row for row in rows if row["table"] == STUDY.name]


def report(folder: Path) -> str:
    """Hold a folder's tables against the exact solution; write four more, return the text.

    errors.csv has, for each row of validate.csv, the exact peak and outcome, the error, κ and the
    sensitivity, and where halves.csv is there the estimate of the error and its bound;
    bands.csv has the errors in bands of peak and κ; leaning.csv has a row for each source and
    hint, where hints.csv is there; drawn.csv says how many cases were drawn, kept and left out,
    and what share of each overturns.
    """
    compared = compare(folder, "validate")
    if halves := (folder / f"{HALVES}.csv").exists():
        compared = with_bounds(compared, compare(folder, HALVES))
    write_table(folder / "errors.csv", compared)
    seed = provenance.record_of(folder)["settings"]["seed"]
    write_table(folder / "drawn.csv", census(seed, compared["case"].nunique()))
    judged, by_band = sensitivity_of(compared), bands(compared)
    write_table(folder / "bands.csv", by_band)
    calm = compared[judged < WELL_CONDITIONED]
    text = "\n".join(
        [
            "Relative error of the peak over cases that survive both, outcomes right:",
            summary_text(compared),
            "\nMedian and largest of them in bands of the exact peak over θcr, and of κ, which is",
            "the larger of |∂ln θmax/∂ln a_p| and |∂ln θmax/∂ln η|:",
            bands_text(by_band),
            f"\nThe same where S is below {WELL_CONDITIONED:g}, the larger of κ and of the change",
            "of the peak over that of a_p or η when one of these moves by ±1e-4 or ±1e-6:",
            summary_text(calm),
            "\nError over S, the relative error of the pulse or of the impact that does as much:",
            summary_text(compared.assign(error=compared["error"] / judged)),
            "\nThe largest errors:",
            worst_text(compared),
            *leaning_lines(folder, compared),
            *(bounds_lines(folder, compared) if halves else ()),
            "",
            fill(drawn_text(pd.read_csv(folder / "drawn.csv")), 99),
        ]
    )
    return keep(folder, pictures(folder), text)


def compare(folder: Path, table: str) -> pd.DataFrame:
    """Read a table back, and hold it against the exact solution."""
    return with_reference(pd.read_csv(folder / f"{table}.csv", dtype={"message": str}))


def leaning_lines(folder: Path, compared: pd.DataFrame) -> list[str]:
    """Write leaning.csv, and return what it says; nothing where no source was given hints."""
    if not (folder / "hints.csv").exists():
        return []
    table = pd.DataFrame(map(asdict, leanings(compared, compare(folder, "hints"))))
    write_table(folder / "leaning.csv", table)
    cases = table["cases"].max()
    return [
        f"\nWhat landing steps lean on: the first {cases} cases with hints that are false,",
        f"and again at {CALM:g} of what lifts the block, where it must stay:",
        leanings_text(table),
    ]


def bounds_lines(folder: Path, compared: pd.DataFrame) -> list[str]:
    """Say what the estimates bound, and if their factors were found at other steps."""
    settings = provenance.record_of(folder)["settings"]
    own = Effort(step=settings["step"], accuracy=settings["accuracy"]).own
    text = "\nOf the errors of the peak the relative difference from that at half the step,"
    return [text, bounds_text(compared), *(() if own else (f"({ELSEWHERE})",))]


def pictures(folder: Path) -> Pictures:
    """Draw the errors of a folder against what they are judged by, from its errors.csv alone."""
    from studies.validate.figure import draw_conditioning

    return {"validate": draw_conditioning(pd.read_csv(folder / "errors.csv"))}


def headline(folder: Path) -> str:
    """Say how many outcomes each source gets right, and its largest errors."""
    return first_claim(pd.read_csv(folder / "errors.csv"))


def summary_text(compared: pd.DataFrame) -> str:
    """Return outcomes and quantiles of the error of each source as an aligned table."""
    lines = []
    for source, group in compared.groupby("source", sort=False):
        errors = group["error"].abs().dropna()
        quantiles = [float(errors.quantile(q)) for q in (0.5, 0.9, 0.99, 1.0)]
        right = f"{int(group['agrees'].sum())}/{len(group)}"
        wrong = counted(wrong_in(group)).values()
        lines.append([source, right, *wrong, *(scientific(value) for value in quantiles)])
    if not lines:
        return "no such case"
    columns = ["source", "outcomes", *WORDS.values(), "median", "p90", "p99", "max"]
    return pd.DataFrame(lines, columns=columns).to_string(index=False)


def worst_text(compared: pd.DataFrame, count: int = 5) -> str:
    """Return the cases in which each source errs most, and those of which it gets wrong."""
    erring = compared.assign(size=compared["error"].abs().where(compared["agrees"], math.inf))
    worst = erring.sort_values("size", ascending=False).groupby("source", sort=False).head(count)
    shown = worst.sort_values(["source", "size"], ascending=[True, False]).assign(
        error=worst["error"].map(scientific),
        aspect=worst["aspect"].map("{:.2f}".format),
        width_m=worst["width_m"].map("{:.3g}".format),
        amplitude=(worst["amplitude_g"] * worst["aspect"]).map("{:.3f}".format),
        omega_over_p=worst["omega_over_p"].map("{:.3f}".format),
        exact_peak=worst["exact_peak"].map("{:.3g}".format),
        kappa=worst["kappa"].map("{:.3g}".format),
        kappa_eta=worst["kappa_eta"].map("{:.3g}".format),
        sensitivity=worst["sensitivity"].map("{:.3g}".format),
    )
    names = {
        "source": "source",
        "case": "case",
        "aspect": "H/B",
        "width_m": "B m",
        "half_cycles": "n",
        "amplitude": "a/onset",
        "omega_over_p": "ω/p",
        "outcome": "outcome",
        "exact_outcome": "exact",
        "exact_peak": "peak",
        "error": "error",
        "kappa": "κ",
        "kappa_eta": "κη",
        "sensitivity": "sensitivity",
    }
    return shown[list(names)].rename(columns=names).to_string(index=False)
