"""What the study of extreme cases found, in a sentence made from its table."""

from __future__ import annotations

import pandas as pd

from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.verdicts import ACCEPTED, Verdict
from studies.measures.words import NAMED, each_out_of, listed, out_of


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
