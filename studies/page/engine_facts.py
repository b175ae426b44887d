"""What the page of the engines says of each, and what its users would object to its figures."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, cast

import pandas as pd

from engines import ENGINES
from engines.declaration import AT_REST, RECOMMENDED, Preset, Stepping
from engines.disclosure import Help
from engines.parts.factors import AS_BEST, BEST, DEFAULT
from engines.registry import OWN
from engines.troubles import TROUBLES
from studies import contact
from studies.contact.told import changed, frames, name_of, prices, rules
from studies.measures.presets import preset_of, told
from studies.measures.published import needed
from studies.measures.words import capital, listed, part, right_of
from studies.page.facts import table
from studies.scenes.told import LATE_M


def helps(published: Path) -> str:
    """Return what each engine's adapter does for landing, and the largest error without it."""
    lines = _variants(published)
    engines = [name for name in OWN if ENGINES[name].best.stepping is Stepping.LANDING]
    helped = {name: ENGINES[name].best.helped_by for name in engines}
    price = {name: prices(lines, name) for name in engines}
    rows = [
        (
            capital(each.value),
            *(
                price[name].get(each.name, "yes") if each in helped[name] else "–"
                for name in engines
            ),
        )
        for each in Help
    ]
    whole = ("**All of it**", *(f"**{price[name].get('', '-')}**" for name in engines))
    heads = ("landing without", *(ENGINES[name].title for name in engines))
    return table(heads, [whole, *(row for row in rows if set(row[1:]) != {"–"})])


def rules_of_engines(published: Path) -> str:
    """Return what users of each engine should know first, and what it is worth."""
    lines = _variants(published)
    rows = [
        (ENGINES[name].title if not place else "", rule.words, *errors)
        for name in OWN
        for place, (rule, *errors) in enumerate(rules(lines, name))
    ]
    return table(("engine", "rule", "error without it", "with it"), rows)


def own_tests(published: Path) -> str:
    """Return what tests of engines' authors pass, the exact number, and what is found here."""
    lines = pd.read_csv(published / "literature" / "peers.csv").fillna({"source": ""})
    rows = []
    for test, group in lines.groupby("test", sort=False):
        line, low, high = group.iloc[0], group["low"].iloc[0], group["high"].iloc[0]
        passes = f"{low:.5g} or more" if math.isinf(high) else f"{low:.5g} to {high:.5g}"
        exact = f"{line['exact']:.5g}" + ("" if line["exact_passes"] else ", which fails")
        found = "<br>".join(
            f"`{row['source']}` {row['found']:.5g}" for _, row in group.iterrows() if row["source"]
        )
        rows.append((str(test), line["quantity"], passes, exact, found or "–", line["says"]))
    return table(("test", "of", "passes", "exact", "here", "what else passes"), rows)


def frames_of_engines(published: Path) -> str:
    """Return what the defaults err by where a body force moves the block, and where the base."""
    rows = [(ENGINES[engine].title, *errors) for engine, *errors in frames(_variants(published))]
    return table(("engine", "body force", "moving base"), rows) if rows else ""


def _variants(published: Path) -> pd.DataFrame:
    return contact.STUDY.read(published / "contact", "variants")


def documented() -> str:
    """Return what the documentation of each engine sets or recommends, and where it says so."""
    rows = [
        (f"{ENGINES[name].title} `:{use.name}`" if not place else "", *source)
        for name in OWN
        for use in ENGINES[name].presets
        for place, source in enumerate(use.documented)
    ]
    return table(("engine and preset", "setting", "value", "where it says so"), rows)


def beside_own() -> str:
    """Return which settings of "naive" are not the libraries' own, and what those would be."""
    naive = {ENGINES[name].title: ENGINES[name].preset("naive") for name in OWN}
    names = dict.fromkeys(name for preset in naive.values() for name in preset.own)
    return "; ".join(_beside(name, naive) for name in names)


def _beside(name: str, naive: Mapping[str, Preset]) -> str:
    own = {title: preset for title, preset in naive.items() if name in preset.own}
    (value,) = {getattr(preset.settings, name) for preset in own.values()}
    titles: dict[Any, list[str]] = {}
    for title, preset in own.items():
        titles.setdefault(preset.own[name], []).append(title)
    theirs = [f"{theirs} in {listed(group)}" for theirs, group in titles.items()]
    return f"`{name}` is {value}, by itself {listed(theirs)}"


def random_fixed(published: Path) -> str:
    """Return which presets with a fixed step get random cases wrong; empty if none does."""
    compared = pd.read_csv(published / "validate" / "errors.csv")
    words = [
        f"`{source}` gets {right_of(rows)} outcomes right"
        for source, rows in compared.groupby("source", sort=False)
        if preset_of(str(source)) == "fixed" and not rows["agrees"].all()
    ]
    return listed(words) if words else ""


def troubles() -> str:
    """Return what goes wrong in each engine, by which mechanism, and the script that shows it."""
    rows = [
        (
            ENGINES[each.engine].title,
            each.title,
            each.kind,
            each.mechanism,
            f"[{each.script}](../../engines/troubles/{each.script})",
        )
        for each in sorted(TROUBLES, key=lambda each: list(ENGINES).index(each.engine))
    ]
    return table(("engine", "what happens", "kind", "mechanism", "script"), rows)


