"""A setting in the library's own words, and advice as text."""

from __future__ import annotations

import math
from dataclasses import asdict
from textwrap import indent
from typing import Any

import pandas as pd

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES, Scene
from engines.declaration import Engine, Preset
from engines.parts.settings import given
from studies.advise.choice import random_text
from studies.advise.evidence import in_words, options_at
from studies.kit.tables import in_columns
from studies.measures.costs import LOOPS, cost_text
from studies.measures.words import duration, listed, part, per_cent

ANY_PULSE = SinePulse(amplitude=1.0, omega=1.0)
"""Settings depend on no motion."""


def literal(
    engine: Engine,
    preset: Preset,
    block: RigidBlock,
    value: float,
    friction: float | None = None,
) -> str:
    """Return a preset's settings for a block in the library's words, a line each.

    Parameters
    ----------
    engine, preset : Engine, Preset
    block : RigidBlock
    value : float
        p dt, or the preset's dial; nan for its own step.
    friction : float, optional
        By default the preset's.

    Raises
    ------
    ValueError
        If the engine does not take such a friction.
    """
    asked = options_at(preset, value)
    scene = Scene(system=block, motion=ANY_PULSE, preset=preset.name, friction=friction, **asked)
    lines = [*_settings(engine, preset, scene), *_besides(preset)]
    return "\n".join(lines)


def _settings(engine: Engine, preset: Preset, scene: Scene) -> list[str]:
    dt_s = preset.ordinary_step_s(scene)
    chosen = scene.choose(preset.settings)
    if engine.script is not None:
        return list(engine.script(scene, chosen, dt_s).settings)
    named = ", ".join(f"{name}={value!r}" for name, value in given(asdict(chosen)).items())
    return [f"a step of {dt_s!r} s, and in this project's names", named]


def _besides(preset: Preset) -> list[str]:
    """Say what an adapter does that no setting of the library does."""
    helps = [help_.value for help_ in preset.helped_by]
    if not helps:
        return []
    words = "and at every step, by no setting of the library: "
    return [f"{words}{'; '.join(helps)}"]


def advice_text(lines: pd.DataFrame) -> str:
    """Return advice as an aligned table."""
    shown = pd.DataFrame(
        {
            "error": lines["target"].map("{:g}".format),
            "engine": lines["engine"],
            "preset": lines["preset"],
            "setting": [_setting(line) for _, line in lines.iterrows()],
            "step here": lines["dt_s"].map(_time),
            "a case": list(map(cost_text, lines["wall_s"], lines["runs"])),
            "loop": lines["driver"].where(lines["driver"] != "", "-"),
            "largest error": lines["max_error"].map(part),
            "cases": lines["cases"].map("{:d}".format),
            "off at this step*": [off_text(line) for _, line in lines.iterrows()],
            "": lines["message"].where(lines["message"] != "", lines["cheapest"].map(_mark)),
        }
    )
    return in_columns(shown.astype(str))


def _mark(cheapest: bool) -> str:
    return "the engine's cheapest" if cheapest else ""


def preset_of(line: pd.Series[Any]) -> Preset:
    """Return the preset of a line of advice."""
    return ENGINES[str(line["engine"])].preset(str(line["preset"]))


def _setting(line: pd.Series[Any]) -> str:
    return "-" if line["message"] else in_words(preset_of(line), float(line["value"]))


def _time(value: float) -> str:
    return "-" if math.isnan(value) else duration(value)


def off_text(line: pd.Series[Any]) -> str:
    """Return how many random and extreme cases are off with the very setting that is advised."""
    if line["message"]:
        return "-"
    random = random_text(line) or "no random case was run"
    extreme = f", {line['extreme_off']} of {line['extreme_cases']} extreme"
    return f"{random}{extreme if line['extreme_cases'] else ''}"


def settings_text(lines: pd.DataFrame, block: RigidBlock, friction: float | None = None) -> str:
    """Return the settings of the lines that found one, each once, in the libraries' words."""
    chosen = lines[lines["message"] == ""].drop_duplicates(["engine", "preset", "value"])
    parts = []
    for _, line in chosen.iterrows():
        engine = ENGINES[str(line["engine"])]
        preset, value = engine.preset(str(line["preset"])), float(line["value"])
        here = "" if math.isnan(line["dt_s"]) else f", here {duration(float(line['dt_s']))}"
        head = f"{engine.title}, {preset.title}, {in_words(preset, value)}{here}"
        parts.append(f"{head}\n{indent(literal(engine, preset, block, value, friction), '  ')}")
    return "\n\n".join(parts)


def claim(lines: pd.DataFrame) -> str:
    """Say which engine keeps which error at what cost with each loop, and where nothing does."""
    alike: dict[str, list[str]] = {}
    for target, group in lines.groupby("target", sort=False):
        found = [_advised(best) for best in best_by_driver(group).values()]
        by = " and ".join(found) or "nothing"
        alike.setdefault(by, []).append(per_cent(float(str(target))))
    words = [f"{listed(targets)} by {by}" for by, targets in alike.items()]
    return f"Errors are kept cheapest: {'; '.join(words)}."


def best_by_driver(lines: pd.DataFrame) -> dict[str, pd.Series[Any]]:
    """Return for each loop that takes steps, compiled or Python, the cheapest line of advice."""
    kept = lines[lines["message"] == ""].sort_values("wall_s").drop_duplicates("driver")
    return {str(line["driver"]): line for _, line in kept.sort_values("driver").iterrows()}


def _advised(line: pd.Series[Any]) -> str:
    """Return a line of advice in words: setting, time, who takes the steps."""
    cost = cost_text(line["wall_s"], line["runs"], " a case")
    return f"{setting_text(line)} ({cost}, {LOOPS[str(line['driver'])]})"


def setting_text(line: pd.Series[Any]) -> str:
    """Return the engine, the preset and the setting of a line of advice."""
    at = in_words(preset_of(line), float(line["value"]))
    return f"{line['engine']} {line['preset']} at {at}"
