"""What the page of the engines says of each, and what its users would object to its figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeAlias

import pandas as pd

from engines import ENGINES
from engines.declaration import AT_REST, RECOMMENDED, Stepping
from engines.disclosure import Help
from engines.parts.factors import AS_BEST, BEST, DEFAULT, LEFT_OUT, OWN_STEP, OWN_STEPS
from engines.registry import OWN
from studies import contact
from studies.cases.variants import STILL
from studies.measures.presets import preset_of, told
from studies.measures.published import needed
from studies.measures.words import by_value, capital, listed, part, right_of
from studies.scenes.told import LATE_M

Line: TypeAlias = "Mapping[Any, Any] | pd.Series[Any]"
"""A line of a table."""

TITLES = {name: ENGINES[name].title for name in OWN}


def once(rows: Iterator[Sequence[str]]) -> list[list[str]]:
    """Return rows whose first cell is left empty where it is that of the row before."""
    found: list[list[str]] = []
    before = ""
    for first, *others in rows:
        found.append(["" if first == before else first, *others])
        before = first
    return found


def variants(published: Path) -> pd.DataFrame:
    """Return the published variants of contacts: variants.csv."""
    return contact.STUDY.read(published / "contact", "variants")


def variant_of(
    lines: pd.DataFrame, engine: str, preset: str, factor: str = "", level: str = ""
) -> Line | None:
    """Return the line of a preset, or of a variant of it; None where there is none."""
    wanted = (lines["engine"] == engine) & (lines["preset"] == preset)
    wanted &= lines["factor"] == factor
    if level:
        wanted &= lines["level"] == level
    return lines[wanted].iloc[0] if wanted.any() else None


def error_words(line: Line, columns: Sequence[str] = ("max_error",)) -> str:
    """Return the largest or other errors, and how many of all cases are wrong, in few words."""
    if line["failed"] == line["cases"]:
        return "no result"
    errors = ", ".join(part(line[name]) for name in columns)
    broken = int(line["failed"]) + int(line["wrong"])
    return errors + (f", {broken} of {line['cases']} wrong" if broken else "")


def prices(lines: pd.DataFrame, engine: str) -> dict[str, str]:
    """Return the largest error of an engine's best preset without each of what it is helped by.

    In words, by the name of a `Help`; by "" that of the preset as it is, by "STEPS" that with equal
    steps.
    """
    best = ENGINES[engine].best.name
    mine = lines[(lines["engine"] == engine) & (lines["preset"] == best)]
    asked = mine[mine["factor"].isin(["", LEFT_OUT])]
    found = {line["level"] if line["factor"] else "": line for _, line in asked.iterrows()}
    words = {name.upper(): error_words(line) for name, line in found.items()}
    equal = variant_of(lines, engine, BEST)
    return words | ({} if equal is None else {"STEPS": error_words(equal)})


def helps(lines: pd.DataFrame) -> tuple[list[str], list[list[str]]]:
    """Return heads, and what each adapter does for landing with the largest error without it."""
    engines = [name for name in OWN if ENGINES[name].best.stepping is Stepping.LANDING]
    helped = {name: ENGINES[name].best.helped_by for name in engines}
    price = {name: prices(lines, name) for name in engines}
    heads = ["landing without", *map(TITLES.__getitem__, engines)]
    whole = ["**All of it**", *(f"**{price[name].get('', '-')}**" for name in engines)]
    rows = [
        [
            capital(each.value),
            *(
                price[name].get(each.name, "yes") if each in helped[name] else "–"
                for name in engines
            ),
        ]
        for each in Help
        if any(each in given for given in helped.values())
    ]
    return heads, [whole, *rows]


def rules(lines: pd.DataFrame) -> Iterator[tuple[str, str, str, str]]:
    """Yield the engine and each rule that helps, and the median and largest error without and with.

    One helps if fewer outcomes are wrong with it, or as many and the median error is smaller. Rules
    of which a variant was not run are left out.
    """
    for engine in OWN:
        for rule in ENGINES[engine].rules:
            plain = variant_of(lines, engine, rule.preset)
            other = variant_of(lines, engine, rule.preset, rule.factor, rule.level)
            if plain is not None and other is not None:
                pair = (plain, other) if rule.kept else (other, plain)
                wrong, kept = ((it["failed"] + it["wrong"], it["median_error"]) for it in pair)
                without, with_it = (error_words(one, ("median_error", "max_error")) for one in pair)
                if kept < wrong:
                    yield TITLES[engine], rule.words, without, with_it


def frames(lines: pd.DataFrame) -> Iterator[tuple[str, str, str]]:
    """Yield what the defaults err by where a body force moves the block, and where the base."""
    for engine in lines["engine"].unique():
        still, moved = (
            variant_of(lines, engine, DEFAULT, OWN_STEPS, level) for level in (STILL, OWN_STEP)
        )
        if still is not None and moved is not None:
            yield ENGINES[engine].title, error_words(still), error_words(moved)


def documented() -> Iterator[tuple[str, ...]]:
    """Yield what the documentation of each engine sets or recommends, and where it says so."""
    for name in OWN:
        for use in ENGINES[name].presets:
            yield from ((f"{TITLES[name]} `:{use.name}`", *source) for source in use.documented)


def beside_own() -> str:
    """Return which settings of "naive" are not the libraries' own, and what those would be."""
    naive = {TITLES[name]: ENGINES[name].preset(DEFAULT) for name in OWN}
    said = []
    for name in dict.fromkeys(name for preset in naive.values() for name in preset.own):
        own = {title: preset for title, preset in naive.items() if name in preset.own}
        (value,) = {getattr(preset.settings, name) for preset in own.values()}
        theirs = by_value((title, preset.own[name]) for title, preset in own.items())
        words = [f"{other} in {listed(titles)}" for other, titles in theirs.items()]
        said.append(f"`{name}` is {value}, by itself {listed(words)}")
    return "; ".join(said)


