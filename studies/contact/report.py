"""What the contact variants show: tables and figure, what a rule is worth, and a recommendation."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from engines import ENGINES
from engines.parts.factors import (
    AS_BEST,
    BEST,
    BY_DEFAULT,
    DEFAULT,
    LEFT_OUT,
    OWN_STEP,
    OWN_STEPS,
    Rule,
)
from studies.cases.variants import STILL, preset_values
from studies.drawing.kept import Pictures, tell
from studies.kit.tables import read_table, write_table
from studies.measures.differences import with_reference
from studies.measures.words import listed, part
from studies.measures.wrongness import FALL, NO_ANSWER, REST, wrong_in

KEY = ["engine", "preset", "factor", "level"]
"""Columns that tell one variant from another."""

FOUND = ["failed", "wrong", "max_error"]
"""What a variant is judged by: outcomes of all cases, peaks of typical ones."""


def report(folder: Path) -> str:
    """Reduce and draw a folder's contact.csv; write and return what it shows as text."""
    rows = read(folder / "contact.csv")
    lines, own = variant_table(rows[~rows["own_step"]]), variant_table(rows[rows["own_step"]])
    for name, table in {"variants": lines, "own-steps": own}.items():
        write_table(folder / f"{name}.csv", table)
    plain = lines["factor"] == ""
    measured = ["ratio_over_eta", "newton_e", "slip_widths", "sink_widths", "step_s"]
    engines = lines["engine"].unique()
    tables = {
        "Presets as they are": lines.loc[
            plain, ["engine", "preset", "cases", *FOUND, "median_error", *measured]
        ],
        "Defaults at their own step": lines.loc[
            lines["factor"] == OWN_STEPS, ["engine", "level", *FOUND]
        ],
        **{
            f"What to set in {engine}: left at its default, and alone": recommendation(
                lines, engine
            )
            for engine in engines
        },
        "Traps": lines.loc[(lines["trap"] != "") & ~plain, [*KEY, *FOUND, "trap"]],
    }
    return tell(folder, pictures(folder), first_claim(lines), tables)


def headline(folder: Path) -> str:
    """Return, for each engine, the tuned setting that matters most."""
    return first_claim(read(folder / "variants.csv"))


def pictures(folder: Path) -> Pictures:
    """Draw the largest error of every variant of a folder from its variants.csv alone."""
    from studies.contact.figure import draw_contact

    return {"contact": draw_contact(read(folder / "variants.csv"))}


def read(path: Path) -> pd.DataFrame:
    """Read a table back with empty words as such."""
    return read_table(path, "factor", "level", "trap")


def variant_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return one line for each variant: its errors, what it changes, its impact, its cost."""
    compared = with_reference(rows)
    case = ["set", "figure", "aspect"]
    base = compared[compared["factor"] == ""].set_index(["engine", "preset", *case])["peak_ratio"]
    base = base.where(np.isfinite(base))  # a preset that overturns has no peak to move
    own = base.reindex(pd.MultiIndex.from_frame(compared[["engine", "preset", *case]])).to_numpy()
    kinds = wrong_in(compared)
    compared = compared.assign(
        moved=(compared["peak_ratio"] / own - 1.0).where(compared["error"].notna()).abs(),
        typical=compared["error"].abs().where(compared["set"] == "typical"),
        step_s=compared["wall_s"] / compared["steps"].clip(lower=1),
        failed=kinds == NO_ANSWER,
        wrong=kinds.isin((FALL, REST)),
    )
    groups = compared.groupby(KEY, sort=False)
    table = groups.agg(
        trap=("trap", "first"),
        cases=("outcome", "size"),
        failed=("failed", "sum"),
        wrong=("wrong", "sum"),
        median_error=("typical", "median"),
        max_error=("typical", "max"),
        moved=("moved", "max"),
        ratio_over_eta=("ratio_over_eta", "median"),
        newton_e=("newton_e", "median"),
        slip_widths=("slip_widths", "max"),
        sink_widths=("sink_widths", "max"),
        energy_drift=("energy_drift", "median"),
        energy_growth=("energy_growth", "max"),
        step_s=("step_s", "median"),
        message=("message", "max"),
    ).reset_index()
    first = table.groupby(["engine", "preset"])[["ratio_over_eta", "wrong"]].transform("first")
    return table.assign(
        ratio_moved=(table["ratio_over_eta"] / first["ratio_over_eta"] - 1.0).abs(),
        worse=(table["failed"] > 0) | (table["wrong"] > first["wrong"]),
    )


def recommendation(lines: pd.DataFrame, engine: str) -> pd.DataFrame:
    """Return a line for each tuned setting of an engine, the one that matters most first.

    What it moves and what errors it leaves where the tuned preset has it at the library's default;
    and, in columns that end in alone, where it is all that is tuned of the defaults. What breaks a
    case matters most, then what moves a peak or an impact.
    """
    lines = lines[lines["engine"] == engine].set_index("factor")
    left = lines[(lines["preset"] == BEST) & (lines["level"] == BY_DEFAULT)]
    alone = lines[(lines["preset"] == DEFAULT) & (lines["level"] == AS_BEST)]
    both = alone.merge(left, "left", on="factor", suffixes=("_alone", ""))
    breaks = both[["worse", "worse_alone"]].eq(True).any(axis=1)
    matter = both.filter(like="moved").max(axis=1).mask(breaks, math.inf)
    names = {factor.name: factor.settings for factor in ENGINES[engine].factors}
    values = [preset_values(engine, BEST, names[factor]) for factor in both.index]
    tuned = [", ".join(f"{name} {value}" for name, value in each.items()) for each in values]
    shown = ["moved", "ratio_moved", *FOUND, *(f"{name}_alone" for name in FOUND)]
    table = both[shown].set_axis(pd.Index(tuned, name="set"))
    return table.iloc[(-matter).argsort(kind="stable")].reset_index()


def name_of(line: pd.Series[Any]) -> str:
    """Return a variant's name."""
    return f"{line['factor']}: {line['level']}" if line["factor"] else str(line["level"])


