"""The paper's sensitivity analysis, figures 6 to 9: every case through every named source."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Annotated

import pandas as pd

from studies.cases.paper import sweep_cases
from studies.drawing.kept import tell
from studies.drawing.styles import engine_title
from studies.kit.arguments import Out, figures, refuse_repeats
from studies.kit.jobs import Job
from studies.kit.naming import Sources
from studies.kit.options import DEFAULT_RUNNING, OWN_EFFORT, EffortOptions, Running
from studies.kit.plan import Plan, carry_out
from studies.kit.tables import write_table
from studies.measures.claims import said_once, write_findings
from studies.measures.differences import summarize, with_reference, worst_cases
from studies.measures.findings import findings
from studies.measures.posed import posed
from studies.measures.presets import engine_of, in_order, in_words, preset_of
from studies.measures.words import alike, between, capital, in_kinds, part
from studies.measures.wrongness import KINDS
from studies.sources.registry import Effort, core_sources, resolve
from studies.sweep import STUDY

DEFAULT_SOURCES = ("exact", "housner", "modified", "onset-matched", *core_sources())


def command(
    *,
    out: Out,
    figure: Annotated[tuple[int, ...], figures(6, 7, 8, 9)] = (6, 7, 8, 9),
    sources: Sources = DEFAULT_SOURCES,
    effort: EffortOptions = OWN_EFFORT,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Run the paper's sensitivity analysis.

    Parameters
    ----------
    figure
        Figures of the paper: 6, 7 (half-sine), 8, 9 (full-sine); all by default.
    """
    refuse_repeats("--figure", figure)
    effort.refuse_idle(sources)
    return carry_out(STUDY, plan(figure, sources, effort), out, running, report)


def plan(numbers: Sequence[int], sources: Sequence[str], effort: Effort = OWN_EFFORT) -> Plan:
    """Return the plan that puts the cases of some figures to some sources."""
    return Plan(
        jobs=sweep_jobs(numbers, sources, effort),
        settings=asdict(effort),
        growing={"figure": numbers, "source": sources},
    )


def sweep_jobs(numbers: Sequence[int], sources: Sequence[str], effort: Effort) -> list[Job]:
    """Return the jobs in the order of the table: case by case, source by source.

    Parameters
    ----------
    numbers : sequence of int
        Figures of the paper, keys of `studies.cases.paper.SWEEPS`, of 240 cases each.
    sources : sequence of str
        Names that `studies.sources.registry.resolve` knows.
    effort : Effort

    Returns
    -------
    list of Job
        Its labels are the fields of a `studies.cases.paper.Case`.

    Raises
    ------
    KeyError
        If there is no such figure.
    studies.sources.registry.UnknownSourceError
        If there is no such source.
    """
    options = {source: effort.options(source) for source in sources}
    jobs = []
    for case in sweep_cases(numbers):
        labels, block, motion = asdict(case), case.block, case.motion
        jobs += [
            Job(labels=labels, block=block, motion=motion, source=source, options=options[source])
            for source in sources
        ]
    return jobs


def report(folder: Path) -> str:
    """Reduce and draw a folder's sweep.csv; return what it shows, and what of the paper holds."""
    rows = read(folder)
    compared = with_reference(rows)
    table, found = summarize(compared), findings(compared)
    write_table(folder / "summary.csv", table)
    write_findings(folder, found)
    tables = {
        "All figures": over_all(table),
        "The case where each source errs most": worst_cases(compared),
        "The paper's conclusions": pd.DataFrame(
            {
                "holds": [item.verdict for item in said_once(found)],
                "statement": [item.statement for item in said_once(found)],
            }
        ),
    }
    return tell(STUDY, folder, tables)


def finding(folder: Path) -> str:
    """Say what each preset of the engines gets wrong, and how far peaks are off."""
    return f"{capital(posed(read(folder)).words)}. {finding_of(whole(folder))}".rstrip()


def read(folder: Path) -> pd.DataFrame:
    """Read a sweep.csv back."""
    return STUDY.read(folder, "sweep")


def whole(folder: Path) -> pd.DataFrame:
    """Return the lines of a folder's summary.csv that are about all its figures."""
    return over_all(STUDY.read(folder, "summary"))


def over_all(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of a summary that are about all its figures."""
    lines: pd.DataFrame = summary[summary["figure"] == summary["figure"].iloc[-1]]
    return lines.reset_index(drop=True)


def finding_of(lines: pd.DataFrame) -> str:
    """Say what the first and the best of the presets, and each linearization, are off by."""
    parts = _ends(preset_table(lines))
    models = [f"{row['source']} {in_kinds(row)}" for _, row in linearized(lines).iterrows()]
    parts += [f"by linearization: {'; '.join(models)}"] if models else []
    return capital("; ".join(parts)) + "." if parts else ""


def _ends(table: pd.DataFrame) -> list[str]:
    """Say what the first and the best of the presets have wrong and are off by, at worst."""
    names = in_order(table["preset"]) if len(table) else []
    ends = dict.fromkeys([*names[:1], *names[-1:]])
    return [_wrong_by_up_to(name, table[table["preset"] == name]) for name in ends]


def _wrong_by_up_to(preset: str, lines: pd.DataFrame) -> str:
    """Say of a preset what is wrong, source by source or between which counts, and how far."""
    cases = alike([f"{count:.0f}" for count in lines["cases"]])
    said = between(lines, lines["source"].map(engine_title))
    engines = f"{len(lines)} engines get" if len(lines) > 1 else "one engine gets"
    return (
        f"{in_words(preset)}, {engines} {said} of {cases} cases{' each' * (len(lines) > 1)}, and "
        f"peaks off by up to {part(lines['max'].max())}"
    )


def linearized(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the linearizations."""
    kinds = lines["source"].map(lambda source: resolve(source).kind)
    return lines[(kinds == "model") & (lines["source"] != "exact")]


def preset_table(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each preset and engine: outcomes, errors of the peak, time of a case."""
    rows = lines.assign(preset=lines["source"].map(preset_of))
    groups = [rows[rows["preset"] == name] for name in in_order(rows["preset"]) if name]
    if not groups:
        return pd.DataFrame()
    found = pd.concat(groups, ignore_index=True)
    errors = ["median", "p90", "max"]
    lines = found.assign(
        engine=found["source"].map(engine_of),
        right=found["agree"],
        **{name: found[f"{name}_error"] for name in errors},
        ms=1e3 * found["wall_s"] / found["cases"],
    )
    return lines[["preset", "engine", "source", "right", *KINDS, "cases", *errors, "ms"]]


def verdict(table: pd.DataFrame) -> str:
    """Say what the first and the best of the presets have wrong and are off by, at worst.

    Parameters
    ----------
    table : DataFrame
        From `preset_table`, of one folder or several.
    """
    return " ".join(f"{capital(words)}." for words in _ends(table))
