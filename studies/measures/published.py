"""One full run of every study, as this project keeps it."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from engines import ENGINES
from studies.cases.paper import sweep_cases
from studies.measures.costs import joint
from studies.measures.presets import uses_of
from studies.sources.registry import resolve

PUBLISHED = Path(__file__).parents[1] / "published"
"""The folder of the published tables, one folder inside for each chapter."""
COLUMNS = Path(__file__).with_name("columns.csv")
"""The type, unit ("-" without one) and meaning of each column, in all tables or in a named one."""


def columns() -> dict[Any, list[str]]:
    """Return what COLUMNS says of a column, by table (empty: any) and name."""
    lines = pd.read_csv(COLUMNS, keep_default_na=False).set_index(["table", "column"])
    return dict(zip(lines.index, lines.to_numpy().tolist(), strict=True))


def dictionary(published: Path) -> pd.DataFrame:
    """Return a line for each column of every published table: its type, unit and meaning."""
    known = columns()
    lines = [
        (f"{path.parent.name}/{path.name}", name, *(known.get((table, name)) or known["", name]))
        for path in sorted(published.glob("*/*.csv*"))
        for table in [f"{path.parent.name}/{path.name.partition('.')[0]}"]
        for name in map(str, pd.read_csv(path, nrows=0))
    ]
    return pd.DataFrame(lines, columns=["table", "column", "type", "unit", "meaning"])


LADDER = "precision/work-precision.csv"
"""Errors and times of methods along their steps."""
PAPER = ("sweep/summary.csv", "presets/summary.csv")
"""The paper's cases, with each preset as it is declared."""
TARGETS = (0.1, 1e-2, 1e-3, 1e-4)
"""Errors that somebody may want to keep."""
SETTING = ["engine", "preset", "value"]
"""Columns that tell one setting from another; value is p dt, or an engine's own accuracy."""


def settings(published: Path, engines: Sequence[str]) -> pd.DataFrame:
    """Return a line for each published setting of some engines, from coarse to fine in a preset."""
    # SETTING has a value of nan where the library's step is in seconds; max_error is inf where a
    # case failed or an outcome is wrong
    found = pd.concat([along_steps(published, engines), _of_paper(published, engines)])
    # where both tables know a setting, the ladder's time is the best of several
    first = dict.fromkeys(("wall_s", "runs"), "first")
    lines = found.groupby(SETTING, sort=False, dropna=False, as_index=False).agg(
        {**first, "cases": "sum", "max_error": "max"}
    )
    uses = [ENGINES[name].preset(preset) for name, preset in lines[SETTING[:2]].to_numpy()]
    p = max(case.block.p for case in sweep_cases((6,)))  # of a step in seconds, the largest p dt
    steps = lines["value"].fillna(pd.Series([preset.step_s * p for preset in uses]))
    preset = lines.groupby(SETTING[:2], sort=False).ngroup()
    return lines.iloc[np.lexsort((-steps, preset))].reset_index(drop=True)


def along_steps(published: Path, engines: Sequence[str]) -> pd.DataFrame:
    """Return the settings of the ladder: every preset along its steps, both sets of cases."""
    uses = pd.DataFrame(
        [(f"{name} {use.name}", name, use.name) for name in engines for use in uses_of(name)],
        columns=["method", *SETTING[:2]],
    )
    lines = joint(pd.read_csv(published / LADDER)).merge(uses, on="method")
    worst = lines["max_error"].where(lines["failed"] == 0, math.inf)
    return lines.assign(max_error=worst)[[*SETTING, "wall_s", "runs", "cases", "max_error"]]


def _of_paper(published: Path, engines: Sequence[str]) -> pd.DataFrame:
    """Return each preset, as it is declared, on the paper's cases."""
    lines = pd.concat([pd.read_csv(published / name) for name in PAPER], ignore_index=True)
    lines = lines[lines["figure"].astype(str) == "all"].drop_duplicates("source")
    lines = lines[lines["source"].str.partition(":")[0].isin(engines)]
    asked = list(map(resolve, lines["source"]))
    return pd.DataFrame(
        {
            "engine": [source.engine for source in asked],
            "preset": [source.preset for source in asked],
            "value": [
                float(getattr(use.settings, use.accuracy_knob[0]))
                if use.accuracy_knob
                else use.ordinary_step()
                for use in (source.used for source in asked)
            ],
            "wall_s": lines["wall_s"] / lines["cases"],
            "runs": 1,
            "cases": lines["cases"],
            "max_error": lines["max_error"].where(lines["agree"] == lines["cases"], math.inf),
        }
    )