SHOWN = 2
"""Single settings that are shown of each engine, of all that were tried."""

Line = dict[str, Any]
Tried = tuple[str, str, str, str]
"""What was tried, on which cases, and the errors without and with it."""


def objections(published: Path, presets: pd.DataFrame) -> str:
    """Return what was tried in favour of each engine as documented, as a table of Markdown.

    Parameters
    ----------
    published : Path
        The folders of the studies.
    presets : DataFrame
        A line for each preset over the paper's cases.
    """
    variants = contact.STUDY.read(published / "contact", "own-steps")
    steps = pd.read_csv(published / "precision" / "work-precision.csv")
    blocks = pd.read_csv(published / "scenes" / "block-summary.csv")
    rows = []
    for engine in OWN:
        found = [
            *_presets(presets, engine),
            *_settings(variants, engine),
            *_finest(steps, engine),
            *_floor(blocks, engine),
        ]
        title = ENGINES[engine].title
        rows += [(title if not place else "", *tried) for place, tried in enumerate(found)]
    heads = ("engine", "what its users would try", "on", "without it", "with it")
    return table(heads, rows)


def slippery() -> str:
    """Return in how many of the paper's cases a block slides at each library's own friction."""
    own: dict[float, list[str]] = {}
    for engine in OWN:
        friction = ENGINES[engine].preset(DEFAULT).own.get("friction")
        if friction is not None:
            own.setdefault(friction, []).append(ENGINES[engine].title)
    said = [
        f"{(needed() > friction).sum()} of {needed().size} in {listed(titles)} ({friction:g})"
        for friction, titles in own.items()
    ]
    return (
        "At the library's own friction a block slides before or while it rocks, by the exact "
        f"solution's own forces: {'; '.join(said)}."
    )


def _presets(lines: pd.DataFrame, engine: str) -> Iterator[Tried]:
    mine = {line["preset"]: line for line in _rows(lines[lines["engine"] == engine])}
    for name in (RECOMMENDED, AT_REST):
        if {name, DEFAULT} <= mine.keys():
            without, with_it = mine[DEFAULT], mine[name]
            cases = f"{without['cases']} cases"
            yield told(name).short, cases, _of_preset(without), _of_preset(with_it)


def _of_preset(line: Line) -> str:
    return _errors(line["median"], line["max"], line["cases"] - line["right"])


def _settings(lines: pd.DataFrame, engine: str) -> Iterator[Tried]:
    """Yield the single settings that lower the median error most without more wrong outcomes."""
    plain = _rows(lines[(lines["engine"] == engine) & (lines["factor"] == "")])
    if not plain:
        return
    (without,) = plain
    varied = changed(lines, engine, DEFAULT)
    better = varied[
        (varied["failed"] + varied["wrong"] <= without["failed"] + without["wrong"])
        & (varied["median_error"] < without["median_error"])
    ]
    best = better[better["trap"] == ""].sort_values("median_error")
    alike = best["median_error"].map("{:.3e}".format)  # two names of one thing
    for line in _rows(best[~alike.duplicated() & ~best["factor"].duplicated()].head(SHOWN)):
        name = name_of(pd.Series(line)).replace(AS_BEST, f"as `:{BEST}`")
        yield name, f"{without['cases']} of them", _of_variant(without), _of_variant(line)


def _of_variant(line: Line) -> str:
    return _errors(line["median_error"], line["max_error"], line["failed"] + line["wrong"])


def _finest(lines: pd.DataFrame, engine: str) -> Iterator[Tried]:
    """Yield what the finest step of all leaves of the errors, beside the coarsest usable one."""
    mine = lines[(lines["method"] == f"{engine} {DEFAULT}") & (lines["set"] == "typical")]
    mine = mine[mine["median_error"].notna()].sort_values("value")
    if len(mine) > 1:
        finest, *_, coarsest = _rows(mine)
        said = f"p dt = {finest['value']:g} instead of {coarsest['value']:g}"
        before, after = (
            _errors(each["median_error"], each["max_error"], each["failed"])
            for each in (coarsest, finest)
        )
        yield said, f"{finest['cases']} of them", before, after


def _floor(blocks: pd.DataFrame, engine: str) -> Iterator[Tried]:
    """Yield what is left of the error where the floor's lag is not held against the engine."""
    for line in _rows(blocks[blocks["source"] == f"{engine}:{DEFAULT}"]):
        if line["floor_lag_m"] > LATE_M:
            tried, cases = "exact answer on the floor as it moved", f"{line['blocks']} pulses"
            yield tried, cases, part(line["median_error"]), part(line["median_own_error"])


def _rows(lines: pd.DataFrame) -> list[Line]:
    return cast(list[Line], lines.to_dict("records"))


def _errors(median: float, largest: float, wrong: int) -> str:
    if math.isnan(median):
        return "no result"
    return f"{part(median)}, max {part(largest)}" + (f", {wrong} wrong" if wrong else "")
