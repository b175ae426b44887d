"""Advice as text: a setting in the library's own words, and which error a step keeps."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from textwrap import indent
from typing import Any

import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES, Scene
from engines.declaration import Engine, Preset, Stepping
from engines.parts.settings import given
from studies.advise.evidence import LADDER, in_words, options_at
from studies.drawing.kept import as_text
from studies.measures.costs import cost_text
from studies.measures.formulas import by_step
from studies.measures.presets import uses_of
from studies.measures.words import duration, gathered, per_cent

USE = ["target", "engine", "preset"]
SHOWN = (
    *(*USE, "value", "dt_s", "wall_s", "runs", "max_error", "cases"),
    *("random_off", "random_cases", "extreme_off", "extreme_cases", "cheapest"),
)
"""Columns of the table of what keeps an error."""

ASK = "The settings in the library's words: rocking advise --engine"
"""Where what is written out for one engine is asked, before its name."""

ANY_PULSE = SinePulse(amplitude=1.0, omega=1.0)
"""Settings depend on no motion."""


def literal(
    engine: Engine,
    preset: Preset,
    block: RigidBlock,
    value: float,
    friction: float,
) -> str:
    """Return a preset's settings for a block in the library's words, a line each.

    Parameters
    ----------
    engine, preset : Engine, Preset
    block : RigidBlock
    value : float
        p dt, or the preset's accuracy knob; nan for its own step.
    friction : float
        To which some of them belong.

    Raises
    ------
    ValueError
        If the engine does not take such a friction.
    """
    asked = options_at(preset, value)
    scene = Scene(system=block, motion=ANY_PULSE, preset=preset.name, friction=friction, **asked)
    dt_s, chosen = preset.ordinary_step_s(scene), scene.choose(preset.settings)
    if engine.script is not None:
        lines = list(engine.script(scene, chosen, dt_s).settings)
    else:
        named = ", ".join(f"{name}={value!r}" for name, value in given(asdict(chosen)).items())
        lines = [f"a step of {dt_s!r} s, and in this project's names", named]
    if helps := "; ".join(each.value for each in preset.helped_by):
        lines.append(f"and at every step, by no setting of the library: {helps}")
    return "\n".join(lines)


def tables(lines: pd.DataFrame, block: RigidBlock) -> dict[str, pd.DataFrame]:
    """Return what keeps each error, and why nothing keeps the largest that a preset misses.

    Parameters
    ----------
    lines : DataFrame
        From `studies.advise.choice.advice`.
    block : RigidBlock
        For which its steps are in seconds.

    Returns
    -------
    dict
        Title -> table.
    """
    found = lines["message"] == ""
    here = f"For a block of {block.width:g} x {block.height:g} m (p = {block.p:.5g} rad/s)"
    return {
        f"{here} the cheapest setting that keeps each error\nwith every finer one, and how many "
        "random and extreme cases are off at this very step": lines.loc[found, list(SHOWN)],
        "The largest error that nothing keeps of a preset, and why": (
            lines.loc[~found, [*USE, "message"]].drop_duplicates(USE[1:])
        ),
    }


def preset_of(line: pd.Series[Any]) -> Preset:
    """Return the preset of a line of advice."""
    return ENGINES[str(line["engine"])].preset(str(line["preset"]))


def settings_text(lines: pd.DataFrame, block: RigidBlock, friction: float) -> str:
    """Return the settings of the lines that found one, each once, in the libraries' words.

    Parameters
    ----------
    lines, block
        As for `tables`.
    friction : float
        As for `literal`, with its error.
    """
    chosen = lines[lines["message"] == ""].drop_duplicates(["engine", "preset", "value"])
    parts = []
    for _, line in chosen.iterrows():
        engine, preset = ENGINES[str(line["engine"])], preset_of(line)
        value = float(line["value"])
        here = "" if math.isnan(line["dt_s"]) else f", here {duration(float(line['dt_s']))}"
        at = f"{in_words(preset, value)}{here}, friction {friction:g}"
        head = f"{engine.title}, {preset.title}, {at}"
        parts.append(f"{head}\n{indent(literal(engine, preset, block, value, friction), '  ')}")
    return "\n\n".join(parts)


def finding(lines: pd.DataFrame) -> str:
    """Say what each error costs at the least, with whom, and where nothing keeps it.

    Then what it costs where no adapter helps, by what a user of the library can set.
    """
    unhelped = [not preset_of(line).helped_by for _, line in lines.iterrows()]
    cheapest, alone = _costs(lines), _costs(lines[unhelped])
    own = f" By a library's own settings alone, {alone}." if alone != cheapest else ""
    return f"An error of {cheapest}.{own}"


def _costs(lines: pd.DataFrame) -> str:
    said = []
    for target, group in lines.groupby("target", sort=False):
        cheapest = group[group["message"] == ""].nsmallest(1, "wall_s")
        words = "cannot be had"
        for _, line in cheapest.iterrows():
            cost = cost_text(line["wall_s"], line["runs"], " a case")
            words = f"costs {cost} ({line['engine']} {line['preset']})"
        said.append((per_cent(float(str(target))), words))
    return gathered(said)


def setting_text(line: pd.Series[Any]) -> str:
    """Return the engine, the preset and the setting of a line of advice."""
    at = in_words(preset_of(line), float(line["value"]))
    return f"{line['engine']} {line['preset']} at {at}"


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
    uses = [(name, use) for name in engines for use in uses_of(name)]
    for engine, preset in [(n, use.name) for n, use in uses if use.stepping is Stepping.FIXED]:
        mine = table[table["method"] == f"{engine} {preset}"]
        at = mine.loc[mine["value"] >= p_dt * (1.0 - SAME), "value"].min()
        worst = mine[mine["value"] <= at].groupby("set")["max_error"].max()
        use = {"engine": engine, "preset": preset, "p_dt": p_dt, "coarser": at}
        lines.append({**use, **worst.reindex(SETS)})
    return pd.DataFrame(lines)


def reverse_text(lines: pd.DataFrame, block: RigidBlock, dt_s: float, friction: float) -> str:
    """Return the errors as a table; of one engine also its settings, as formulas and values.

    Parameters
    ----------
    lines : DataFrame
        From `kept_errors`.
    block : RigidBlock
    dt_s : float
        The step [s] that it was asked for.
    friction : float
        As for `literal`, with its error.
    """
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


def _written(line: pd.Series[Any], block: RigidBlock, dt_s: float, friction: float) -> str:
    engine = ENGINES[str(line["engine"])]
    preset = engine.preset(str(line["preset"]))

    def at(step_s: float) -> str:
        return literal(engine, preset, block, step_s * block.p, friction)

    values = at(dt_s)
    head = f"{engine.title}, {preset.title}, DT = {dt_s:g} s, friction {friction:g}"
    try:
        formulas = by_step(at)
    except ValueError:
        # a number that follows the step otherwise than as a power of it
        return f"{head}; at another step other numbers\n{indent(values, '  ')}"
    text = f"{head}\n{indent(formulas, '  ')}"
    return text if formulas == values else f"{text}\nthat is\n{indent(values, '  ')}"
