"""A comparison as records, and as JSON, an object a line."""

import json
import math
from collections.abc import Mapping, Sequence
from typing import Any

from studies.compare.rendering import valid
from studies.old.journal import Row

SHARED = ("source", "outcome", "peak_ratio", "impacts", "steps", "wall_s", "message")
BESIDE = ("error", "velocity_ratio", "impact_error")
CONDITIONED = ("kappa", "sensitivity")
ESTIMATED = ("estimate", "bound")
"""Columns of a comparison that its JSON has, the last where asked for; a number that is not finite
is null there."""


def as_lines(objects: Sequence[Mapping[str, Any]]) -> str:
    """Return one JSON object a line; a number that is not finite is null."""
    return "\n".join(
        json.dumps({k: _finite_or_null(v) for k, v in item.items()}, allow_nan=False)
        for item in objects
    )


def records(rows: list[Row], note: str = "") -> list[dict[str, Any]]:
    """Return what is told of each row, by name, with a note in each message.

    Parameters
    ----------
    rows : list of dict
        From `studies.compare.study.compare`.
    note : str, optional
        On the motion of the base.

    Returns
    -------
    list of dict
        The columns SHARED, BESIDE, CONDITIONED and ESTIMATED of a row, as far as it has them; what
        the exact solution needs, alike in all: min_normal, friction_needed and valid; and, where
        there are any, slips [m] and the observables of the scene.
    """
    objects: list[dict[str, Any]] = []
    for row in rows:
        exact = row["exact"]
        item = {
            name: row[name] for name in (*SHARED, *BESIDE, *CONDITIONED, *ESTIMATED) if name in row
        }
        item["message"] = "; ".join(words for words in (item["message"], note) if words)
        item |= {name: getattr(exact, name) for name in ("min_normal", "friction_needed")}
        response = row["response"]
        if response.slips:
            item["slips"] = list(response.slips)
        objects.append({**item, "valid": valid(exact), **response.observables})
    return objects


def _finite_or_null(value: Any) -> Any:
    return None if isinstance(value, float) and not math.isfinite(value) else value
