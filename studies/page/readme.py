"""README.md and the pages of the published results, written from the published tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from analytic import RigidBlock, SinePulse
from engines import ENGINES, scene, troubles
from engines.declaration import AT_REST, REST_S
from engines.factors import BEST
from studies.cases.refusal import BadInputError
from studies.kit.jobs import Job, Question, ask
from studies.kit.say import capital, duration, listed, part, signed
from studies.kit.store import check, versions, write_record
from studies.kit.tables import read_table, tables_of, write_table, write_text
from studies.measures import costs, history, presets, wrongness
from studies.measures.published import dictionary
from studies.page import facts
from studies.page.chapters import CHAPTERS, PUBLISHED_WITH, Part, published_parts
from studies.sources.registry import core_sources
from studies.sweep import STUDY as SWEEP

PUBLISHED = Path("studies", "published")
PAGES = {
    Path("README.md"): "readme.md.jinja",
    PUBLISHED / "README.md": "published.md.jinja",
    PUBLISHED / "engines.md": "engines.md.jinja",
    PUBLISHED / "scenes.md": "scenes.md.jinja",
}
"""Page -> its template."""
BLOCK, PULSE = RigidBlock(width=0.5, height=1.5), SinePulse.in_g(0.4, omega=6.2832, half_cycles=2)
MOVING = core_sources("default")
SOURCES = ("exact", "housner", *core_sources(AT_REST), *core_sources(BEST), *MOVING)


def command(*, root: Path = Path()) -> int:
    """Write README.md and the pages in studies/published, with their pictures, from the tables.

    All numbers in them are computed from studies/published, and so are words such as "all".

    Parameters
    ----------
    root
        The project's folder.
    """
    from studies.drawing.film import draw_hero
    from studies.kit.pictures import save

    published, folder = root / PUBLISHED, root / PUBLISHED / "hero"
    if not published.is_dir():
        raise BadInputError(f"--root is {str(root)!r}; it must hold {PUBLISHED}")
    for one in published_parts(published):
        names = [path.name for path in tables_of(published / one.folder)]
        check(published / one.folder, names, "a published folder")
    folder.mkdir(exist_ok=True)
    write_table(folder / "hero.csv", measure_hero())
    write_record(folder, {"study": "readme", **versions({})})
    histories = read_table(folder / "hero.csv")
    drawn = histories[~histories["source"].isin(MOVING)]
    save(draw_hero(BLOCK, drawn, summary(drawn)), folder / "hero.png")
    for path, text in pages(root).items():
        write_text(path, text)
        print(path)
    return 0


def measure_hero() -> pd.DataFrame:
    """Return the histories of one block under one pulse, from the sources of the first picture."""
    window = scene.free_rocking_window(BLOCK, PULSE)
    times = np.linspace(0.0, window, 401)
    case = Question(system=BLOCK, motion=PULSE, duration=window, times=times)
    parts = []
    for name in SOURCES:
        response = ask(Job(labels={}, case=case, source=name))
        labels = {"source": name, "peak_ratio": response.peak_ratio}
        parts.append(history.samples(response, BLOCK, PULSE, labels))
    found = pd.concat(parts, ignore_index=True).round({"time_s": 9, "theta_ratio": 9})
    return found[["source", "outcome", "peak_ratio", "time_s", "theta_ratio"]]


def summary(histories: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source: its outcome, its peak and the error of that."""
    lines = histories.groupby("source", sort=False)[["outcome", "peak_ratio"]].first()
    errors = lines["peak_ratio"] / float(lines["peak_ratio"]["exact"]) - 1.0
    return lines.assign(error=errors.where(lines["outcome"] == "rocked")).reset_index()


def moving(published: Path) -> str:
    """Return the peaks' errors with the default settings of the first picture's moving floor."""
    errors = summary(read_table(published / "hero" / "hero.csv")).set_index("source")["error"]
    titles = [f"{ENGINES[presets.engine_of(name)].title}'s" for name in MOVING]
    signs = zip(titles, errors[[*MOVING]].map(signed), strict=True)
    return f"the errors are {listed(map(' '.join, signs))}"


def row(cells: Sequence[object]) -> str:
    """Return a row of a Markdown table; a bar in a cell would end it, and is another sign."""
    return f"| {' | '.join(str(cell).replace('|', '∣') for cell in cells)} |"


def table(heads: Sequence[str], rows: Iterable[Sequence[object]] = ()) -> str:
    """Return a Markdown table, a cell of each row for each head."""
    return "\n".join(map(row, (heads, ["---"] * len(heads), *rows)))


def pages(root: Path) -> dict[Path, str]:
    """Return the text of each page that is made from the published tables."""
    published = root / PUBLISHED
    known = published_parts(published)
    environment = Environment(
        loader=PackageLoader("studies.page", "."),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    filters = (capital, duration, presets.look_of, part, row)
    environment.filters |= {each.__name__: each for each in filters}
    chapters = {
        title: [_told(one, published / one.folder) for one in parts if one in known]
        for title, parts in CHAPTERS.items()
    }
    environment.globals |= {
        **{"facts": facts, "table": table, "published": published},
        "verdict": SWEEP.finding(SWEEP.read(published / "presets")),
        "chapters": {title: parts for title, parts in chapters.items() if parts},
        **{"made": facts.made(published), "presets": facts.presets(published)},
        "moving": moving(published),
        **{"STEPPED": costs.STEPPED, "TROUBLES": troubles.TROUBLES},
        **{"WORDS": wrongness.WORDS, "MEANINGS": wrongness.MEANINGS, "REST_S": REST_S},
    }
    return {published / "columns.csv": dictionary(published).to_csv(index=False)} | {
        root / path: environment.get_template(name).render() for path, name in PAGES.items()
    }


def _told(one: Part, folder: Path) -> dict[str, Any]:
    """Return what the pages say of a part, and its pictures."""
    pictures = [(it.name, one.study.caption_of(it.stem)) for it in sorted(folder.glob("*.png"))]
    one = replace(one, full=PUBLISHED_WITH.get(one.folder, one.full))
    return {**one.found(one.study.read(folder), full=True), "pictures": pictures}
