"""Every study, and one self-contained page: what each found, its figures, tables and failures."""

from __future__ import annotations

import base64
import contextlib
import io
import math
import sys
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pandas as pd
from jinja2 import Environment, PackageLoader
from tqdm import tqdm

from engines import ENGINES
from studies.cases.paper import PULSES
from studies.kit import app, arguments
from studies.kit.say import number, part
from studies.kit.store import FolderError, engines_of, provenance_of
from studies.kit.tables import table_in, write_text
from studies.measures.presets import in_order, look_of
from studies.measures.wrongness import MEANINGS, WORDS
from studies.page.chapters import CHAPTERS, PARTS, Part
from studies.page.facts import presets, wrong
from studies.sources.registry import resolve
from studies.sweep import STUDY as SWEEP

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PAGE = "report.html"
SHOWN = 20
"""Rows of a table, and failures, that are shown; files hold all of them."""
AXES = ("half_cycles", "aspect", "width_m", "onsets", "omega_over_p")
"""Columns of the grid of cases, the last running fastest."""


def command(*, out: arguments.Place, full: bool = False) -> int:
    """Run every study and write one self-contained page about them, report.html.

    The quick studies take six minutes on two cores, the full ones two and a half hours. To continue
    an interrupted report, give the same command again.

    Parameters
    ----------
    out
        Folder for the results, one inside for each study, and for report.html.
    full
        Run the full studies, as published, instead of the quick ones.
    """
    _prepare(out, full)
    codes = []
    parts = [part for part in PARTS if not part.needs]
    with tqdm(parts, disable=None, unit="study") as bar:
        for part in bar:
            bar.set_description(part.folder)
            if bar.disable:  # no terminal: a line for each, so that a log shows where it is
                print(f"{part.folder} …", file=sys.stderr, flush=True)
            code = fill(part, out, full)
            if code > 1:
                return code
            codes.append(code)
    write_page(out / PAGE, out, full)
    for part in parts:
        print(f"{part.folder}: {part.study.finding(part.study.read(out / part.folder))}")
    print(out / PAGE)
    return max(codes)


def _prepare(out: Path, full: bool) -> None:
    path, kind = out / "kind.txt", "full" if full else "quick"
    try:
        out.mkdir(parents=True, exist_ok=True)
        strange = sorted(each.name for each in out.iterdir() if each.name != f".part.{path.name}")
        if strange and not path.is_file():
            problem = f"it must be new or empty, or hold a report, and it holds {strange[0]!r}"
            raise FolderError(out, problem)
        held = path.read_text(errors="replace").strip() if path.is_file() else kind
        if held != kind:
            raise FolderError(out, f"it holds a {held} report; a {kind} one needs another folder")
        write_text(path, kind + "\n")
    except OSError as error:
        problem = f"it must be a folder that can be written ({error.strerror or error})"
        raise FolderError(out, problem) from error


def fill(part: Part, out: Path, full: bool) -> int:
    """Run the command of a part, without its words; return its exit code."""
    with contextlib.redirect_stdout(io.StringIO()):
        code = app.run({"": {part.name: ""}}, part.words(out / part.folder, full))
    if code == 1:
        print(f"{part.folder}: some rows failed; the page names them", file=sys.stderr)
    return code


def write_page(path: Path, folder: Path, full: bool) -> None:
    """Write the page about a folder that holds one for each of PARTS, filled in full or not."""
    environment = Environment(loader=PackageLoader("studies.page", "."), autoescape=True)
    text = environment.get_template("page.html").render(
        chapters={
            title: [_section(one, folder / one.folder, full) for one in parts if not one.needs]
            for title, parts in CHAPTERS.items()
            if not parts[0].needs
        },
        made=_made(folder / PARTS[0].folder),
        full=full,
        shown=SHOWN,
        tried=engine_cases(folder),
        **first_sight(folder),
    )
    write_text(path, text)


def first_sight(folder: Path) -> dict[str, Any]:
    """Return the verdict, and for each engine a tile, or None, for each preset that there is."""
    lines = presets(folder)
    if lines.empty:
        return {"verdict": ""}
    names = in_order(lines["preset"])
    tiles = {}
    for engine, group in lines.groupby("engine", sort=False):
        mine = {
            line["preset"]: [wrong(line), part(line["median"]), part(line["max"])]
            for line in group.to_dict("records")
        }
        tiles[ENGINES[str(engine)].title] = [mine.get(name) for name in names]
    place = "presets" if (folder / "presets").is_dir() else "sweep"
    return {
        "verdict": SWEEP.finding(SWEEP.read(folder / place)),
        "cases": int(lines["cases"].max()),
        "wrong": "; ".join(f"{name} ({MEANINGS[kind]})" for kind, name in WORDS.items()),
        "presets": [look_of(name).short for name in names],
        "tiles": tiles,
    }


