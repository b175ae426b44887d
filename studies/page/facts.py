"""What README.md and the page of the published results say, from the published tables alone."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd

from analytic.models import MODELS
from engines import ENGINES
from studies.advise.words import setting_text
from studies.catalogue import CHAPTERS
from studies.old import provenance
from studies.old.study import Chapter, Study
from studies.old.tables import table_in
from studies.measures.claims import TABLE, Finding, read_findings, said_once
from studies.measures.costs import LEAST_RUNS, cost_text
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.posed import Posed, posed
from studies.measures.presets import engine_of, in_order, is_engine
from studies.measures.presets import told as as_told
from studies.measures.words import duration, in_kinds, listed, out_of, part, per_cent
from studies.measures.wrongness import KINDS
from studies.precision.choices import NEAR, TYPICAL, choices
from studies.sources.registry import grouped
from studies.sweep.study import linearized, preset_table, whole
from studies.sweep.study import read as read_sweep

PRESETS_FROM = ("presets", "sweep")
"""Folders whose summaries hold the presets of the engines."""


def chapter_of(published: Path, study: Study, chapter: Chapter) -> dict[str, Any]:
    """Return a chapter in words, and the names of what it left in its folder.

    Returns
    -------
    dict
        folder, question, claim, command; statements that were tested; pictures: names of files,
        each with what is seen in it; texts: names of files.
    """
    folder = published / chapter.folder
    return {
        "folder": chapter.folder,
        "question": chapter.question,
        "claim": study.finding(folder),
        "command": " ".join(["rocking", *command_of(study, chapter, folder)]),
        "pictures": [
            (path.name, study.captions.get(path.stem, path.stem))
            for path in sorted(folder.glob("*.png"))
        ],
        "texts": sorted(path.name for path in folder.glob("*.txt")),
        "statements": statements_of(folder),
    }


def command_of(study: Study, chapter: Chapter, folder: Path) -> list[str]:
    """Return the words after `rocking` that make a published folder: with all who answer in it."""
    words, parameters = study.command_line(chapter, Path("DIR"), full=True), study.parameters
    option = next((name for name in ("sources", "engines") if name in parameters), "")
    answered = list(provenance.record_of(folder).get("made", {}).get("rows", {}))
    usual = parameters[option].default if option else None
    if not answered or usual is None or f"--{option}" in words:
        return words
    if all(map(is_engine, usual)):
        answered = list(filter(is_engine, answered))
    elif not set(answered).intersection(MODELS):  # they have no rows of their own
        answered = [*filter(MODELS.__contains__, usual), *answered]
    if option == "engines":
        answered = list(dict.fromkeys(map(engine_of, answered)))
    if set(answered) == set(usual):
        return words
    return [*words, f"--{option}", *(grouped(answered) if option == "sources" else answered)]


def statements_of(folder: Path) -> list[Finding]:
    """Return the statements that a study tested; what it could not test is no finding."""
    if not (folder / TABLE).is_file():
        return []
    return said_once(item for item in read_findings(folder) if item.holds is not None)


def chapters(published: Path) -> list[dict[str, Any]]:
    """Return every published chapter in words."""
    return [
        chapter_of(published, *place) for place in CHAPTERS if is_published(published, place[1])
    ]


def is_published(published: Path, chapter: Chapter) -> bool:
    """Say whether a chapter has published results."""
    return (published / chapter.folder / "provenance.json").is_file()


def missing(published: Path) -> list[str]:
    """Return the folders of the chapters without published results."""
    return [each.folder for _, each in CHAPTERS if not is_published(published, each)]


def presets(published: Path) -> pd.DataFrame:
    """Return a line for each preset and engine over the paper's cases, of what a folder holds."""
    lines = pd.concat([preset_table(whole(folder)) for folder in _with_presets(published)])
    return lines if lines.empty else lines.drop_duplicates("source", ignore_index=True)


def asked(published: Path) -> Posed:
    """Return what the engines' presets were asked of the paper's cases."""
    return posed(read_sweep(_with_presets(published)[0]))


def _with_presets(published: Path) -> list[Path]:
    folders = [published / name for name in PRESETS_FROM]
    return [folder for folder in folders if (folder / "summary.csv").is_file()]


def shared(lines: pd.DataFrame) -> list[str]:
    """Return the presets that several engines have, in order; all, where there is none such."""
    counts = lines["preset"].value_counts()
    return in_order(counts.index[counts > 1] if counts.max() > 1 else counts.index)


def by_preset(
    lines: pd.DataFrame, say: Callable[[float], str] = part
) -> tuple[list[str], list[list[str]]]:
    """Return heads, and a row for each engine with a cell for each preset.

    Parameters
    ----------
    lines : DataFrame
        engine, preset, the kinds of wrong outcomes, median_error, largest_error and ms.
    say : callable, optional
        What says an error.
    """
    names = shared(lines)
    heads = [f"{as_told(name).short} `:{name}`" for name in names]
    rows = []
    for engine, mine in lines.groupby("engine", sort=False):
        cells = {row["preset"]: _short(row, say) for _, row in mine.iterrows()}
        alone = [f"`:{name}`<br>{cell}" for name, cell in cells.items() if name not in names]
        shown = [cells.get(name, "–") for name in names]
        if alone:
            shown[-1] = "<br>".join([*({shown[-1]} - {"–"}), *alone])
        rows.append([f"**{ENGINES[str(engine)].title}**", *shown])
    return ["", *heads], rows


