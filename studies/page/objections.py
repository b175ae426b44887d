"""What users of an engine would object to its figures as documented, and what comes of it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, cast

import pandas as pd

from engines import ENGINES
from engines.declaration import AT_REST, RECOMMENDED
from engines.parts.factors import AS_BEST, BEST, DEFAULT
from engines.registry import OWN
from studies.contact.report import changed, name_of
from studies.contact.report import read as read_variants
from studies.measures.presets import told
from studies.measures.slippery import needed
from studies.measures.words import listed, part
from studies.page.markdown import table
from studies.scenes.findings import LATE_M

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
    variants = read_variants(published / "contact" / "own-steps.csv")
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
    heads = ("engine", "what its users would try", "on", "as documented", "with it")
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
        yield name, _some(without["cases"]), _of_variant(without), _of_variant(line)


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
        yield said, _some(finest["cases"]), before, after


def _floor(blocks: pd.DataFrame, engine: str) -> Iterator[Tried]:
    """Yield what is left of the error where the floor's lag is not held against the engine."""
    for line in _rows(blocks[blocks["source"] == f"{engine}:{DEFAULT}"]):
        if line["floor_lag_m"] > LATE_M:
            tried, cases = "exact answer on the floor as it moved", f"{line['blocks']} pulses"
            yield tried, cases, part(line["median_error"]), part(line["median_own_error"])


def _some(cases: int) -> str:
    return f"{cases} of them"


def _rows(lines: pd.DataFrame) -> list[Line]:
    return cast(list[Line], lines.to_dict("records"))


def _errors(median: float, largest: float, wrong: int) -> str:
    if math.isnan(median):
        return "no result"
    return f"{part(median)}, max {part(largest)}" + (f", {wrong} wrong" if wrong else "")
