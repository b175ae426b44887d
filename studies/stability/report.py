"""What the study of extreme cases found: tables and figure, from its CSVs alone."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from analytic.response import Reason
from studies.cases.extreme import extremes
from studies.drawing.kept import Pictures, tell
from studies.kit.tables import table_in, write_table
from studies.measures.again import WORST_AGAIN, commands, with_commands, worst_again
from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.verdicts import ACCEPTED, Verdict
from studies.measures.words import NAMED, each_out_of, listed, out_of
from studies.sources.registry import resolve
from studies.stability.remedies import NOTHING
from studies.stability.sensitivity import with_growth

ORDER = tuple(verdict.value for verdict in Verdict)
LARGEST = (
    *("case", "source", "contact_s", "largest_stable", "largest_accurate"),
    *("stable_over_contact", "accurate_over_contact"),
)

UNBOUNDED = (Reason.DIVERGED, Reason.THROWN, Reason.FAULT)
"""Failures in which a response has no bound."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's tables; return the text, which findings.txt holds too."""
    matrix, steps, moved = (
        table_in(folder, name) for name in ("stability", "steps", "sensitivity")
    )
    moved = with_growth(moved)
    write_table(folder / "sensitivity.csv", moved)
    rests, rough = matrix["case"] == "60 s at rest", matrix["case"] == "friction 1e9"
    tables = {
        "Verdicts on the extreme cases": verdicts(matrix),
        "Independent integrators beside the exact solution, which all are held against": (
            peers(matrix)
        ),
        "Failures, those without a bound, and those that another setting mends": mended(matrix),
        "Failures, and the first setting that avoids each": (
            failures(matrix)[["case", "source", "reason", "remedy"]]
        ),
        WORST_AGAIN: worst_again(again(folder)),
        "Cases for which the reference itself does not hold": (
            matrix.loc[matrix["verdict"] == Verdict.INVALID.value, ["case", "invalid"]]
        ).drop_duplicates("case"),
        "Friction that a library takes instead of 1e9": (
            matrix.loc[rough & (matrix["friction"] < 1e9), ["source", "friction"]]
        ),
        "Creep of a block that shakes without rocking, then rests for 60 s, over its width": (
            matrix.loc[rests, ["source", "slip_widths"]].dropna()
        ),
        "Largest stable and accurate step, p dt, and over the contact's own time": (
            steps.reindex(columns=LARGEST).dropna(how="all")
        ),
        "Change of the peak by a perturbation over that of the exact solution, in the median": (
            growth(moved)
        ),
    }
    return tell(folder, pictures(folder), first_claim(matrix), tables)


def again(folder: Path) -> pd.DataFrame:
    """Return the failures, those that nothing mends first, with the commands that ask them."""
    wrong = failures(table_in(folder, "stability"))
    wrong = wrong.sort_values("remedy", key=lambda said: said != NOTHING, kind="stable")
    cases, asked = {case.name: case for case in extremes(False)}, []
    for name, source, outcome in wrong[["case", "source", "outcome"]].itertuples(index=False):
        case = cases[name]
        job = (case.block, case.motion, source, case.options(source))
        asked.append(commands(*job, duration=case.duration, outcome=outcome))
    return with_commands(wrong[["case", "source", "reason", "remedy"]], asked)


def headline(folder: Path) -> str:
    """Return how many of the extreme cases the engines get right."""
    return first_claim(table_in(folder, "stability"))


def pictures(folder: Path) -> Pictures:
    """Draw the matrix of a folder from its stability.csv alone."""
    from studies.stability.figure import draw_matrix

    return {"stability": draw_matrix(table_in(folder, "stability"))}


def verdicts(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return how often each source met each verdict."""
    counts = pd.crosstab(matrix["source"], matrix["verdict"])
    columns = [word for word in ORDER if word in counts]
    return counts.loc[list(matrix["source"].unique()), columns].reset_index()


def peers(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return how often each independent integrator of the equation has the exact outcome.

    And how far its peaks are from the exact ones at most, over θcr.
    """
    asked = matrix[matrix["source"].map(lambda source: resolve(source).kind == "peer")]
    off = (asked["peak_ratio"] - asked["exact_peak"]).where(asked["error"].notna()).abs()
    marked = asked.assign(same=asked["outcome"] == asked["exact_outcome"], off=off)
    each = marked.groupby("source", sort=False)
    return each.agg(runs=("same", "size"), same=("same", "sum"), off=("off", "max")).reset_index()


def mended(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return by verdict how many failures there are, of which some have no bound or a remedy."""
    wrong = failures(matrix)
    wrong = wrong.assign(
        unbounded=wrong["failure"].isin([reason.name for reason in UNBOUNDED]),
        mended=~wrong["remedy"].isin(["", NOTHING]),
    )
    counts = {"failures": ("case", "size"), "unbounded": ("unbounded", "sum")}
    each = wrong.groupby("verdict", sort=False)
    return each.agg(**counts, mended=("mended", "sum")).reset_index()


def growth(moved: pd.DataFrame) -> pd.DataFrame:
    """Return the median growth over κ for each source, perturbed quantity and its size."""
    up = moved[moved["delta"] > 0.0]
    medians = up.groupby(["quantity", "source", "delta"], sort=False)["change_over_exact"].median()
    table = medians.unstack("delta")
    table.columns = [f"{delta:.0e}" for delta in table.columns]
    return table.reset_index()


def first_claim(matrix: pd.DataFrame) -> str:
    """Say how many of the extreme cases each preset gets right, of how many engines and cases.

    Cases beyond what the reference is valid for are in no count.
    """
    valid = matrix["verdict"] != Verdict.INVALID.value
    asked = matrix[matrix["source"].map(is_engine) & valid]
    if asked.empty:
        return "No engine was put to the extreme cases."
    right = (asked["verdict"] == Verdict.GOOD.value).groupby(asked["source"], sort=False)
    counts: dict[str, list[tuple[int, int]]] = {}
    for source, good in right:
        counts.setdefault(preset_of(str(source)), []).append((int(good.sum()), len(good)))
    engines = list(dict.fromkeys(map(engine_of, asked["source"])))
    named = listed(engines) if len(engines) <= NAMED else f"{len(engines)} engines"
    verb = "get" if len(engines) > 1 else "gets"
    parts = [
        f"{in_words(name)} {_counted(counts[name], len(engines))}" for name in in_order(counts)
    ]
    return f"Of extreme cases {named} {verb} right: {', '.join(parts)}."


def _counted(pairs: list[tuple[int, int]], engines: int) -> str:
    """Return how many are right of how many, of each engine or of all; and of how many engines."""
    right, total = zip(*pairs, strict=True)
    if len(pairs) <= NAMED:
        return each_out_of(right, total)
    few = f" ({len(pairs)} engines)" if len(pairs) < engines else ""
    return f"{out_of(sum(right), sum(total))}{few}"


def failures(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is a failure of their source."""
    return matrix[~matrix["verdict"].isin([verdict.value for verdict in ACCEPTED])]
