"""The chapters of a page, the commands that fill their folders, and the one that runs all."""

from __future__ import annotations

import contextlib
import io
import sys
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import Any

import pandas as pd
from tqdm import tqdm

from studies.kit import app
from studies.kit.arguments import Place
from studies.kit.store import FolderError
from studies.kit.study import Study, Tables
from studies.kit.tables import write_text

PAGE = "report.html"


@dataclass(frozen=True)
class Part:
    """A folder of results, and the command that fills it, with its further arguments.

    It has a title where one study fills several folders; `weaker` is what its quick form lacks. One
    that `needs` a folder of the reader's is left out of a report.
    """

    folder: str
    name: str
    title: str = ""
    always: tuple[str, ...] = ()
    quick: tuple[str, ...] = ("--quick",)
    full: tuple[str, ...] = ()
    weaker: str = ""
    needs: tuple[str, ...] = ()

    @cached_property
    def study(self) -> Study:
        """The study whose command it is."""
        study: Study = import_module(f"studies.{self.name}").STUDY
        return study

    def words(self, out: Path | str, full: bool) -> list[str]:
        """Return the command line after `rocking`."""
        return [
            self.name,
            "--out",
            str(out),
            *self.needs,
            *self.always,
            *(self.full if full else self.quick),
        ]

    def command(self, full: bool) -> str:
        """Return the whole command line."""
        return " ".join(["rocking", *self.words("DIR", full)])

    @property
    def published_command(self) -> str:
        """The whole command line that makes what is published, with every engine."""
        words = PUBLISHED_WITH.get(self.folder, " ".join(self.full))
        return replace(self, full=tuple(words.split())).command(full=True)

    def found(self, tables: Tables, full: bool) -> dict[str, Any]:
        """Return what every page says of its tables."""
        return {
            "folder": self.folder,
            "question": self.title or self.study.question,
            "claim": self.study.finding(tables),
            "command": self.command(full),
            "statements": statements(tables),
        }


def statements(tables: Tables) -> list[tuple[bool, str]]:
    """Return whether each statement that a study tested holds."""
    lines = tables.get("findings", pd.DataFrame()).to_dict("records")
    tested = [(str(line["holds"]), str(line["statement"])) for line in lines]
    return [(holds == "True", words) for holds, words in tested if holds in ("True", "False")]


PUBLISHED_WITH = {
    "validate": "--sources engines physx:default physx:recommended physx:tuned",
    "estimate": "--sources engines engines:tuned engines:default",
    "precision": "--sources exact rk45 dop853 radau lsoda rk4 average-acceleration housner "
    "modified onset-matched engines",
    "batch": "--device cuda",
    "contact": "--engines pybullet mujoco pymunk box2d dart rapier drake newton physx",
    "contact-frames": "--engines pybullet mujoco pymunk box2d dart",
    "stability": "--sources exact rk4 average-acceleration dop853 radau engines engines:tuned "
    "engines:recommended engines:default",
    "scenes": "--sources engines engines:tuned engines:recommended engines:default",
}
"""Folder -> arguments of the published run, where they are others than those of a full one."""
CHAPTERS: dict[str, tuple[Part, ...]] = {
    "The paper's cases": (
        Part(
            *("sweep", "sweep"),
            quick=("--accuracy", "loose"),
            weaker="Engines run at accuracy loose instead of standard.",
        ),
        Part(
            *("presets", "sweep"),
            "How well do engines predict them with default and with tuned settings?",
            quick=("--figure", "8", "--sources", "exact", "core:default"),
            full=(
                *("--sources", "exact", "engines:default", "engines:default-at-rest"),
                *("engines:recommended", "engines:tuned", "engines"),
            ),
            weaker="Only figure 8 of four, and no tuned preset.",
        ),
    ),
    "The paper's histories and linearizations": (
        Part("histories", "histories", quick=()),
        Part("linearizations", "linearizations", quick=()),
    ),
    "Random cases": (
        Part("validate", "validate"),
        Part(
            *("estimate", "validate", "How large is an error without an exact solution?"),
            always=("--halves",),
            quick=("--quick", "--sources", "core", "core:tuned", "core:default"),
            full=("--sources", "core", "core:tuned", "core:default"),
            weaker="Too few random cases to bound any factor.",
        ),
    ),
    "Error against run time": (
        Part("precision", "precision"),
        Part("batch", "batch", weaker="64 cases of 960; no GPU."),
    ),
    "Contact models": (
        Part("advice", "advise", quick=("--quick", "--engines", "pybullet", "mujoco")),
        Part("contact", "contact"),
        Part(
            *("contact-frames", "contact", "How much does each setting matter on frames?"),
            always=("--scene", "frame"),
        ),
        Part("restitution", "restitution", quick=()),
    ),
    "Stiff and extreme cases": (Part("stability", "stability"),),
    "Overturning": (
        Part("overturning", "overturning"),
        Part(
            *("defaults", "overturning"),
            "Where do engines fail with default settings?",
            full=("--sources", "engines:default"),
            quick=("--quick", "--sources", "core:default"),
        ),
    ),
    "Other scenes": (Part("scenes", "scenes"),),
    "Real bodies": (
        Part(
            *("rocks", "experiments"),
            "Which rocks fall on a shake table, and who predicts it?",
            quick=(),
            needs=("--rocks", "FOLDER"),
        ),
        Part(
            *("cubes", "experiments"),
            "Which engine predicts where a tossed cube goes?",
            quick=(),
            needs=("--cubes", "FOLDER"),
        ),
    ),
}
"""Title of a chapter -> its parts."""
PARTS = tuple(part for parts in CHAPTERS.values() for part in parts)


def published_parts(published: Path) -> list[Part]:
    """Return the parts that have published results."""
    return [part for part in PARTS if (published / part.folder / "provenance.json").is_file()]


def command(*, out: Place, full: bool = False) -> int:
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
    from studies.page.page import write_page

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
