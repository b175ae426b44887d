"""The chapters of a page, and the commands that fill their folders."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import pandas as pd

from studies.kit.study import Study, Tables


@dataclass(frozen=True)
class Part:
    """A folder of results, and the command that fills it, with its further options."""

    folder: str
    name: str
    title: str = ""
    always: str = ""
    quick: str = "--quick"
    full: str = ""
    weaker: str = ""
    needs: str = ""

    @cached_property
    def study(self) -> Study:
        """The study whose command it is."""
        study: Study = import_module(f"studies.{self.name}").STUDY
        return study

    def words(self, out: Path | str, full: bool) -> list[str]:
        """Return the command line after `rocking`."""
        options = (self.needs, self.always, self.full if full or self.needs else self.quick)
        return [self.name, "--out", str(out), *" ".join(options).split()]

    def command(self, full: bool) -> str:
        """Return the whole command line."""
        return " ".join(["rocking", *self.words("DIR", full)])

    def found(self, tables: Tables, full: bool) -> dict[str, Any]:
        """Return what every page says of its tables."""
        return {
            "folder": self.folder,
            "question": self.title or self.study.question,
            "claim": self.study.finding(tables).split("\n\n")[-1],
            "command": self.command(full),
            "statements": statements(tables),
        }


def statements(tables: Tables) -> list[tuple[bool, str]]:
    """Return whether each statement that a study tested holds."""
    lines = tables.get("findings", pd.DataFrame()).to_dict("records")
    tested = [(str(line["holds"]), str(line["statement"])) for line in lines]
    return [(holds == "True", words) for holds, words in tested if holds in ("True", "False")]


PUBLISHED_WITH = {
    "validate": "--sources engines engines:default engines:default-at-rest engines:recommended "
    "engines:tuned",
    "estimate": "--sources engines engines:tuned engines:default",
    "precision": "--sources exact rk45 dop853 radau lsoda rk4 average-acceleration housner "
    "modified onset-matched engines",
    "batch": "--device cuda",
    "contact": "--engines pybullet mujoco pymunk box2d dart rapier drake newton physx",
    "stability": "--sources exact rk4 average-acceleration dop853 radau engines engines:tuned "
    "engines:recommended engines:default",
    "rocks": "--tests 150 --sources exact mujoco:default pybullet:default pymunk:default "
    "box2d:default dart:default rapier:default physx:default mujoco:recommended "
    "pybullet:recommended pymunk:recommended box2d:recommended dart:recommended "
    "rapier:recommended physx:recommended mujoco:tuned physx:tuned dart:tuned box2d:tuned "
    "pybullet:tuned",
    "scenes": "--time-limit 600 --sources engines engines:tuned engines:recommended "
    "engines:default",
}
"""Folder -> arguments of the published run, where they are others than those of a full one."""
CHAPTERS: dict[str, tuple[Part, ...]] = {
    "The paper's cases": (
        Part(
            *("sweep", "sweep"),
            quick="--accuracy loose",
            weaker="Engines run at accuracy loose instead of standard.",
        ),
        Part(
            *("presets", "sweep"),
            "How well do engines predict them with default and with tuned settings?",
            quick="--figure 8 --sources exact core:default",
            full="--sources exact engines:default engines:default-at-rest engines:recommended "
            "engines:tuned engines",
            weaker="Only figure 8 of four, and no tuned preset.",
        ),
    ),
    "The paper's histories and linearizations": (
        Part("histories", "histories", quick=""),
        Part("linearizations", "linearizations", quick=""),
    ),
    "Random cases": (
        Part("validate", "validate"),
        Part(
            *("estimate", "validate", "How large is an error without an exact solution?"),
            always="--halves",
            quick="--quick --sources core core:tuned core:default",
            full="--sources core core:tuned core:default",
            weaker="Too few random cases to bound any factor.",
        ),
    ),
    "Error against run time": (
        Part("precision", "precision"),
        Part("batch", "batch", weaker="64 cases of 960; no GPU."),
        Part(
            *("batch-cpu", "batch", "What do batches give on a CPU, and what is too stiff?"),
            needs="--device cpu",
        ),
    ),
    "Contact models": (
        Part("advice", "advise", quick="--quick --engines pybullet mujoco"),
        Part("contact", "contact"),
        Part("restitution", "restitution", quick=""),
    ),
    "Stiff and extreme cases": (Part("stability", "stability"),),
    "Overturning": (
        Part("overturning", "overturning"),
        Part(
            *("defaults", "overturning"),
            "Where do engines fail with default settings?",
            full="--sources engines:default",
            quick="--quick --sources core:default",
        ),
        Part(
            *("vertical", "blocks", "How much does vertical shaking matter?"),
            needs="studies/blocks/grid.csv --pga 0.4 --scale 0.5 1 2 --record FOLDER/*/*hor1.AT2 "
            "FOLDER/*/*hor2.AT2 --vertical FOLDER/*/*[Uu][Pp].AT2 FOLDER/*/*[Uu][Pp].AT2",
        ),
    ),
    "Other scenes": (Part("scenes", "scenes"),),
    "Real bodies": (
        Part(
            *("rocks", "experiments"),
            "Which rocks fall on a shake table, and who predicts it?",
            needs="--rocks FOLDER",
        ),
        Part(
            *("cubes", "experiments"),
            "Which engine predicts where a tossed cube goes?",
            needs="--cubes FOLDER",
        ),
    ),
}
"""Title of a chapter -> its parts."""
PARTS = tuple(part for parts in CHAPTERS.values() for part in parts)


def published_parts(published: Path) -> list[Part]:
    """Return the parts that have published results."""
    return [part for part in PARTS if (published / part.folder / "provenance.json").is_file()]
