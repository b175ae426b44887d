"""One self-contained page: what each study found, its figures, its tables, what failed."""

from __future__ import annotations

import base64
import io
import itertools
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
from jinja2 import Environment, PackageLoader
from matplotlib.figure import Figure

from engines import ENGINES
from studies.cases.paper import PULSES
from studies.catalogue import CHAPTERS
from studies.defaults.study import INVALID, read
from studies.drawing.figures import lay_out, write_points
from studies.old import provenance
from studies.old.study import Chapter, Study
from studies.old.tables import SMALL, read_table
from studies.measures.presets import in_words
from studies.measures.words import capital, in_kinds, meant, part
from studies.measures.wrongness import KINDS
from studies.page.facts import asked, presets, shared, statements_of
from studies.sources.registry import resolve
from studies.sweep.study import verdict

GOOD, BAD = 1e-3, 0.1
"""Largest errors below which, and above which, a tile is marked."""


def write_page(path: Path, folder: Path, full: bool) -> None:
    """Write the page about the results of all studies.

    Parameters
    ----------
    path : Path
        The HTML file; it holds its pictures itself.
    folder : Path
        With a folder inside for each of CHAPTERS, as `rocking report` fills it.
    full : bool
        Whether it was filled by the full commands, which the page names, or by the quick ones.

    Raises
    ------
    OSError
        If the provenance or a table of a folder is missing, or the file cannot be written.
    """
    environment = Environment(loader=PackageLoader("studies.page", "."), autoescape=True)
    text = environment.get_template("page.html").render(
        chapters=[_section(*place, folder / place[1].folder, full) for place in CHAPTERS],
        made=_provenance(folder / CHAPTERS[0][1].folder),
        full=full,
        shown=SHOWN,
        cases=engine_cases(folder),
        **first_sight(folder),
    )
    provenance.write_text(path, text)


def first_sight(folder: Path) -> dict[str, Any]:
    """Return the verdict, and a tile for each engine and preset of what the folder holds.

    Returns
    -------
    dict
        verdict, what was asked, and what each kind of wrong counts, in words; presets: how they are
        used, in words; tiles: engine -> a tile for each of these, or None.
    """
    lines = presets(folder)
    if lines.empty:
        return {"verdict": ""}
    names = shared(lines)
    tiles = {}
    for engine, group in lines.groupby("engine", sort=False):
        mine = {row["preset"]: _tile(row) for _, row in group.iterrows()}
        row = [mine.get(name) for name in names]
        alone = [{**tile, "preset": name} for name, tile in mine.items() if name not in names]
        tiles[ENGINES[str(engine)].title] = [*row[:-1], row[-1] or next(iter(alone), None)]
    return {
        "verdict": verdict(lines),
        "asked": capital(asked(folder).words),
        "wrong": meant(),
        "presets": list(map(in_words, names)),
        "tiles": tiles,
    }


def _tile(row: pd.Series[Any]) -> dict[str, str]:
    lost = any(row[list(KINDS)])
    good, bad = not lost and row["max"] < GOOD, lost or row["max"] > BAD
    return {
        "kind": "good" if good else "bad" if bad else "",
        "wrong": in_kinds(row),
        "median": _unbroken(part(row["median"])),
        "max": f"max {_unbroken(part(row['max']))}",
    }


def _unbroken(words: str) -> str:
    return words.replace(" ", "\N{NO-BREAK SPACE}")


def _section(study: Study, chapter: Chapter, folder: Path, full: bool) -> dict[str, Any]:
    return {
        "folder": chapter.folder,
        "question": chapter.question,
        "claim": study.finding(folder),
        "statements": statements_of(folder),
        "full_command": "rocking " + " ".join(study.command_line(chapter, Path("DIR"), True)),
        "how": study.help,
        "weaker": chapter.weaker,
        "command": "rocking " + " ".join(study.command_line(chapter, Path("DIR"), full)),
        "pictures": [
            (study.captions.get(name, name), embedded(drawn))
            for name, drawn in study.pictures(folder).items()
        ],
        "texts": [(path.stem, prose(path.read_text())) for path in sorted(folder.glob("*.txt"))],
        "tables": [
            (name, len(rows), *table(rows.head(SHOWN)))
            for name, rows in _tables(chapter, folder, study.load())
        ],
        "failures": failures(folder, study.table),
    }


def prose(text: str) -> list[tuple[bool, list[str]]]:
    """Return a text in parts, each with whether its lines are aligned as a table's."""
    lines = [line for line in text.splitlines() if line.strip()]
    parts = [
        (tabular, list(part))
        for tabular, part in itertools.groupby(lines, lambda line: "  " in line.strip())
    ]
    return [
        (tabular, [*part[: SHOWN + 1], f"and {len(part) - SHOWN - 1} more rows"])
        if tabular and len(part) > SHOWN + 1
        else (tabular, part)
        for tabular, part in parts
    ]


