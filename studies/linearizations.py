"""What in a linearization errs: its onset, its frequency or its saddle, each changed alone."""

from __future__ import annotations

from functools import cache
from itertools import product

import numpy as np
import pandas as pd

from analytic import RigidBlock, SinePulse, peak_ratios
from analytic.models import Model
from studies.cases.paper import PULSES, sweep_cases
from studies.kit.jobs import Job, Question, Row
from studies.kit.say import out_of, part
from studies.kit.study import Figures, Finding, Study, Tables, stages
from studies.measures.differences import posed_cases
from studies.measures.wrongness import wrong_in

NAMED = {"000": "housner", "100": "onset-matched", "111": "modified"}
"""Which of onset, frequency and saddle are changed from Housner's -> the model's name."""
CHANGES = {
    "100": "onset: with g tan α instead of g α",
    "010": "frequency: with p√cos α instead of p",
    "001": "saddle: with tan α instead of α",
}
"""The one that is changed, and how, in words."""
GRIDS = ("paper", "wide")
WRONG = ["wrong", "false", "missed"]
ERRORS = ["median_error", "max_error"]


def variant(changed: str) -> Model:
    """Return the linear model with Housner's or (a 1) the modified onset, frequency and saddle."""
    onset, frequency, saddle = (digit == "1" for digit in changed)
    words = f"onset g {'tan ' * onset}α, p{'√cos α' * frequency}, saddle {'tan ' * saddle}α"
    known = NAMED.get(changed, "")
    lifts, falls = (np.tan if tangent else np.positive for tangent in (onset, saddle))
    return Model(
        name=known or words,
        title=f"{words} ({known})" if known else words,
        linear=True,
        saddle=falls,
        frequency=lambda alpha: np.sqrt(np.cos(alpha)) if frequency else np.ones_like(alpha),
        forcing=lambda alpha: falls(alpha) / lifts(alpha),
    )


VARIANTS = {word: variant(word) for word in map("".join, product("01", repeat=3))}
"""Changes from Housner's, as of NAMED -> the model: all eight."""


@cache
def grid(name: str) -> pd.DataFrame:
    """Return the cases of a grid, and the exact solution's peaks and outcomes."""
    if name == "paper":
        cases = [c for c in sweep_cases([6, 7, 8, 9]) if c.width_m == 0.5]
        rows = [(c.aspect, c.amplitude_g, c.omega_over_p, PULSES[c.pulse]) for c in cases]
    else:
        aspects, onsets = np.geomspace(1.5, 10.0, 12), np.geomspace(1.02, 4.0, 30)
        posed = product(aspects, onsets, np.linspace(0.2, 8.0, 40), PULSES.values())
        rows = [(aspect, onset / aspect, omega, cycles) for aspect, onset, omega, cycles in posed]
    columns = ["aspect", "amplitude_g", "omega_over_p", "half_cycles"]
    found = pd.DataFrame(rows, columns=columns)
    peak, outcome = peak_ratios(*posed_cases(found))
    return found.assign(exact_peak=peak, exact_outcome=[it.value for it in outcome])


def jobs(_: tuple[str, ...], quick: bool) -> list[Job]:
    """Return a job for each grid and variant; its question stands for all cases of the grid."""
    block = RigidBlock(width=0.5, height=1.5)
    question = Question(system=block, motion=SinePulse.in_g(0.4, omega=block.p))
    return [
        Job(labels={"grid": name, "changed": changed}, case=question, source="exact")
        for name, changed in product(GRIDS, VARIANTS)
    ]


def measure(job: Job) -> Row:
    """Return the line of a variant on a grid, and that of each H/B."""
    errors = errors_on(job.labels["grid"], job.labels["changed"])
    by_aspect = [{"aspect": aspect, **line(rows)} for aspect, rows in errors.groupby("aspect")]
    return {"outcome": "compared", "message": "", **line(errors), "by_aspect": by_aspect}