def error_words(line: pd.Series[Any], columns: Sequence[str] = ("max_error",)) -> str:
    """Return the largest or other errors, and how many of all cases are wrong, in few words."""
    if line["failed"] == line["cases"]:
        return "no result"
    errors = ", ".join(part(line[name]) for name in columns)
    broken = int(line["failed"]) + int(line["wrong"])
    return errors + (f", {broken} of {line['cases']} wrong" if broken else "")


def first_claim(lines: pd.DataFrame) -> str:
    """Say which setting, left at its default, leaves the largest error in each engine."""
    left = lines[(lines["preset"] == BEST) & (lines["level"] == BY_DEFAULT)]
    worst = left.sort_values("max_error", ascending=False).drop_duplicates("engine").sort_index()
    words = [
        f"{line['factor']} in {line['engine']} ({part(line['max_error'])})"
        for _, line in worst.iterrows()
    ]
    return (
        "Of a tuned contact, the setting whose default alone leaves the largest error is "
        f"{listed(words)}."
    )


def changed(lines: pd.DataFrame, engine: str, preset: str) -> pd.DataFrame:
    """Return the variants of an engine that change one setting of a preset."""
    mine = (lines["engine"] == engine) & (lines["preset"] == preset)
    return lines[mine & (lines["factor"] != "")]


def prices(lines: pd.DataFrame, engine: str) -> dict[str, str]:
    """Return the largest error of an engine's best preset without each of what it is helped by.

    Returns
    -------
    dict
        Name of a `Help` -> the error and what fails; "" -> the preset as it is; "STEPS" -> that
        with equal steps.
    """
    best = ENGINES[engine].best.name
    mine = lines[(lines["engine"] == engine) & (lines["preset"] == best)]
    asked = mine[mine["factor"].isin(["", LEFT_OUT])]
    found = {line["level"] if line["factor"] else "": line for _, line in asked.iterrows()}
    words = {name.upper(): error_words(line) for name, line in found.items()}
    equal = variant_of(lines, engine, BEST)
    return words | ({} if equal is None else {"STEPS": error_words(equal)})


def rules(lines: pd.DataFrame, engine: str) -> list[tuple[Rule, str, str]]:
    """Return an engine's rules, each with the errors without it and with it."""
    found = []
    for rule in ENGINES[engine].rules:
        plain = variant_of(lines, engine, rule.preset)
        other = variant_of(lines, engine, rule.preset, rule.factor, rule.level)
        if plain is not None and other is not None:
            pair = (plain, other) if rule.kept else (other, plain)
            without, with_it = (error_words(one, ("median_error", "max_error")) for one in pair)
            found.append((rule, without, with_it))
    return found


def frames(lines: pd.DataFrame) -> list[tuple[str, str, str]]:
    """Return of each engine what its defaults err by in either frame, at the library's own step."""
    found = []
    for engine in lines["engine"].unique():
        still, moved = (
            variant_of(lines, engine, DEFAULT, OWN_STEPS, level) for level in (STILL, OWN_STEP)
        )
        if still is not None and moved is not None:
            found.append((str(engine), error_words(still), error_words(moved)))
    return found


def variant_of(
    lines: pd.DataFrame, engine: str, preset: str, factor: str = "", level: str = ""
) -> pd.Series[Any] | None:
    """Return the line of a preset, or of a variant of it; None where there is none."""
    wanted = (lines["engine"] == engine) & (lines["preset"] == preset)
    wanted &= lines["factor"] == factor
    if level:
        wanted &= lines["level"] == level
    return lines[wanted].iloc[0] if wanted.any() else None
