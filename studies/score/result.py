"""A score as JSON to keep, what is required of it, and what moved since an earlier one."""

from __future__ import annotations

import json
import math
import platform
from importlib.metadata import packages_distributions
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pandas as pd

from analytic.accelerograms.text import finite_number
from analytic.response import Outcome
from engines.declaration import Engine
from studies.old import provenance
from studies.old.arguments import BadInputError
from studies.old.refusing import one_line
from studies.old.tables import in_columns
from studies.measures.presets import preset_of
from studies.measures.verdicts import Verdict
from studies.score.report import swept, table_of

SCHEMA = 1
"""Version of the form that `result_of` gives a result."""
NOISE = 1e-6
"""Relative change of a peak up to which two results are the same."""
CASE = ("figure", "pulse", "excess_g", "aspect", "width_m", "omega_over_p")
"""Columns that make the name of one of the paper's cases."""
LEAST = {"agree": "outcomes", "extreme": "extreme"}
MOST = {"median_error": "median", "p90_error": "p90", "max_error": "max", "no_answer": "failed"}
"""Column of a table -> what may be required of it, at least or at most."""
MEASURES = (*LEAST.values(), *MOST.values())


class Requirement(NamedTuple):
    """What one of MEASURES must reach of a preset if it is of LEAST, and else may reach.

    The bound is a number of cases, or a relative error of the peak.
    """

    preset: str
    measure: str
    bound: float

    def judged(self, result: dict[str, Any]) -> tuple[bool, str]:
        """Return whether a result holds it, and a line of what was required and what came out."""
        found = result["presets"][self.preset][self.measure]
        value, least = math.nan if found is None else found, self.measure in LEAST.values()
        holds = value >= self.bound if least else value <= self.bound
        side = f"at {'least' if least else 'most'} {self.bound:g}, and is {value:.6g}"
        verdict = "holds" if holds else "falls short"
        return holds, f"{verdict}: {self.preset}:{self.measure} must be {side}"


def required(text: str, engine: Engine) -> Requirement:
    """Read a requirement: MEASURE=NUMBER or PRESET:MEASURE=NUMBER.

    Parameters
    ----------
    text : str
        The measure is one of MEASURES, the number finite and at least 0.
    engine : Engine
        Its best preset is meant where none is named.

    Raises
    ------
    BadInputError
        If it is none.
    """
    name, _, number = text.partition("=")
    preset, colon, measure = name.rpartition(":")
    presets = [use.name for use in engine.presets]
    try:
        bound = finite_number(number)
    except ValueError:
        bound = math.nan
    known = measure in MEASURES and preset in (presets if colon else [""])
    if not (known and 0.0 <= bound < math.inf):
        raise BadInputError(
            f"--require is {text!r}; it must be one of {', '.join(MEASURES)}, then = and a number, "
            f"0 or more; {' or '.join(presets)} and a colon may stand before it"
        )
    return Requirement(preset or engine.best.name, measure, bound)