def errors_on(name: str, changed: str) -> pd.DataFrame:
    """Return every case of a grid with what a variant differs by from the exact solution."""
    cases = grid(name)
    peak, outcome = peak_ratios(*posed_cases(cases), model=VARIANTS[changed])
    exact = cases["exact_peak"].to_numpy()
    both = np.isfinite(peak) & np.isfinite(exact) & (exact > 0.0) & (peak > 0.0)
    found = cases.assign(outcome=[it.value for it in outcome], peak_ratio=peak)
    return cases.assign(
        error=np.where(both, peak, np.nan) / np.where(both, exact, np.nan) - 1.0,
        false=np.isinf(peak) & ~np.isinf(exact),
        missed=~np.isinf(peak) & np.isinf(exact),
        wrong=wrong_in(found) != "",
    )


def line(errors: pd.DataFrame) -> Row:
    """Return what some cases have in common; errors are relative."""
    error, wrong = errors["error"].abs(), {name: int(errors[name].sum()) for name in WRONG}
    sizes = {"median_error": float(error.median()), "max_error": float(error.max())}
    return {"cases": len(errors), **wrong, "survivors": int(error.count()), **sizes}


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return a line for each grid and variant, the same by H/B, and the conclusion."""
    lines = rows.drop(columns=["source", "outcome", "message", "by_aspect"])
    slender = rows[["grid", "changed", "by_aspect"]].explode("by_aspect", ignore_index=True)
    by_aspect = slender[["grid", "changed"]].join(pd.DataFrame(slender["by_aspect"].tolist()))
    return {
        "linearizations": lines.assign(title=[VARIANTS[word].title for word in lines["changed"]]),
        "slenderness": by_aspect,
        "findings": pd.DataFrame([conclusion(lines)]),
    }


def finding(tables: Tables) -> str:
    """Say which of the three changes, made alone, brings Housner's linearization closest."""
    medians = tables["linearizations"].query("grid == 'paper'").set_index("changed")["median_error"]
    best = str(medians[list(CHANGES)].idxmin())
    return (
        f"Housner's linearization errs most in its {CHANGES[best]} its median error falls from "
        f"{part(medians['000'])} to {part(medians[best])} on the paper's cases."
    )


def shown(tables: Tables) -> Tables:
    """Return the paper's conclusion, and a line for each variant."""
    lines = tables["linearizations"][["grid", "title", "cases", *WRONG, *ERRORS]]
    return {"What the paper concludes": tables["findings"], "On each grid": lines}


def figures(tables: Tables) -> Figures:
    """Draw the median errors over the slenderness."""
    from studies.drawing.figures import draw_errors

    titles = {word: model.title for word, model in VARIANTS.items()}
    return {"linearizations": draw_errors(tables["slenderness"], titles)}


def conclusion(lines: pd.DataFrame) -> Finding:
    """Test what the paper concludes of the frequency, on the lines of each grid."""
    medians = lines.set_index(["grid", "changed"])["median_error"]
    closer = [
        medians[name, f"{onset}1{saddle}"] < medians[name, f"{onset}0{saddle}"]
        for name, onset, saddle in product(GRIDS, "01", "01")
    ]
    return Finding(
        "p√cos α in place of p brings a linearization closer, other things being equal",
        all(closer),
        f"the median error falls in {out_of(sum(closer), len(closer))} comparisons",
    )


STUDY = Study(
    name="linearizations",
    question="Which part of a linearization errs most: onset, frequency or saddle?",
    help="""The error of a linearization's parts: onset, frequency and saddle, each changed alone.

Compares all eight combinations of Housner's and the modified choices with the exact solution, on
the paper's cases and on a wider grid. Takes half a minute. Writes linearizations.csv,
slenderness.csv, findings.csv, findings.txt and a picture.""",
    texts=("changed",),
    captions={
        "linearizations": "Median error of the peak against H/B, for eight linearizations on two "
        "grids; colours stand for the onset, dashes for the frequency.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
