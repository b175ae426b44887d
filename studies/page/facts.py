"""What the README and the pages of the published results say, from the published tables alone."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeAlias

import pandas as pd

from engines import ENGINES
from engines.declaration import AT_REST, Help, Stepping
from engines.factors import BEST, DEFAULT, LEFT_OUT
from engines.registry import OWN
from engines.run.export import broken
from studies import advise
from studies.kit.identity import NOT_INSTALLED
from studies.kit.say import capital, duration, listed, number, part, signed
from studies.kit.store import engines_of, provenance_of
from studies.kit.tables import table_in
from studies.measures.costs import cost_text
from studies.measures.presets import titled
from studies.measures.published import TARGETS
from studies.measures.wrongness import KINDS
from studies.sweep import over_all, preset_table

Line: TypeAlias = "Mapping[Any, Any] | pd.Series[Any]"
"""A line of a table."""
Table: TypeAlias = tuple[list[str], list[list[str]]]
"""Heads, and the cells of each row."""
CASE = ("figure", "aspect", "width_m", "omega_over_p")
"""Columns that tell the paper's cases apart."""
HEADS = {
    **{"ms_a_frame": "a case", "ms_a_slide": "a case", "max_error": "largest error"},
    "floor": "floor moved by",
    **{"median_difference": "median, of θcr", "max_difference": "largest, of θcr"},
}
"""Column of a scene's summary -> its head, where that is another."""
TITLES = {name: ENGINES[name].title for name in OWN}


def presets(published: Path) -> pd.DataFrame:
    """Return a line for each preset and engine over the paper's cases."""
    known = [table_in(published / name, "summary") for name in ("presets", "sweep")]
    lines = pd.concat([preset_table(over_all(each)) for each in known if len(each)])
    return lines if lines.empty else lines.drop_duplicates("source", ignore_index=True)


def by_engine(published: Path) -> list[list[str]]:
    """Return the cells of the README's table, a row for each engine."""
    rows = []
    for name, lines in presets(published).groupby("engine", sort=False):
        known = {str(line["preset"]): line for line in lines.to_dict("records")}
        cells = [f"<b>{TITLES[str(name)]}</b>"]
        moving, rests, tuned = (known[preset] for preset in (DEFAULT, AT_REST, "tuned"))
        cells += [wrong(moving), part(moving["median"]), part(moving["share"])]
        cells += [wrong(rests), part(rests["median"])]
        best = ENGINES[str(name)].best
        cells += [wrong(tuned), part(tuned["max"]), f"{tuned['ms']:.0f} ms"]
        if best.name == "tuned":
            cells += ["–", "–"]
        else:
            line, own = known[best.name], "" if best.stepping is Stepping.LANDING else "¹"
            cells += [part(line["max"]) + own, f"{line['ms']:.0f} ms"]
        rows.append(cells)
    return rows


def wrong(line: Line) -> str:
    """Return how many outcomes of a line are wrong."""
    return str(sum(line[kind] for kind in KINDS))


def compared(published: Path) -> dict[str, int]:
    """Return how many of the paper's blocks survive, by the exact solution, and turn by little."""
    rows = table_in(published / "sweep", "sweep")
    peaks = rows.loc[(rows["source"] == "exact") & (rows["outcome"] == "rocked"), "peak_ratio"]
    return {"survive": len(peaks), "little": int((peaks < 0.05).sum())}


def in_scene(published: Path, name: str) -> Table:
    """Return a summary of a scene's engines, its numbers in words."""
    lines = table_in(published / "scenes", name)
    heads = [str(head) for head in lines if not str(head).startswith("p90")]
    rows = [[_cell(head, line[head]) for head in heads] for line in lines.to_dict("records")]
    return [HEADS.get(head, head.removesuffix("_m").replace("_", " ")) for head in heads], rows


def _cell(head: str, value: Any) -> str:
    if not isinstance(value, float):
        return titled(value) if head == "source" else str(value)
    if math.isnan(value):
        return "–"
    if head.startswith("ms_"):
        return duration(1e-3 * value)
    if head.startswith("carried"):
        return f"{round(100.0 * value, 1) + 0.0:.1f} %"
    if head.endswith("_m"):
        return f"{1e3 * value:.3g} mm" if value >= 1e-6 else "0"
    return part(value)


def advised(published: Path) -> list[list[str]]:
    """Return the cheapest published setting for each error, a row for each error."""
    rows, lines = [], advise.cheapest(published, [*TITLES], TARGETS)
    for target, group in lines.groupby("target", sort=False):
        line = group.nsmallest(1, "wall_s").iloc[0]
        fixed = ENGINES[line["engine"]].preset(line["preset"]).stepping is Stepping.FIXED
        how = f"{'p dt =' if fixed else 'accuracy'} {line['value']}"
        source = f"`{line['engine']}:{line['preset']}`, {how}"
        cost = cost_text(line["wall_s"], line["runs"])
        rows.append([f"{100.0 * float(str(target)):g} %", source, cost])
    return rows


