"""What a setting changes in a script of the defaults: lines that go, and lines that come."""

import re
from collections.abc import Iterator, Mapping, Sequence
from difflib import SequenceMatcher
from typing import Any

from analytic.block import RigidBlock
from analytic.motion import SinePulse
from engines import ENGINES, Scene
from engines.parts.factors import DEFAULT
from engines.parts.script import Script
from studies.cases.variants import variants

BLOCK = RigidBlock(width=0.5, height=1.5)
"""The block of the lines."""

SCRIPT = "block.py"
"""File of an exported scene that has the calls of a library."""

FILE, GOES, COMES, STAYS = "@@ ", "- ", "+ ", "  "
"""How a line begins: the name of a file, then its lines."""

GIVEN = re.compile(r"\w+=(?:\"[^\"]*\"|\[[^\]]*\]|\([^)]*\)|[^,()\s]+)")
"""A named value in a call of Python, or in a model."""


def own_step_s(engine: str) -> float:
    """Return the step [s] of an engine's defaults."""
    return ENGINES[engine].preset(DEFAULT).ordinary_step_s(_scene({}))


def patch(
    engine: str, factor: str, level: str, dt_s: float, *, friction: float | None = None
) -> str:
    """Return what a variant of the defaults changes in the script that `rocking export` writes.

    Parameters
    ----------
    engine, factor, level : str
    dt_s : float
        Step of the script [s].
    friction : float, optional
        By default the library's own.

    Returns
    -------
    str
        Of each place the name of the file, lines that go or stay, and lines that come after them;
        empty for an engine that writes no scripts.
    """
    script = ENGINES[engine].script
    if script is None:
        return ""
    settings = next(
        v.settings
        for v in variants(engine)
        if (v.preset, v.factor, v.level) == (DEFAULT, factor, level)
    )
    usual = ENGINES[engine].preset(DEFAULT)
    scenes = [usual.posed(_scene(said, friction)) for said in ({}, settings)]
    before, after = (_files(script(each, usual.chosen(each), dt_s)) for each in scenes)
    return "\n".join(line for name in after for line in _places(name, before[name], after[name]))


def named(changes: str) -> str:
    """Return the named values that come with a patch, and do not go with it."""
    lines = [(line[:2], GIVEN.findall(line)) for line in changes.splitlines()]
    gone = {word for mark, words in lines if mark != COMES for word in words}
    come = dict.fromkeys(word for mark, words in lines if mark == COMES for word in words)
    return ", ".join(word for word in come if word not in gone)


def _scene(settings: Mapping[str, Any], friction: float | None = None) -> Scene:
    motion = SinePulse(amplitude=1.0, omega=1.0)
    return Scene(system=BLOCK, motion=motion, preset=DEFAULT, settings=settings, friction=friction)


def _files(script: Script) -> dict[str, list[str]]:
    inner = [f"    {line}" for line in (*script.step, *script.pose)]
    texts = {SCRIPT: "\n".join((*script.imports, *script.build, *inner)), **script.files}
    return {name: text.splitlines() for name, text in texts.items()}


def _places(name: str, before: Sequence[str], after: Sequence[str]) -> Iterator[str]:
    """Yield each place where lines differ, after as many that stay as tell it from all others."""
    for tag, i, j, k, m in SequenceMatcher(None, before, after, autojunk=False).get_opcodes():
        if tag != "equal":
            yield f"{FILE}{name}"
            yield from (f"{STAYS}{line}" for line in before[_told_apart(before, i, j) : i])
            yield from (f"{GOES}{line}" for line in before[i:j])
            yield from (f"{COMES}{line}" for line in after[k:m])


def _told_apart(lines: Sequence[str], i: int, j: int) -> int:
    """Return the largest k up to i from which lines up to j are there only once."""
    for k in range(i, 0, -1):
        text = lines[k:j]
        places = [n for n in range(len(lines)) if lines[n : n + j - k] == text]
        if "".join(text).strip() and len(places) == 1:
            return k
    return 0
