"""README.md and the pages of the published results, written from the published tables."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from pathlib import Path

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from engines import ENGINES
from engines.troubles import TROUBLES
from studies import scenes
from studies.catalogue import CHAPTERS
from studies.old import provenance
from studies.old.arguments import BadInputError
from studies.old.journal import PROVENANCE
from studies.old.provenance import check, seal
from studies.measures.costs import OUTDATED, STEPPED, cost_text
from studies.measures.presets import in_words
from studies.measures.published import dictionary
from studies.measures.words import capital, duration, meant, part, per_cent
from studies.measures.wrongness import WORDS
from studies.page import engine_facts, facts, hero, scene_facts
from studies.precision import COST
from studies.precision.choices import TARGETS
from studies.sweep.study import verdict

PUBLISHED = Path("studies", "published")

PAGES = {
    Path("README.md"): "readme.md.jinja",
    PUBLISHED / "README.md": "published.md.jinja",
    PUBLISHED / "engines.md": "engines.md.jinja",
    PUBLISHED / "scenes.md": "scenes.md.jinja",
}
"""Page -> its template."""


def command(*, root: Path = Path()) -> int:
    """Write README.md and the pages in studies/published, with their pictures, from the tables.

    Every number in them is computed from studies/published, and so are words such as "all".

    Parameters
    ----------
    root
        The project's folder.
    """
    from studies.drawing.block import draw_block, draw_hero
    from studies.drawing.figures import save_all

    folder = root / PUBLISHED / "hero"
    if not (root / PUBLISHED).is_dir():
        raise BadInputError(f"--root is {str(root)!r}; it must hold {PUBLISHED}")
    for study, chapter in CHAPTERS:
        check(root / PUBLISHED / chapter.folder, study.tables, "a published folder")
    check(root / PUBLISHED / COST.name, COST.tables, "a published folder")  # of no chapter
    folder.mkdir(exist_ok=True)
    hero.measure(folder / "hero.csv")
    made_with = {**provenance.subject("readme"), **provenance.versions()}
    provenance.write_text(folder / PROVENANCE, json.dumps(made_with, indent=2) + "\n")
    seal(folder)
    samples = pd.read_csv(folder / "hero.csv")
    drawn = {
        "block": draw_block(),
        "hero": draw_hero(hero.BLOCK, samples, hero.summary(samples)),
    }
    save_all(drawn, folder)
    for path, text in pages(root).items():
        provenance.write_text(path, text)
        print(path)
    return 0


def row(cells: Sequence[object]) -> str:
    """Return a row of a Markdown table; a bar in a cell would end it, and is another sign."""
    return f"| {' | '.join(str(cell).replace('|', '∣') for cell in cells)} |"


def table(heads: Sequence[str], rows: Iterable[Sequence[object]] = ()) -> str:
    """Return a Markdown table, a cell of each row for each head."""
    return "\n".join(map(row, (heads, ["---"] * len(heads), *rows)))


def pages(root: Path) -> dict[Path, str]:
    """Return the text of each page that is made from the published tables."""
    published = root / PUBLISHED
    environment = Environment(
        loader=PackageLoader("studies.page", "."),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    said = (capital, duration, in_words, engine_facts.once, part, per_cent, row)
    environment.filters |= {function.__name__: function for function in said}
    asked = (cost_text, engine_facts, facts, meant, scene_facts, table)
    environment.globals |= {each.__name__.rpartition(".")[2]: each for each in asked}
    environment.globals |= {
        "ENGINES": ENGINES,
        "OUTDATED": OUTDATED,
        "STEPPED": STEPPED,
        "WORDS": WORDS,
    }
    environment.globals |= {"TARGETS": TARGETS, "infinite": math.inf, "verdict": verdict}
    environment.globals |= {"TROUBLES": TROUBLES, "captions": scenes.STUDY.captions}
    return {published / "columns.csv": dictionary(published).to_csv(index=False)} | {
        root / path: environment.get_template(name).render(published=published)
        for path, name in PAGES.items()
    }