def pasted(published: Path) -> list[dict[str, Any]]:
    """Return what pasted lines are worth, for each engine and step, and the lines."""
    known = table_in(published / "advice", "lines", "literal")
    found: list[dict[str, Any]] = []
    for engine, dt_s, *both in advise.pairs(table_in(published / "advice", "advice")):
        mine = known[(known["engine"] == engine) & (known["dt_s"] == dt_s)]
        place, title = f"{engine}-{1e6 * dt_s:.0f}", f"{TITLES[engine]}, {duration(dt_s)}"
        cells = [
            (part(line["median_error"]), part(line["max_error"]), part(line["median_difference"]),
             wrong(line), part(line["ill_max_error"]), number(line["yaw_deg"]),
             part(line["slip_widths"]), duration(line["wall_s"])) for line in both
        ]  # fmt: skip
        found.append(
            {
                **{"engine": engine, "place": place, "title": title, "boxes": both[0]["cases"]},
                "calm": both[1]["survivors"],
                "own": all(each["engine"] != engine for each in found),
                "cells": [f"[{title}](#{place})", *map(" → ".join, zip(*cells, strict=True))],
                "text": "\n".join(row for line in mine["literal"] for row in broken(line)),
            }
        )
    return found


def by_kind(published: Path) -> list[list[str]]:
    """Return outcomes and typical errors before and after, by what moves a box."""
    lines = advise.by_kind(table_in(published / "advice", "kinds"))
    cells = []
    for kind, both in lines.groupby("kind", sort=False):
        wrong, cases = both["wrong"].map(str), both["cases"].max()
        errors = (both[name].map(part) for name in ("median_error", "max_error"))
        shown = map(" → ".join, (wrong, *errors))
        cells.append([advise.IN_WORDS[str(kind)], str(cases), *shown])
    return cells


def unadvised(published: Path) -> dict[str, str]:
    """Return why pasted lines are not advised, of each engine where they are not."""
    bad = advise.unadvised(table_in(published / "advice", "advice"))
    return {TITLES[engine]: why for engine, why in bad.items()}


def lags(published: Path) -> list[list[str]]:
    """Return how much of the defaults' error is a moving floor's, a row for each engine."""
    rows, case = table_in(published / "presets", "sweep"), [*CASE]
    rows = rows[(rows["outcome"] == "rocked") & (rows["peak_ratio"] > 0.0)]
    peaks = rows.pivot(index=case, columns="source", values="peak_ratio")
    cells = []
    for name, title in TITLES.items():
        both = [f"{name}:{preset}" for preset in (DEFAULT, AT_REST)]
        if {*both} <= {*peaks}:
            errors = peaks[both].div(peaks["exact"], axis=0).dropna() - 1.0
            apart = (errors[both[0]] - errors[both[1]]).abs().median()
            cells.append([title, *map(signed, errors.median()), part(apart)])
    return cells


def made(published: Path) -> dict[str, str]:
    """Return on what machine, with what versions and when the paper's cases were run."""
    # the sweep in another folder, where it was the first run after an installation
    sweep, first = provenance_of(published / "sweep"), published / "sweep" / "first.json"
    others = [json.loads(first.read_text(encoding="utf-8"))] if first.is_file() else []
    versions = engines_of(provenance_of(published / "presets") or sweep)
    packages = [name for one in OWN for name in ENGINES[one].packages if name in versions]
    known = [name for name in packages if versions[name] != NOT_INSTALLED]
    return {
        "engines": listed([f"{name} {versions[name]}" for name in known]),
        "machine": f"{sweep['machine']['cpu']}, {sweep['machine']['cores']} cores",
        "date": sweep["runs"][-1]["start"][:10],
        "sweep": lasts(sweep, *others),
    }


def lasts(*records: Mapping[str, Any]) -> str:
    """Return how long the sweep takes, at the first run after an installation and later."""
    every = [run for record in records for run in record["runs"]]
    runs = [run for run in every if run.get("computed") == run.get("rows")]  # whole ones
    times = {bool(run.get("first")): f"{run['duration_s']:.0f} s" for run in runs}
    first, later = (times.get(kind, "a time that was not measured") for kind in (True, False))
    return f"{first} the first time, when its functions are compiled, then {later}"


def documented() -> Iterator[tuple[str, ...]]:
    """Yield what the documentation of each engine sets or recommends, and where it says so."""
    for name in OWN:
        for use in ENGINES[name].presets:
            for row, source in enumerate(use.documented):
                yield (f"{TITLES[name]} `:{use.name}`" if row == 0 else "", *source)


def _error(line: Line) -> str:
    """Return the largest error of a variant, and how many of its cases are wrong."""
    if line["failed"] == line["cases"]:
        return "no result"
    broken = int(line["failed"]) + int(line["wrong"])
    return part(line["max_error"]) + (f", {broken} of {line['cases']} wrong" if broken else "")


def helps(published: Path) -> Table:
    """Return the largest error of landing in each engine, and without each thing it does for it."""
    lines = table_in(published / "contact", "variants", "factor", "level", "trap")
    engines = [name for name in OWN if ENGINES[name].best.stepping is Stepping.LANDING]
    price = {name: _prices(lines, name) for name in engines}
    helped = {name: ENGINES[name].best.helped_by for name in engines}
    rows = [["**All of it**", *(f"**{price[name].get('', '-')}**" for name in engines)]]
    for each in Help:
        cells = [
            price[name].get(each.name, "yes") if each in helped[name] else "–" for name in engines
        ]
        if {*cells} != {"–"}:
            rows.append([capital(each.value), *cells])
    return ["landing without", *(TITLES[name] for name in engines)], rows


def _prices(lines: pd.DataFrame, engine: str) -> dict[str, str]:
    words = {}
    for line in lines[lines["engine"] == engine].to_dict("records"):
        if line["preset"] == ENGINES[engine].best.name and line["factor"] in ("", LEFT_OUT):
            words[line["level"].upper() if line["factor"] else ""] = _error(line)
        elif line["preset"] == BEST and not line["factor"]:
            words["STEPS"] = _error(line)
    return words
