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
from studies.advise.words import ASK, literal
from studies.drawing.kept import as_text
from studies.measures.formulas import by_step
from studies.measures.presets import uses_of

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
    table, p_dt = pd.read_csv(published / LADDER), dt_s * block.p
    table["max_error"] = table["max_error"].where(table["failed"] == 0, math.inf)
    lines = []
    for engine, preset in ((name, use.name) for name in engines for use in _equal(name)):
        mine = table[table["method"] == f"{engine} {preset}"]
        at = mine.loc[mine["value"] >= p_dt * (1.0 - SAME), "value"].min()
        worst = mine[mine["value"] <= at].groupby("set")["max_error"].max()
        use = {"engine": engine, "preset": preset, "p_dt": p_dt, "coarser": at}
        lines.append({**use, **worst.reindex(SETS)})
    return pd.DataFrame(lines)


def _equal(engine: str) -> list[Preset]:
    return [use for use in uses_of(engine) if use.stepping is Stepping.FIXED]


def reverse_text(
    lines: pd.DataFrame, block: RigidBlock, dt_s: float, friction: float | None
) -> str:
    """Return the errors as a table; of one engine also its settings, as formulas and values."""
    finding = (
        f"For a block of {block.width:g} x {block.height:g} m (p = {block.p:.5g} rad/s) a step of "
        f"{dt_s:g} s is p dt = {dt_s * block.p:.3g}; presets that land on impacts, or choose their "
        "own steps, have no one step."
    )
    title = (
        "Largest error of the peak on published cases at the next coarser published p dt, and\n"
        "every finer one; inf: an outcome is wrong"
    )
    engines = lines["engine"].unique()
    parts = [_written(line, block, dt_s, friction) for _, line in lines.iterrows()]
    if len(engines) > 1:
        parts = [f"{ASK} {engines[0]} --dt {dt_s:g}"]
    return "\n\n".join([as_text(finding, {title: lines.drop(columns="p_dt")}), *parts])


def _written(line: pd.Series[Any], block: RigidBlock, dt_s: float, friction: float | None) -> str:
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
