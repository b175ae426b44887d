"""Advice from the published tables: which setting keeps an error, in the library's words."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from textwrap import fill
from typing import Annotated

import pandas as pd
from cyclopts import Parameter

from analytic.block import RigidBlock
from studies.advise import STUDY
from studies.advise.choice import TARGETS, advice
from studies.advise.evidence import LADDER, TABLES, aspects, published_engines, read_from
from studies.advise.words import ASK, finding, kept_errors, reverse_text, settings_text, tables
from studies.drawing.kept import WIDTH, as_text, keep
from studies.old import provenance
from studies.old.arguments import (
    NotNegative,
    Place,
    Positive,
    as_bad_input,
    refuse_given,
    refuse_repeats,
    several,
)
from studies.old.naming import Engines
from studies.old.options import DEFAULT_RUNNING, check_written
from studies.old.plan import Plan, carry_out
from studies.old.standing import Height, Width, posed_block
from studies.measures.costs import OUTDATED, STEPPED
from studies.measures.published import published_in, too_slippery
from studies.measures.words import listed


def command(
    *,
    error: Annotated[tuple[Positive, ...], several] = TARGETS,
    engines: Annotated[Engines | None, Parameter(name=("--engines", "--engine"))] = None,
    dt: Positive | None = None,
    friction: NotNegative = 0.8,
    width: Width = 0.5,
    height: Height = 1.5,
    published: Place | None = None,
    out: Place | None = None,
) -> int:
    """Name the cheapest setting of every engine with which all published cases keep an error.

    Parameters
    ----------
    error
        Largest relative errors [-] of the peak rotation that are to be kept.
    engines
        Names of engines, without a preset, of those in the published tables. Of one alone the
        settings are written out.
    dt
        Your step [s], instead of errors: which error each preset with equal steps keeps with it,
        and its settings as formulas of the step DT, with their values.
    friction
        Coefficient of friction for which settings are written out: some, as MuJoCo's impratio,
        belong to it. The errors were measured with the presets' own.
    published
        Folder of the published tables; by default those that come with this project.
    out
        Folder for the advice as a table and a figure; none by default.
    """
    refuse_repeats("--error", error)
    if dt is not None:
        given = None if error is TARGETS else error[0]
        refuse_given({"error": given, "out": out}, "only without --dt")
        check_written(dt)
    block = posed_block(width, height)
    kept = published_in(published, TABLES)
    asked = published_engines(kept) if engines is None else engines
    with as_bad_input():
        if dt is not None:
            print(_reverse(kept, asked, block, dt, friction))
            return 0
        lines = advice(kept, asked, error, block)
        text = _text(lines, block, kept, friction)
    if out is None:
        print(text)
        return 0
    settings = {"error": error, "engines": asked, "width": width, "height": height}
    plan = Plan(settings=settings, tabulate=lambda _: {"advice": lines})
    return carry_out(STUDY, plan, out, DEFAULT_RUNNING, lambda folder: keep(STUDY, folder, text))


def _reverse(
    published: Path, engines: Sequence[str], block: RigidBlock, dt: float, friction: float
) -> str:
    text = reverse_text(kept_errors(published, engines, block, dt), block, dt, friction)
    made = fill(f"From {LADDER}, made with {_versions(published)}.", WIDTH)
    return "\n\n".join(filter(None, (text, too_slippery(friction), made)))


def _text(lines: pd.DataFrame, block: RigidBlock, published: Path, friction: float) -> str:
    engines = lines["engine"].unique()
    written = settings_text(lines, block, friction) or "No setting to write out."
    made = f"From {listed(read_from(published))}, made with {_versions(published)}."
    parts = [
        as_text(finding(lines), tables(lines, block)),
        _beyond(block, published),
        written if len(engines) == 1 else f"{ASK} {engines[0]}",
        too_slippery(friction),
        fill(f"{made} {STEPPED} {OUTDATED}", WIDTH),
    ]
    return "\n\n".join(filter(None, parts))


def _beyond(block: RigidBlock, published: Path) -> str:
    low, high = aspects(published)
    aspect = block.height / block.width
    if low <= aspect <= high:
        return ""
    return f"Its H/B is {aspect:.3g}, and that of the published cases from {low:.3g} to {high:.3g}."


def _versions(published: Path) -> str:
    folder = published / Path(TABLES[0]).parent
    try:
        versions = provenance.engines_of(provenance.record_of(folder))
    except (KeyError, TypeError):
        return "unknown versions"
    asked = {name: kept for name, kept in versions.items() if kept != provenance.NOT_INSTALLED}
    return listed([f"{name} {version}" for name, version in asked.items()])
