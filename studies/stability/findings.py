"""What the study of extreme cases found, in a paragraph made from its tables."""

from __future__ import annotations

import pandas as pd

from analytic.response import Reason
from studies.measures.differences import scientific
from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.verdicts import ACCEPTED, Verdict
from studies.measures.words import NAMED, each_out_of, listed, out_of
from studies.sources.registry import resolve
from studies.stability.remedies import NOTHING

UNBOUNDED = (Reason.DIVERGED, Reason.THROWN, Reason.FAULT)
"""Failures in which a response has no bound."""

REFERENCE = "exact"
"""The source that all others are held against."""

ACCEPTED_WORDS = tuple(verdict.value for verdict in ACCEPTED)


def findings(matrix: pd.DataFrame) -> str:
    """Return in a few sentences what the tables do not show by themselves."""
    return " ".join([*_on_verdicts(matrix), *_on_limits(matrix), *_on_reference(matrix)])


def first_claim(matrix: pd.DataFrame) -> str:
    """Say how many of the extreme cases each preset gets right, of how many engines and cases.

    Cases beyond what the reference is valid for are in no count.
    """
    asked = _asked(matrix)
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


def _asked(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of engines on cases for which the reference is valid."""
    valid = matrix["verdict"] != Verdict.INVALID.value
    return matrix[matrix["source"].map(is_engine) & valid]


def _counted(pairs: list[tuple[int, int]], engines: int) -> str:
    """Return how many are right of how many, of each engine or of all; and of how many engines."""
    right, total = zip(*pairs, strict=True)
    if len(pairs) <= NAMED:
        return each_out_of(right, total)
    few = f" ({len(pairs)} engines)" if len(pairs) < engines else ""
    return f"{out_of(sum(right), sum(total))}{few}"


def _on_reference(matrix: pd.DataFrame) -> list[str]:
    """Say how the exact solution stands beside the independent integrators of the same equation.

    It is what all others are held against, so that its own verdicts say nothing.
    """
    peers = matrix[matrix["source"].map(lambda source: resolve(source).kind == "peer")]
    if peers.empty:
        return []
    same = int((peers["outcome"] == peers["exact_outcome"]).sum())
    apart = (peers["peak_ratio"] - peers["exact_peak"]).where(peers["error"].notna()).abs().max()
    return [
        "The exact solution is what the others are held against; beside it the independent "
        f"integrators {listed(list(peers['source'].unique()))} have the same outcome in "
        f"{out_of(same, len(peers))} runs, and peaks within {scientific(float(apart))} of θcr."
    ]


def _on_verdicts(matrix: pd.DataFrame) -> list[str]:
    wrong = failures(matrix)
    tried = wrong[wrong["remedy"] != ""]
    remedied = tried[tried["remedy"] != NOTHING]
    void = matrix[(matrix["invalid"] != "") & (matrix["verdict"] == "invalid")]
    unbounded = int(wrong["failure"].isin([reason.name for reason in UNBOUNDED]).sum())
    return [
        f"Answers that are not finite, throw the block away, or that the engine itself calls "
        f"faulty: {unbounded}; in which energy grows "
        f"in free rocking: {int((wrong['verdict'] == 'energy').sum())}.",
        f"Another setting mends {len(remedied)} of {len(wrong)} failures.",
        f"In {void['case'].nunique()} cases an engine differs where the reference itself does not "
        f"hold ({'; '.join(void['case'].unique())}).",
    ]


def _on_limits(matrix: pd.DataFrame) -> list[str]:
    """Say where an engine did not get what was asked for, and how far a block crept."""
    sentences = []
    clamped = matrix[(matrix["case"] == "friction 1e9") & (matrix["friction"] < 1e9)]
    if len(clamped):
        sources = ", ".join(clamped["source"])
        sentences.append(
            f"Friction of 1e9 is friction of {clamped['friction'].max():g} in {sources}, the most "
            "that the library takes."
        )
    crept = matrix[(matrix["case"] == "60 s at rest") & matrix["slip_widths"].notna()]
    if len(crept):
        pairs = zip(crept["source"], crept["slip_widths"], strict=True)
        words = ", ".join(f"{source} {slip:.1e} B" for source, slip in pairs)
        sentences.append(f"A block that shakes without rocking and rests for 60 s creeps: {words}.")
    return sentences


def failures(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is a failure of their source."""
    return matrix[~matrix["verdict"].isin(ACCEPTED_WORDS)]
