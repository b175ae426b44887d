"""What the variants of a contact say: of one, of a preset's helps, of an engine's rules."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import pandas as pd

from engines import ENGINES
from engines.parts.factors import BEST, DEFAULT, LEFT_OUT, OWN_STEP, OWN_STEPS, Rule
from studies.cases.variants import STILL
from studies.measures.words import part


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


def changed(lines: pd.DataFrame, engine: str, preset: str) -> pd.DataFrame:
    """Return the variants of an engine that change one setting of a preset.

    Parameters
    ----------
    lines : DataFrame
        The columns of variants.csv; the lines of these variants are returned.
    engine, preset : str
    """
    mine = (lines["engine"] == engine) & (lines["preset"] == preset)
    return lines[mine & (lines["factor"] != "")]


def prices(lines: pd.DataFrame, engine: str) -> dict[str, str]:
    """Return the largest error of an engine's best preset without each of what it is helped by.

    Parameters
    ----------
    lines : DataFrame
        The columns of variants.csv.
    engine : str

    Returns
    -------
    dict
        Name of a `Help` -> the error and what fails, in words; "" -> the preset as it is;
        "STEPS" -> that with equal steps.
    """
    best = ENGINES[engine].best.name
    mine = lines[(lines["engine"] == engine) & (lines["preset"] == best)]
    asked = mine[mine["factor"].isin(["", LEFT_OUT])]
    found = {line["level"] if line["factor"] else "": line for _, line in asked.iterrows()}
    words = {name.upper(): error_words(line) for name, line in found.items()}
    equal = variant_of(lines, engine, BEST)
    return words | ({} if equal is None else {"STEPS": error_words(equal)})


def rules(lines: pd.DataFrame, engine: str) -> list[tuple[Rule, str, str]]:
    """Return those of an engine's rules that help, each with the errors without it and with it.

    One helps if fewer outcomes are wrong with it, or as many and the median error is smaller.

    Parameters
    ----------
    lines : DataFrame
        The columns of variants.csv.
    engine : str

    Returns
    -------
    list of (Rule, str, str)
        Median and largest error of the peak, in words; rules of which a variant was not run are
        left out.
    """
    found = []
    for rule in ENGINES[engine].rules:
        plain = variant_of(lines, engine, rule.preset)
        other = variant_of(lines, engine, rule.preset, rule.factor, rule.level)
        if plain is not None and other is not None:
            pair = (plain, other) if rule.kept else (other, plain)
            wrong, kept = ((it["failed"] + it["wrong"], it["median_error"]) for it in pair)
            if kept < wrong:
                words = [error_words(one, ("median_error", "max_error")) for one in pair]
                found.append((rule, words[0], words[1]))
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