def random_fixed(published: Path) -> str:
    """Return which presets with a fixed step get random cases wrong; empty if none does."""
    compared = pd.read_csv(published / "validate" / "errors.csv")
    words = [
        f"`{source}` gets {right_of(rows)} outcomes right"
        for source, rows in compared.groupby("source", sort=False)
        if preset_of(str(source)) == "fixed" and not rows["agrees"].all()
    ]
    return listed(words) if words else ""


SHOWN = 2
"""Single settings that are shown of each engine, of all that were tried."""

Tried = tuple[str, str, str, str]
"""What was tried, on which cases, and the errors without and with it."""


def objections(published: Path, presets: pd.DataFrame) -> Iterator[tuple[str, ...]]:
    """Yield an engine's title and what was tried in its favour, beside it as documented.

    presets has a line for each preset over the paper's cases.
    """
    own = contact.STUDY.read(published / "contact", "own-steps")
    steps = pd.read_csv(published / "precision" / "work-precision.csv")
    blocks = pd.read_csv(published / "scenes" / "block-summary.csv")
    for engine in OWN:
        for tried in (
            *_presets(presets, engine),
            *_settings(own, engine),
            *_finest(steps, engine),
            *_floor(blocks, engine),
        ):
            yield TITLES[engine], *tried


def slippery() -> str:
    """Return in how many of the paper's cases a block slides at each library's own friction."""
    own = [(TITLES[name], ENGINES[name].preset(DEFAULT).own.get("friction")) for name in OWN]
    return "; ".join(
        f"{(needed() > friction).sum()} of {needed().size} in {listed(titles)} ({friction:g})"
        for friction, titles in by_value(own).items()
        if friction is not None
    )


def _presets(lines: pd.DataFrame, engine: str) -> Iterator[Tried]:
    mine = {line["preset"]: line for _, line in lines[lines["engine"] == engine].iterrows()}
    for name in (RECOMMENDED, AT_REST):
        if {name, DEFAULT} <= mine.keys():
            without, with_it = mine[DEFAULT], mine[name]
            cases = f"{without['cases']} cases"
            yield told(name).short, cases, _of_preset(without), _of_preset(with_it)


def _of_preset(line: Line) -> str:
    return _errors(line["median"], line["max"], line["cases"] - line["right"])


def _settings(lines: pd.DataFrame, engine: str) -> Iterator[Tried]:
    """Yield the single settings that lower the median error most without more wrong outcomes."""
    without = variant_of(lines, engine, DEFAULT)
    if without is None:
        return
    mine = (lines["engine"] == engine) & (lines["preset"] == DEFAULT)
    varied = lines[mine & (lines["factor"] != "") & (lines["trap"] == "")]
    better = varied[
        (varied["failed"] + varied["wrong"] <= without["failed"] + without["wrong"])
        & (varied["median_error"] < without["median_error"])
    ]
    best = better.sort_values("median_error")
    alike = best["median_error"].map("{:.3e}".format)  # two names of one thing
    best = best[~alike.duplicated() & ~best["factor"].duplicated()]
    for line in best.head(SHOWN).to_dict("records"):
        name = f"{line['factor']}: {line['level']}".replace(AS_BEST, f"as `:{BEST}`")
        yield name, f"{without['cases']} of them", _of_variant(without), _of_variant(line)


def _of_variant(line: Line) -> str:
    return _errors(line["median_error"], line["max_error"], line["failed"] + line["wrong"])


def _finest(lines: pd.DataFrame, engine: str) -> Iterator[Tried]:
    """Yield what the finest step of all leaves of the errors, beside the coarsest usable one."""
    mine = lines[(lines["method"] == f"{engine} {DEFAULT}") & (lines["set"] == "typical")]
    mine = mine[mine["median_error"].notna()].sort_values("value")
    if len(mine) > 1:
        finest, *_, coarsest = mine.to_dict("records")
        said = f"p dt = {finest['value']:g} instead of {coarsest['value']:g}"
        before, after = (
            _errors(each["median_error"], each["max_error"], each["failed"])
            for each in (coarsest, finest)
        )
        yield said, f"{finest['cases']} of them", before, after


def _floor(blocks: pd.DataFrame, engine: str) -> Iterator[Tried]:
    """Yield what is left of the error where the floor's lag is not held against the engine."""
    for line in blocks[blocks["source"] == f"{engine}:{DEFAULT}"].to_dict("records"):
        if line["floor_lag_m"] > LATE_M:
            tried, cases = "exact answer on the floor as it moved", f"{line['blocks']} pulses"
            yield tried, cases, part(line["median_error"]), part(line["median_own_error"])


def _errors(median: float, largest: float, wrong: int) -> str:
    if math.isnan(median):
        return "no result"
    return f"{part(median)}, max {part(largest)}" + (f", {wrong} wrong" if wrong else "")