def _section(one: Part, folder: Path, full: bool) -> dict[str, Any]:
    study, tables = one.study, one.study.read(folder)
    drawn = study.figures(tables)
    return {
        **one.found(tables, full),
        "full_command": one.command(True),
        "how": study.help.partition("\n\n")[0],
        "weaker": one.weaker or study.quick,
        "pictures": [(study.caption_of(name), embedded(each)) for name, each in drawn.items()],
        "tables": [
            (name, len(rows), *table(rows.head(SHOWN)))
            for name, rows in study.shown(tables).items()
        ],
        "failures": failures(tables),
    }


def embedded(drawing: Figure) -> str:
    """Return a figure as the address of an image that holds it, sharp and not large."""
    from studies.kit.pictures import lay_out, write_points

    lines, points = io.BytesIO(), io.BytesIO()
    lay_out(drawing)
    drawing.savefig(lines, format="svg", metadata={"Date": None})
    if lines.tell() > 100_000:  # points may be less
        write_points(drawing, points)
    kind, image = ("png", points) if 0 < points.tell() < lines.tell() else ("svg+xml", lines)
    return f"data:image/{kind};base64," + base64.b64encode(image.getvalue()).decode()


def table(rows: pd.DataFrame) -> tuple[list[str], list[list[tuple[str, str]]]]:
    """Return the heads of a table, and its rows as cells."""
    return list(rows.columns), [[cell(value) for value in row] for row in rows.to_numpy(object)]


def cell(value: Any) -> tuple[str, str]:
    """Return what is shown of a value, and what it is sorted by."""
    if not isinstance(value, int | float) or isinstance(value, bool):
        return str(value), str(value)
    if math.isnan(value):
        return "–", ""
    return number(value), repr(value)


def failures(tables: dict[str, pd.DataFrame]) -> list[dict[Any, Any]]:
    """Return how often each source of a study failed, and why."""
    found: list[dict[Any, Any]] = []
    for rows in tables.values():
        if {"source", "outcome", "message"} <= set(rows.columns):
            failed = rows[rows["outcome"] == "failed"]
            counts = failed.groupby(["source", "message"], sort=False).size().reset_index(name="n")
            found += counts.to_dict("records")
    return found


def _made(folder: Path) -> list[tuple[str, str]]:
    record = provenance_of(folder)
    versions = {**engines_of(record), "python": record["python"], **record["packages"]}
    return [
        ("project", f"{record['version']}, commit {(record['git'] or {}).get('commit', '-')}"),
        ("versions", ", ".join(f"{name} {version}" for name, version in versions.items())),
        ("machine", ", ".join(f"{name} {value}" for name, value in record["machine"].items())),
        ("made", record["runs"][-1]["start"]),
    ]


def engine_cases(folder: Path) -> dict[str, Any]:
    """Return the peaks of the exact solution and of engines on a grid of pulses and blocks."""
    # peaks: -1 where a block overturns, None where a run failed; judged: 0 where it would slide or
    # lift off; written: the sources that `rocking export` writes out
    rows = table_in(folder / "defaults", "defaults")
    if rows.empty:
        return {"peaks": {}}
    peak = rows["peak_ratio"].mask(rows["outcome"] == "overturned", -1.0)
    rows = rows.assign(half_cycles=rows["pulse"].map(PULSES), peak=peak)
    axes = {name: sorted(rows[name].unique().tolist()) for name in AXES}
    order = pd.MultiIndex.from_product(list(axes.values()), names=AXES)
    wide = rows.pivot(index=list(AXES), columns="source", values="peak").reindex(order)
    found = {
        str(name): [float(f"{peak:.5g}") if math.isfinite(peak) else None for peak in wide[name]]
        for name in rows["source"].unique()
    }
    engines = {name: it for name in found if (it := resolve(name)).engine}
    cases = rows.assign(slides=rows["verdict"] == "invalid").groupby(list(AXES))
    slides = cases["slides"].any().reindex(order, fill_value=False)
    return {
        **axes,
        "peaks": found,
        "judged": (1 - slides.astype(int)).tolist(),
        "rests": cases["rest_s"].first().reindex(order).tolist(),
        "written": [name for name, it in engines.items() if it.declared.script and not it.accurate],
    }
