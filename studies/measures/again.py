"""A row of a table asked again: the commands that give its outcome and its peak."""

from __future__ import annotations

import inspect
import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import fields
from pathlib import Path
from typing import Any

import pandas as pd

from analytic.block import GRAVITY, RigidBlock
from analytic.frame import RockingFrame
from analytic.motion import Motion, SinePulse, Still
from analytic.slide import SlidingBlock
from engines.declaration import Engine, Preset
from engines.layouts import Ability, System
from studies.cases.paper import free_rocking_window
from studies.kit.provenance import record_of
from studies.sources.registry import Effort, asks_of, resolve

FLAGS = ("start", "friction", "step", "accuracy")
"""Options of a source that the command line has, too."""

ROCKING = "rocking "
"""How a command begins; what else stands in its place says why there is none."""

WORST_AGAIN = "The worst, asked again"
"""Title of `worst_again`."""


def commands(
    block: System,
    motion: Motion,
    source: str,
    options: Mapping[str, Any],
    *,
    duration: float | None = None,
    outcome: str = "rocked",
) -> tuple[str, str]:
    """Return the commands that ask a source about a case again.

    Parameters
    ----------
    block, motion, source, options, duration
        As of a `studies.kit.jobs.Job`.
    outcome : str, optional
        What was answered: nothing is written out for an engine that had no motion to tell.

    Returns
    -------
    compare, export : str
        `rocking compare` beside the exact solution, or why it cannot; and `rocking export`, empty
        where it cannot: it writes equal steps.
    """
    if missing := _without_option(block, motion, options):
        return f"no option asks for {missing}", ""
    words = _scene_of(block)
    if isinstance(motion, SinePulse):
        words |= {"half-cycles": motion.half_cycles, "amplitude": _in_g(motion.amplitude)}
        words |= {"omega": motion.omega} | ({"phase": motion.phase} if motion.phase else {})
    theta, rate = options.get("start", (0.0, 0.0))
    words |= {"tilt": theta / block.alpha} if theta else {}
    words |= {"rate": rate / (block.alpha * block.p)} if rate else {}
    words |= {name: value for name, value in options.items() if name != "start"}
    case = " ".join(f"--{name} {value}" for name, value in words.items())
    usual = duration in (None, free_rocking_window(block, motion))
    watched = "" if usual else f" --duration {duration}"
    beside = "" if source == "exact" else f" {source}"
    compare = f"{ROCKING}compare {case}{watched} --sources exact{beside}"
    answered = outcome in ("rocked", "overturned", "slid")
    asked = resolve(source)
    if not (usual and answered and written_out(source)):
        return compare, ""
    if not built_by_script(asked.declared, asked.used, asks_of(block)):
        return compare, ""
    return compare, f"{ROCKING}export {case} --engine {source} --out DIR"


def written_out(source: str) -> bool:
    """Say whether `rocking export` writes a source out: an engine with equal steps and a script."""
    asked = resolve(source)
    return bool(asked.engine and asked.declared.script) and not asked.accurate


def built_by_script(engine: Engine, preset: Preset, asks: Sequence[Ability]) -> bool:
    """Say whether a scene is built by the engine's `build`, or by what wraps it.

    The exported script quotes it.

    Parameters
    ----------
    engine, preset
    asks : sequence of Ability
        What the scene asks for beyond one body, from `studies.sources.registry.asks_of`.

    Returns
    -------
    bool
        False where the engine or the preset has a builder of its own for one of these.
    """
    return inspect.unwrap(engine.builder(asks, preset)) is engine.build


def asked_again(
    folder: Path, worst: pd.DataFrame, rows: pd.DataFrame, kind: type[Any]
) -> pd.DataFrame:
    """Return worst cases, the largest error first, with the commands that ask them again.

    Parameters
    ----------
    folder : Path
        Its step and accuracy were every source's.
    worst, rows : DataFrame
        Some rows of a table, and all with every column, under the same index.
    kind : type
        The dataclass of a case, whose fields are columns.
    """
    settings = record_of(folder)["settings"]
    effort = Effort(step=settings["step"], accuracy=settings["accuracy"])
    first = worst.sort_values("error", key=abs, ascending=False, na_position="first", kind="stable")
    asked = []
    for row in rows.loc[first.index].to_dict("records"):
        case, source = kind(**{item.name: row[item.name] for item in fields(kind)}), row["source"]
        outcome, options = row["outcome"], effort.options(source)
        asked.append(commands(case.block, case.motion, source, options, outcome=outcome))
    return with_commands(first, asked)


def with_commands(table: pd.DataFrame, asked: Iterable[tuple[str, str]]) -> pd.DataFrame:
    """Add compare and export to the rows of a table.

    Parameters
    ----------
    table : DataFrame
        Without these columns.
    asked : iterable of (str, str)
        What `commands` returns of each row, a pair for each, in their order.

    Returns
    -------
    DataFrame
        The rows under their index, with both columns.
    """
    return table.join(pd.DataFrame(asked, index=table.index, columns=["compare", "export"]))


def worst_again(table: pd.DataFrame) -> pd.DataFrame:
    """Return the commands of the first row that has some, from `with_commands`."""
    able = table[table["compare"].str.startswith(ROCKING)]
    words = [word for word in able[["compare", "export"]].head(1).to_numpy().ravel() if word]
    return pd.DataFrame({"command": words})


def _without_option(block: System, motion: Motion, options: Mapping[str, Any]) -> str:
    """Return what of a case the command line has no option for."""
    if _asked(block) != block:
        return "such a body, or its restitution"
    if isinstance(block, SlidingBlock) and ("start" in options or isinstance(motion, Still)):
        return "its launch"
    if not isinstance(motion, SinePulse | Still):
        return "its motion of the base"
    return ", ".join(name for name in options if name not in FLAGS)


def _asked(block: System) -> System:
    """Return what the options of the command line make of a block."""
    options = _scene_of(block)
    kind, _ = SCENES[options.pop("scene", "")]
    asked: System = kind(**options)
    return asked


SCENES: Mapping[str, tuple[Any, tuple[str, ...]]] = {
    "frame": (RockingFrame, ("columns", "load", "width", "height")),
    "slide": (SlidingBlock, ("friction", "width", "height")),
    "": (RigidBlock, ("width", "height")),
}
"""What `--scene` poses, by default one block, and its options."""


def _scene_of(block: Any) -> dict[str, Any]:
    """Return the options that name a scene, none of one block, and its sizes."""
    scene, names = next(
        (name, of) for name, (kind, of) in SCENES.items() if isinstance(block, kind)
    )
    sizes = {name: getattr(block, name) for name in names}
    return {**({"scene": scene} if scene else {}), **sizes}


def _in_g(amplitude: float) -> float:
    """Return what times g is an amplitude [m/s2], to the last bit where a number does that."""
    near = amplitude / GRAVITY
    tried = (near, math.nextafter(near, 0.0), math.nextafter(near, math.inf))
    return min(tried, key=lambda value: abs(value * GRAVITY - amplitude))
