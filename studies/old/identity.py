"""What made a row: the code that it runs through, its source as it is declared, and versions.

A row depends on the code by which its source answers and its study reduces the answer, on what the
engine declares, and on the versions of the engine and of what computes; besides, on its case, which
is its key in the journal. Not on another engine, nor on words, pictures and the command line. A
table depends on its rows and on how they are tabulated.
"""

import enum
import hashlib
import json
import platform
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from dataclasses import fields, is_dataclass
from pathlib import Path
from typing import Any, TypeAlias

from engines.layouts import Ability
from studies.old.fingerprint import ROOT, Name, Reached, name_of, names_of, reached
from studies.old.jobs import Job, plain
from studies.old.journal import JOURNAL, FolderError, Kept, Maker, Row, named
from studies.old.provenance import NOT_INSTALLED, NUMERICAL_PACKAGES, version_of
from studies.sources.registry import Source, asks_of

FOUND_BY_NAME: frozenset[Name] = frozenset(
    {
        ("analytic.accelerograms", "read"),
        ("engines.registry", "ENGINES"),
        ("engines.registry", "find"),
        ("studies.sources.registry", "SOURCES"),
        ("studies.sources.registry", "presets_of"),
        ("studies.sources.registry", "resolve"),
    }
)
"""Where sources, engines and records are looked up: what a row asks is a part of it, by itself."""

ASIDE = frozenset(
    {"core", "factors", "install", "own_step", "rules", "script", "title"}
    | {"abilities", "build", "builders"}
)
"""What an engine declares for readers, for what is no row of a journal, and by what is asked."""

OF_A_PRESET = ("settings", "stepping", "step", "step_s", "frame")
"""What of a preset makes a row."""

SHOWN = 3
"""Things that made a row otherwise, named at most."""


class Makers:
    """What makes the rows of a plan.

    Parameters
    ----------
    ask, reduce : callable
        Those of the plan.
    root : Path, optional
        The folder of the packages.
    """

    def __init__(
        self, ask: Callable[..., Any], reduce: Callable[..., Any], root: Path = ROOT
    ) -> None:
        self._shared = {name_of(ask), name_of(reduce)}
        self._root = root
        self._known: dict[Any, Maker] = {}

    def of(self, job: Job) -> Maker:
        """Return what makes the row of a job."""
        asked = job.source, self._kinds(job), asks_of(job.block)
        if asked not in self._known:
            source = job.asked
            packages = (*NUMERICAL_PACKAGES, *(source.declared.packages if source.engine else ()))
            self._known[asked] = {
                **self.reached(job).digests(),
                **_declared(source, asks_of(job.block)),
                "Python": ".".join(platform.python_version_tuple()[:2]),
                **{name: version_of(name) for name in packages},
            }
        return self._known[asked]

    def reached(self, job: Job) -> Reached:
        """Return the code that the row of a job runs through."""
        source = job.asked
        names = {*self._shared, *self._kinds(job), name_of(source.call)}
        if source.engine:
            engine, preset = source.declared, source.used
            builder = engine.builder(asks_of(job.block), preset)
            parts = (type(engine), type(preset), type(preset.settings), builder, engine.spring)
            names = names.union(*(names_of(part) for part in parts if part))
        return reached(names, self._root, cut=FOUND_BY_NAME)

    def of_tables(self, jobs: Iterable[Job], tabulate: Callable[..., Any]) -> dict[str, Any]:
        """Return what makes tables: their tabulation, and by source what makes their rows."""
        made: dict[str, set[str]] = {}
        for job in jobs:
            made.setdefault(job.source, set()).add(named(self.of(job)))
        tabulation = reached([name_of(tabulate)], self._root, cut=FOUND_BY_NAME).digests()
        rows = {source: sorted(names) for source, names in made.items()}
        return {"tabulation": named(tabulation), "rows": rows}

    def _kinds(self, job: Job) -> frozenset[Name]:
        """Return the kinds of a job's values, whose methods are called."""
        values = [job.block, job.motion, *job.options.values()]
        for value in values:  # a motion may hold another one
            values += [getattr(value, item.name) for item in fields(value)] if _data(value) else []
        return frozenset(name_of(type(value)) for value in values if _data(value))