SHOWN = 20
"""Rows of a table, lines of one in a text, and failures that are shown; files hold all of them."""

LARGE = 100_000
"""Bytes up to which a figure is held as its lines; beyond, as points where that is less."""


def embedded(drawing: Figure) -> str:
    """Return a figure as the address of an image that holds it, sharp and not large."""
    lines, points = io.BytesIO(), io.BytesIO()
    lay_out(drawing)
    drawing.savefig(lines, format="svg", metadata={"Date": None})
    if lines.tell() > LARGE:
        write_points(drawing, points)
    return (
        _address("png", points) if 0 < points.tell() < lines.tell() else _address("svg+xml", lines)
    )


def _address(kind: str, image: io.BytesIO) -> str:
    return f"data:image/{kind};base64," + base64.b64encode(image.getvalue()).decode()


def _tables(chapter: Chapter, folder: Path, study: Any) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield a chapter's tables, and others of a study that has them."""
    yield from ((name, read_table(folder / name)) for name in chapter.tables)
    if hasattr(study, "shown"):
        yield from study.shown(folder).items()


def table(rows: pd.DataFrame) -> tuple[list[str], list[list[tuple[str, str]]]]:
    """Return the heads of a table, and its rows as cells."""
    return list(rows.columns), [[cell(value) for value in row] for row in rows.to_numpy(object)]


def cell(value: Any) -> tuple[str, str]:
    """Return what is shown of a value, a number in four digits, and what it is sorted by."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return str(value), str(value)
    if math.isnan(value):
        return "–", ""
    small = 0.0 < abs(value) < SMALL
    return f"{value:.3e}" if small else f"{value:.4g}", repr(value)


def failures(folder: Path, pattern: str) -> list[dict[Any, Any]]:
    """Return how often each source of a study failed, and of what."""
    found: list[dict[Any, Any]] = []
    for path in sorted(folder.glob(pattern)):
        rows = read_table(path)
        if {"source", "outcome", "message"} <= set(rows.columns):
            failed = rows[rows["outcome"] == "failed"]
            counts = failed.groupby(["source", "message"], sort=False).size().reset_index(name="n")
            found += counts.to_dict("records")
    return found


def _provenance(folder: Path) -> list[tuple[str, str]]:
    record = provenance.record_of(folder)
    versions = {
        **provenance.engines_of(record),
        "python": record["python"],
        **record["packages"],
        **record["tools"],
    }
    return [
        ("project", f"{record['version']}, commit {(record['git'] or {}).get('commit', '-')}"),
        ("versions", ", ".join(f"{name} {version}" for name, version in versions.items())),
        ("machine", ", ".join(f"{name} {value}" for name, value in record["machine"].items())),
        ("made", record["runs"][-1]["start"]),
    ]


DIGITS = 5
OVERTURNED = -1.0
"""What stands in place of a peak; a case that failed has None."""
AXES = ("half_cycles", "aspect", "width_m", "onsets", "omega_over_p")
"""Columns of the grid, the last running fastest."""


def engine_cases(folder: Path) -> dict[str, Any]:
    """Return what the exact solution and the engines answer on the grid of `rocking defaults`.

    Returns
    -------
    dict
        Of each of AXES its values; peaks: source -> the peaks of all cases, in their order, without
        the study's table of no source; judged: of each case 1, or 0 where the block would slide or
        lift off; rests: for how long all is at rest before the pulse of each [s]; written: the
        sources that `rocking export` writes out.
    """
    path = folder / "defaults" / "defaults.csv"
    if not path.is_file():
        return {"peaks": {}}
    rows = read(path.parent)
    rows = rows.assign(
        half_cycles=rows["pulse"].map(PULSES),
        peak=rows["peak_ratio"].mask(rows["outcome"] == "overturned", OVERTURNED),
    )
    axes = {name: sorted(rows[name].unique().tolist()) for name in AXES}
    order = pd.MultiIndex.from_product(list(axes.values()), names=AXES)
    wide = rows.pivot(index=list(AXES), columns="source", values="peak").reindex(order)
    found = {
        str(name): [
            float(f"{peak:.{DIGITS}g}") if math.isfinite(peak) else None for peak in wide[name]
        ]
        for name in rows["source"].unique()
    }
    slides = rows[rows["verdict"] == INVALID].drop_duplicates(list(AXES))
    judged = 1 - order.isin(pd.MultiIndex.from_frame(slides[list(AXES)])).astype(int)
    rests = rows.drop_duplicates(list(AXES)).set_index(list(AXES))["rest_s"].reindex(order)
    return {
        **axes,
        "peaks": found,
        "judged": judged.tolist(),
        "rests": rests.tolist(),
        "written": list(filter(written_out, found)),
    }


def written_out(source: str) -> bool:
    """Say whether `rocking export` writes a source out: an engine with equal steps and a script."""
    asked = resolve(source)
    return bool(asked.engine and asked.declared.script) and not asked.accurate
