"""The reverse question: which error a step keeps, and with which settings of an engine."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from textwrap import indent
from typing import Any

import pandas as pd

from analytic.block import RigidBlock
from engines import ENGINES
from engines.declaration import Preset, Stepping
from studies.advise.evidence import LADDER
from studies.advise.words import literal
from studies.kit.journal import Row
from studies.kit.tables import in_columns
from studies.measures.formulas import by_step
from studies.measures.presets import uses_of
from studies.measures.words import listed, part

SETS = ("typical", "near overturning")
"""Published cases, a column each."""
SAME = 1e-9
"""Relative difference up to which two steps are one."""


def kept_errors(
    published: Path, engines: Sequence[str], block: RigidBlock, dt_s: float
) -> pd.DataFrame:
    """Return for each preset with equal steps the errors that a step keeps.

    Parameters
    ----------
    published : Path
        The folder of the published tables.
    engines : sequence of str
    block : RigidBlock
    dt_s : float
        The step [s].

    Returns
    -------
    DataFrame
        engine, preset, p_dt; coarser: p dt of the finest published step that is no finer, nan where
        there is none; and for each of `SETS` the largest error of the peak at it and every finer
        published step, inf where an outcome is wrong.
    """
    table = pd.read_csv(published / LADDER)
    worst = table["max_error"].where(table["failed"] == 0, math.inf)
    lines = table.assign(max_error=worst)
    p_dt = dt_s * block.p
    return pd.DataFrame([_kept(lines, name, use, p_dt) for name in engines for use in _equal(name)])


def _kept(lines: pd.DataFrame, engine: str, preset: Preset, p_dt: float) -> Row:
    mine = lines[lines["method"] == f"{engine} {preset.name}"]
    at = mine.loc[mine["value"] >= p_dt * (1.0 - SAME), "value"].min()
    within = mine[mine["value"] <= at]
    return {
        "engine": engine,
        "preset": preset.name,
        "p_dt": p_dt,
        "coarser": float(at),
        **{name: float(within.loc[within["set"] == name, "max_error"].max()) for name in SETS},
    }


def _equal(engine: str) -> list[Preset]:
    return [use for use in uses_of(engine) if use.stepping is Stepping.FIXED]


def reverse_text(
    lines: pd.DataFrame, block: RigidBlock, dt_s: float, friction: float | None
) -> str:
    """Return the errors as a table, and under it the settings as formulas and their values."""
    head = (
        f"For a block of {block.width:g} x {block.height:g} m (p = {block.p:.5g} rad/s) a step of "
        f"{dt_s:g} s is p dt = {dt_s * block.p:.3g}. Largest error of the peak that it keeps, on "
        "published cases:"
    )
    shown = pd.DataFrame(
        {
            "engine": lines["engine"],
            "preset": lines["preset"],
            **{name: [_said(float(error)) for error in lines[name]] for name in SETS},
            "published at": [_at(line) for _, line in lines.iterrows()],
        }
    )
    without = [name for name in lines["engine"].unique() if len(_equal(name)) < len(uses_of(name))]
    note = (
        f"\nThe other presets of {listed(without)} have no one step: they land on impacts, or "
        "choose their own."
        if without
        else ""
    )
    parts = [_written(line, block, dt_s, friction) for _, line in lines.iterrows()]
    return "\n\n".join([f"{head}\n{in_columns(shown.astype(str))}{note}", *parts])


def _said(error: float) -> str:
    if math.isnan(error):
        return "-"
    return "an outcome is wrong" if math.isinf(error) else part(error)


def _at(line: pd.Series[Any]) -> str:
    if math.isnan(line["coarser"]):
        return "no step as coarse"
    return f"p dt = {line['coarser']:.3g} and every finer step"


def _written(line: pd.Series[Any], block: RigidBlock, dt_s: float, friction: float | None) -> str:
    """Return the settings of a preset as formulas of the step, and at the step."""
    engine = ENGINES[str(line["engine"])]
    preset = engine.preset(str(line["preset"]))

    def at(step_s: float) -> str:
        return literal(engine, preset, block, step_s * block.p, friction)

    values = at(dt_s)
    head = f"{engine.title}, {preset.title}, DT = {dt_s:g} s"
    try:
        formulas = by_step(at)
    except ValueError:
        # a number that follows the step otherwise than as a power of it
        return f"{head}; at another step other numbers\n{indent(values, '  ')}"
    text = f"{head}\n{indent(formulas, '  ')}"
    return text if formulas == values else f"{text}\nthat is\n{indent(values, '  ')}"
