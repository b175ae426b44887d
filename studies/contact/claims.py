"""What each setting of a contact costs and buys, in sentences made from the lines of variants.csv.

Two things are told apart: by how far a setting moves a peak of its preset, and the largest error
that it leaves.
"""

from __future__ import annotations

import math
from typing import Any

import pandas as pd

from engines import ENGINES
from engines.parts.factors import BEST, BY_DEFAULT, DEFAULT, LEFT_OUT, OWN_STEP, OWN_STEPS, Rule
from studies.cases.variants import STILL
from studies.measures.differences import scientific
from studies.measures.presets import in_order, in_words
from studies.measures.words import listed, part

NOTABLE = 1e-3
"""A setting that moves no peak by more, relatively, makes no difference worth a sentence."""

SHOWN = 4
"""How many settings a sentence names."""

FRAMES = "Defaults at their own step, largest error with a body force and on a base that moves"

FROM = {BEST: "from the tuned preset", DEFAULT: "from the defaults"}
"""Preset -> where one setting at a time is changed."""


def name_of(line: pd.Series[Any]) -> str:
    """Return a variant's name."""
    return f"{line['factor']}: {line['level']}" if line["factor"] else str(line["level"])


def errors_of(line: pd.Series[Any]) -> str:
    """Return the largest error on typical cases, and how many of all cases fail or are wrong."""
    broken = int(line["failed"]) + int(line["wrong"])
    words = f"{broken} of {line['cases']} failed or wrong" if broken else ""
    if not math.isfinite(line["max_error"]):
        return words or "-"
    error = scientific(float(line["max_error"]))
    return f"{error} ({words})" if words else error


def error_words(line: pd.Series[Any]) -> str:
    """Return the same for a sentence or a table of few words."""
    if line["failed"] == line["cases"]:
        return "no result"
    broken = int(line["failed"]) + int(line["wrong"])
    return part(line["max_error"]) + (f", {broken} of {line['cases']} wrong" if broken else "")


def both_errors(line: pd.Series[Any]) -> str:
    """Return the median and the largest error in few words, and how many cases are wrong."""
    words = error_words(line)
    return words if line["failed"] == line["cases"] else f"{part(line['median_error'])}, {words}"


def first_claim(lines: pd.DataFrame) -> str:
    """Say which setting, left at its default, leaves the largest error in each engine."""
    words = []
    for engine in lines["engine"].unique():
        left = left_at_defaults(lines, engine)
        worst = left.sort_values("max_error", ascending=False).head(1)
        words += [
            f"{line['factor']} in {engine} ({part(line['max_error'])})"
            for _, line in worst.iterrows()
        ]
    return (
        "Of a tuned contact, the setting whose default alone leaves the largest error is "
        f"{listed(words)}."
    )


def left_at_defaults(lines: pd.DataFrame, engine: str) -> pd.DataFrame:
    """Return the tuned preset with one setting left at the library's default each."""
    varied = changed(lines, engine, BEST)
    return varied[varied["level"] == BY_DEFAULT]


def overview(lines: pd.DataFrame, engine: str) -> str:
    """Return the largest errors of an engine's presets, and which settings matter most."""
    base = lines[(lines["engine"] == engine) & (lines["factor"] == "")]
    of = {str(line["preset"]): line for _, line in base.iterrows()}
    errors = [f"{errors_of(of[name])} {in_words(name)}" for name in reversed(in_order(of))]
    sentence = f"{engine}: largest error {', '.join(errors)}, fixed steps alike."
    left = left_at_defaults(lines, engine)
    if left.empty:
        return sentence
    moving = left[left["moved"] >= NOTABLE]
    erring = left[left["max_error"] > (1.0 + NOTABLE) * of[BEST]["max_error"]]
    return (
        f"{sentence} Of what is tuned, left at its default, peaks are moved by more than "
        f"{part(NOTABLE)} by {ranked(moving, 'moved')}; a larger error than the preset's own is "
        f"left by {ranked(erring, 'max_error')}."
    )


def changed(lines: pd.DataFrame, engine: str, preset: str) -> pd.DataFrame:
    """Return the variants of an engine that change one setting of a preset."""
    mine = (lines["engine"] == engine) & (lines["preset"] == preset)
    return lines[mine & (lines["factor"] != "")]


def ranked(varied: pd.DataFrame, column: str, shown: int = SHOWN) -> str:
    """Return the factors that are first in an order, each by the value of it that does most."""
    usable = varied[varied[column].notna()].sort_values(column, ascending=False)
    first = usable.drop_duplicates("factor").head(shown)
    return listed([f"{name_of(line)} ({_amount(line, column)})" for _, line in first.iterrows()])


def _amount(line: pd.Series[Any], column: str) -> str:
    wrong = f", {line['wrong']} of {line['cases']} outcomes wrong" if line["worse"] else ""
    return part(line[column]) + wrong


def findings(lines: pd.DataFrame) -> str:
    """Return the findings in sentences, a line each."""
    sentences = [
        sentence for engine in lines["engine"].unique() for sentence in of_engine(lines, engine)
    ]
    both = [f"{engine} {still} and {moved}" for engine, still, moved in frames(lines)]
    sentences += [f"{FRAMES}: {'; '.join(both)}."] if both else []
    return "\n".join(sentences)


def of_engine(lines: pd.DataFrame, engine: str) -> list[str]:
    """Return the sentences about one engine."""
    sentences = [overview(lines, engine)]
    mine = lines[lines["engine"] == engine]
    sentences += [
        f"Rule, {engine}. {rule.words}. Error, median and largest, without it {without}; with it "
        f"{with_it}."
        for rule, without, with_it in rules(lines, engine)
    ]
    for _, line in mine[mine["trap"] != ""].iterrows():
        sentences.append(
            f"Trap: {name_of(line)} ({FROM[line['preset']]}): {line['trap']}; largest error "
            f"{errors_of(line)}{line['message'] and ', ' + line['message']}."
        )
    return sentences


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
            found.append((rule, both_errors(pair[0]), both_errors(pair[1])))
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