def result_of(folder: Path, engine: Engine) -> dict[str, Any]:
    """Return the result of a folder's tables, as JSON knows it.

    Parameters
    ----------
    folder : Path
        With the tables of a score.
    engine : Engine
        The one that was scored.

    Returns
    -------
    dict
        schema, engine and versions, of packages by name. presets: for each its `MEASURES`, an error
        being None where no peak survives, and how many cases and extremes these are of. peaks: for
        each preset and case that of a block which rocked, over its critical rotation, or what
        became of another; a case is called by its `CASE` with slashes between, or extreme/NAME.
        moments: for each preset the one declared and the one measured, in steps.

    Raises
    ------
    FileNotFoundError
        If a table is missing.
    """
    cases, extremes, moments = (table_of(folder, name) for name in ("sweep", "extremes", "moments"))
    names = ["/".join(map(str, case)) for case in cases[list(CASE)].itertuples(index=False)]
    named = "extreme/" + extremes["case"]
    rows = pd.concat([cases.assign(case=names), extremes.assign(case=named)])
    rocked = (rows["outcome"] == Outcome.ROCKED.value) & np.isfinite(rows["peak_ratio"])
    rows["peak"] = rows["peak_ratio"].astype(object).where(rocked, rows["outcome"])
    valid = extremes[extremes["verdict"] != Verdict.INVALID.value]
    good = (valid["verdict"] == Verdict.GOOD.value).groupby(valid["source"])
    lines = swept(folder).set_index("source").join(good.agg(extreme="sum", extremes="count"))
    lines = lines.rename(columns=LEAST | MOST)
    packages = engine.packages or packages_distributions().get(engine.library, ())
    return {
        "schema": SCHEMA,
        "engine": engine.name,
        "versions": {
            "rocking": provenance.project_version(),
            "python": platform.python_version(),
            **{name: provenance.version_of(name) for name in packages},
        },
        "presets": by_preset(lines[["cases", "extremes", *MEASURES]]),
        "peaks": {
            preset_of(str(source)): dict(zip(group["case"], group["peak"], strict=True))
            for source, group in rows.groupby("source", sort=False)
        },
        "moments": by_preset(moments.set_index("source")[["declared", "measured"]]),
    }


def by_preset(table: pd.DataFrame) -> dict[Any, dict[Any, Any]]:
    """Return the lines of a table of sources by their presets, None where a number is missing."""
    numbers = table.rename(index=preset_of).astype(object)
    return numbers.where(numbers.notna(), None).to_dict("index")


def read(path: Path, engine: Engine) -> dict[str, Any]:
    """Read an engine's result back.

    Parameters
    ----------
    path : Path
        What --json wrote.
    engine : Engine

    Returns
    -------
    dict
        As of `result_of`.

    Raises
    ------
    BadInputError
        If it is none, of another engine or of another schema.
    """
    try:
        if not path.is_file():  # a pipe would be waited for
            raise OSError("it is no file")
        found = json.loads(path.read_text(encoding="utf-8"))
        if found["schema"] != SCHEMA or found["engine"] != engine.name:
            raise ValueError(f"its schema is {found['schema']}, its engine {found['engine']}")
        parts = (*found["peaks"].values(), found["versions"])
        values = [value for part in parts for value in part.values()]
        if not all(isinstance(value, float | str) for value in values):
            raise ValueError("it holds something else")
    except (OSError, ValueError, LookupError, TypeError, AttributeError, RecursionError) as error:
        raise BadInputError(
            f"--against is {str(path)!r}; it must be what --json wrote of {engine.name} by schema "
            f"{SCHEMA} ({one_line(error)})"
        ) from error
    return dict(found)


def since(then: dict[str, Any], now: dict[str, Any]) -> str:
    """Say what moved between two results, of the answers that are in both.

    Parameters
    ----------
    then, now : dict
        As of `result_of`, the earlier one first.

    Returns
    -------
    str
        A sentence; below it a table of other outcomes, and one of the peaks that moved by more than
        NOISE, the most first, where there are any.
    """
    answers = [pd.DataFrame(result["peaks"]).unstack().dropna() for result in (then, now)]
    both = pd.concat(answers, axis=1, join="inner", keys=["then", "now"])
    table = both.rename_axis(["preset", "case"]).reset_index()
    before, after = (pd.to_numeric(table[name], errors="coerce") for name in ("then", "now"))
    table["change"] = after / before - 1.0
    other = table[table["change"].isna() & (table["then"] != table["now"])]
    moved = table[table["change"].abs() > NOISE].sort_values("change", key=abs, ascending=False)
    versions = ", ".join(f"{name} {version}" for name, version in then["versions"].items())
    said = f"Since {versions}: of {len(table)} answers {len(other)} have another outcome, and "
    said += f"{len(moved)} peaks moved by more than {NOISE:g} of themselves."
    shown = [other.drop(columns="change"), moved]
    return "\n\n".join([said, *(in_columns(part) for part in shown if len(part))])