def _data(value: Any) -> bool:
    """Return whether a value is one of a dataclass."""
    return is_dataclass(value) and not isinstance(value, type)


def _declared(source: Source, asks: Sequence[Ability]) -> dict[str, str]:
    """Return what of an engine's declaration rows depend on that ask for some abilities."""
    if not source.engine:
        return {}
    engine, used = source.declared, source.used
    values = {
        **{item.name: getattr(engine, item.name) for item in fields(engine)},
        "presets": {name: getattr(used, name) for name in OF_A_PRESET},
        "builder": engine.builder(asks, used),
        "held": [ability.name for ability in asks if ability in engine.holds],
        "stacked": used.stacked if Ability.STACKED in asks else None,
    }
    kept = {name: value for name, value in values.items() if name not in ASIDE}
    text = json.dumps(kept, default=_plain, sort_keys=True)
    return {f"declaration of {engine.name}": hashlib.sha256(text.encode()).hexdigest()[:12]}


def _plain(value: Any) -> Any:
    if isinstance(value, enum.Enum):
        return str(value)
    return sorted(names_of(value)) if callable(value) else plain(value)


def changed(then: Maker, now: Maker) -> list[str]:
    """Return the names of what made a row and would make another one now.

    A version counts only where there is one: what was made elsewhere cannot be made anew here.
    """
    return [
        name
        for name in {**now, **then}
        if then.get(name) != now.get(name) and now.get(name) != NOT_INSTALLED
    ]


Stale: TypeAlias = tuple[str, Maker, Maker]
"""The source of a row, what made it, and what would make it now."""


def sorted_rows(
    jobs: Iterable[Job], kept: Kept, makers: Makers, folder: Path
) -> tuple[dict[str, Row], list[Stale]]:
    """Return the kept rows of jobs that would be made so now, by their keys, and the others.

    Parameters
    ----------
    jobs : iterable of Job
    kept : Kept
        The rows of a folder, and what made them; those of other jobs are passed over.
    makers : Makers
        What would make them now.
    folder : Path
        Where they are kept; a refusal names it.

    Returns
    -------
    dict
        Key of a job -> its row.
    list of Stale
        One for each row of a job that would be another now; `why` puts them into words.

    Raises
    ------
    FolderError
        If a row of the folder is not of the job which its key names.
    """
    valid: dict[str, Row] = {}
    stale = []
    for job in jobs if kept else ():  # a key takes a tenth of a millisecond
        key = job.key
        if key not in kept:
            continue
        row, then = kept[key]
        if not job.has_made(row):
            problem = f"its {JOURNAL} has a row of something else under the key {key}"
            raise FolderError(folder, problem)
        if changed(then, now := makers.of(job)):
            stale.append((job.source, then, now))
        else:
            valid[key] = row
    return valid, stale


def why(stale: Iterable[Stale]) -> str:
    """Say of rows that must be made anew how many there are of each source, and why."""
    counts = Counter(
        (source, tuple(_said(name, then, now) for name in changed(then, now)))
        for source, then, now in stale
    )
    said = []
    for (source, reasons), count in counts.items():
        more = [f"{len(reasons) - SHOWN} more"] if len(reasons) > SHOWN else []
        rows = f"{count} {'row' if count == 1 else 'rows'}"
        said.append(f"{source}: {rows} made by {', '.join([*reasons[:SHOWN], *more])}")
    return "; ".join(said)


def _said(name: str, then: Maker, now: Maker) -> str:
    if name.endswith(".py") or name.startswith("declaration"):
        return f"another {name}"
    return f"{name} {then.get(name, 'none')}, not {now.get(name, 'none')}"
