"""README.md and the pages of the published results, written from the published tables."""

from __future__ import annotations

import json
from pathlib import Path

import pandas as pd
from jinja2 import Environment, PackageLoader, StrictUndefined

from studies.catalogue import CHAPTERS
from studies.kit import provenance
from studies.kit.arguments import BadInputError
from studies.kit.journal import PROVENANCE
from studies.kit.provenance import check, seal
from studies.measures.published import dictionary
from studies.measures.words import capital, meant
from studies.page import engine_facts, facts, hero, scene_facts
from studies.page.engine_facts import objections, slippery
from studies.precision import COST
from studies.scenes import STUDY as SCENES_STUDY
from studies.sweep.study import verdict

PUBLISHED = Path("studies", "published")


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
    lines = facts.presets(published)
    steps = pd.read_csv(published / "precision" / "work-precision.csv")
    known = {
        "chapters": facts.chapters(published),
        "verdict": verdict(lines),
        "wrong": meant(),
        "asked": capital(facts.asked(published).words),
        "missing": facts.missing(published),
        "scenes": scene_facts.scenes(published),
        "scenes_told": scene_facts.scenes_told(published),
        "extreme_frames": scene_facts.extreme_frames(published),
        "floors": scene_facts.floors(published),
        "captions": SCENES_STUDY.captions,
        "presets_all": facts.presets_text(lines),
        "models": facts.models(published),
        "advised": facts.advised(published),
        "ports": facts.ports(published),
        "starts": facts.starts(published),
        "choices_all": facts.choices_text(steps),
        "counts": facts.counts(published),
        "made": facts.made(published),
        "helps": engine_facts.helps(published),
        "beside_own": engine_facts.beside_own(),
        "documented": engine_facts.documented(),
        "earlier": facts.earlier(published),
        "frames": engine_facts.frames_of_engines(published),
        "objections": objections(published, lines),
        "slippery": slippery(),
        "troubles": engine_facts.troubles(),
        "own_tests": engine_facts.own_tests(published),
        "rules": engine_facts.rules_of_engines(published),
        "random_fixed": engine_facts.random_fixed(published),
        "minutes": facts.minutes,
    }
    return {published / "columns.csv": dictionary(published).to_csv(index=False)} | {
        path: environment.get_template(name).render(known)
        for path, name in (
            (root / "README.md", "readme.md.jinja"),
            (published / "README.md", "published.md.jinja"),
            (published / "engines.md", "engines.md.jinja"),
            (published / "scenes.md", "scenes.md.jinja"),
        )
    }