def _short(row: pd.Series[Any], say: Callable[[float], str]) -> str:
    wrong = in_kinds(row).removeprefix("the ").replace(", ", "<br>").replace(" and ", "<br>")
    parts = [
        f"**{wrong}**" if any(row[list(KINDS)]) else wrong,
        f"{say(row['median_error'])}, max {say(row['largest_error'])}",
        duration(1e-3 * row["ms"]),
    ]
    if math.isnan(row["median_error"]):
        del parts[1]
    return "<br>".join(words.replace(" ", "\N{NO-BREAK SPACE}") for words in parts)


def models(published: Path) -> dict[str, str]:
    """Return which outcomes of the paper's cases each linearization gets wrong."""
    lines = linearized(whole(published / "sweep"))
    return {str(row["source"]): in_kinds(row) for _, row in lines.iterrows()}


def advised(published: Path) -> list[list[str]]:
    """Return the cheapest advice for each error, a row for each error."""
    rows = []
    for target, group in table_in(published / "advice", "advice").groupby("target", sort=False):
        best = group[group["message"] == ""].nsmallest(1, "wall_s")
        cells = [_advice(line) for _, line in best.iterrows()] or [("nothing does", "–")]
        rows.append([per_cent(float(str(target))), *cells[0]])
    return rows


def _advice(line: pd.Series[Any]) -> tuple[str, str]:
    at = setting_text(line)
    # what is advised has none off whose κ is small: the line above the table says so
    off = f"{out_of(line['random_off'], line['random_cases'])} off" if line["random_cases"] else ""
    return (f"{at}; {off}" if off else at), cost_text(line["wall_s"], line["runs"])


def choices_of(published: Path) -> dict[tuple[float, str], dict[str, Any]]:
    """Return which setting for which accuracy, as of `choices`."""
    return choices(pd.read_csv(published / "precision" / "work-precision.csv"))


def counts(published: Path) -> dict[str, int]:
    """Return how many cases the tables on the first screen are about."""
    lines = pd.read_csv(published / "precision" / "work-precision.csv")
    each = lines.groupby("set")["cases"].max()
    return {
        "paper": int(presets(published)["cases"].max()),
        "engines": presets(published)["engine"].nunique(),
        "typical": int(each[TYPICAL]),
        "near": int(each[NEAR]),
        "calm": int(WELL_CONDITIONED),
        "runs": LEAST_RUNS,
    }


def made(published: Path) -> dict[str, str]:
    """Return on what machine, with what versions and when the paper's cases were run."""
    sweep = provenance.record_of(published / "sweep")
    machine, first = sweep["machine"], published / "sweep" / FIRST
    others = [json.loads(first.read_text(encoding="utf-8"))] if first.is_file() else []
    versions = provenance.engines_of(provenance.record_of(_with_presets(published)[0]))
    asked = presets(published)["engine"].unique()
    packages = [name for engine in asked for name in ENGINES[engine].packages if name in versions]
    return {
        "engines": listed([f"{name} {versions[name]}" for name in packages]),
        "machine": f"{machine['cpu']}, {machine['cores']} cores",
        "date": sweep["runs"][-1]["start"][:10],
        "sweep": lasts(sweep, *others),
    }


FIRST = "first.json"
"""Provenance of the sweep in another folder, where it was the first run after an installation."""


def lasts(*records: Mapping[str, Any]) -> str:
    """Return how long the same command takes, at the first run after an installation and later.

    Raises
    ------
    ValueError
        If the records are of different commands, machines or versions; of an engine that one does
        not know, neither asked.
    """
    same = ("study", "version", "machine", "settings")
    engines = [
        {name: kept for name, kept in record["engines"].items() if kept != provenance.NOT_INSTALLED}
        for record in records
    ]
    known = sorted(set.intersection(*map(set, engines)))
    told = [
        [*(record[name] for name in same), *(found[engine] for engine in known)]
        for record, found in zip(records, engines, strict=True)
    ]
    if any(one != told[0] for one in told):
        raise ValueError(f"the provenances of two runs differ in engines or {', '.join(same)}")
    runs = [run for record in records for run in provenance.whole_runs(record)]
    times = {run["first"]: f"{run['duration_s']:.0f} s" for run in runs}
    first, later = (times.get(kind, "a time that was not measured") for kind in (True, False))
    return f"{first} the first time, when its functions are compiled, and for {later} later"


def minutes(full: bool) -> int:
    """Return about how many minutes a report takes on two cores."""
    return round(sum(chapter.minutes[full] for _, chapter in CHAPTERS))
