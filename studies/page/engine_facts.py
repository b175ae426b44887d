"""What the page of the engines says of each, from declarations and the published tables alone."""

from __future__ import annotations

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from engines import ENGINES
from engines.declaration import Help, Preset, Stepping
from engines.registry import OWN
from engines.troubles import TROUBLES
from studies.contact.report import frames, prices, rules
from studies.contact.report import read as read_variants
from studies.measures.presets import preset_of
from studies.measures.words import capital, listed, right_of
from studies.page.markdown import table


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
    return read_variants(published / "contact" / "variants.csv")


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
        (ENGINES[each.engine].title, each.title, each.kind, each.mechanism, _script(each.script))
        for each in sorted(TROUBLES, key=lambda each: list(ENGINES).index(each.engine))
    ]
    return table(("engine", "what happens", "kind", "mechanism", "script"), rows)


def _script(name: str) -> str:
    return f"[{name}](../../engines/troubles/{name})"
