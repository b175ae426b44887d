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
from studies.advise.reverse import kept_errors, reverse_text
from studies.advise.words import advice_text, claim, settings_text
from studies.drawing.kept import Pictures
from studies.kit import provenance
from studies.kit.arguments import (
    BadInputError,
    NotNegative,
    Place,
    Positive,
    as_bad_input,
    check_engines,
    refuse_given,
    refuse_repeats,
    several,
    several_or_none,
)
from studies.kit.digests import check
from studies.kit.options import DEFAULT_RUNNING, check_written
from studies.kit.plan import Plan, carry_out
from studies.kit.posing import posed_block
from studies.kit.tables import read_table
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.published import PUBLISHED
from studies.measures.slippery import too_slippery
from studies.measures.words import listed

NOTE = (
    "* other outcomes or larger errors, of cases that were run at this very step; a step counts\n"
    "  only where it and every finer published one keep the error, on random cases with "
    f"κ < {WELL_CONDITIONED:g} too"
)
"""Under the table of advice."""


def command(
    *,
    error: Annotated[tuple[Positive, ...], several] = TARGETS,
    engines: Annotated[
        tuple[str, ...] | None, several_or_none, Parameter(name=("--engines", "--engine"))
    ] = None,
    dt: Positive | None = None,
    friction: NotNegative | None = None,
    width: Positive = 0.5,
    height: Positive = 1.5,
    published: Place | None = None,
    out: Place | None = None,
) -> int:
    """Name the cheapest setting of every engine with which all published cases keep an error.

    A step counts if it and every finer published one keep the error on every case on which they
    were published: 24 along all steps, and the paper's with each preset as it is declared; and on
    the random cases that were run at these steps (`rocking steps`), where κ is small. How many
    random cases are off at the step that is advised stands beside it, and who takes the steps:
    a compiled loop, or Python.

    Parameters
    ----------
    error
        Largest relative errors [-] of the peak rotation that are to be kept.
    engines
        Names of engines, without a preset; by default all in the published tables.
    dt
        Your step [s], instead of errors: which error each preset with equal steps keeps with it,
        and its settings as formulas of the step DT, with their values.
    friction
        Coefficient of friction with which settings are written out; by default the preset's, with
        which they were measured.
    width
        Full width B of the block [m] for which settings are written out.
    height
        Full height H of the block [m].
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
    tables = published or PUBLISHED
    block = posed_block(width, height)
    if missing := [name for name in TABLES if not (tables / name).is_file()]:
        raise BadInputError(f"--published is {str(tables)!r}; it must hold {missing[0]}")
    check(tables, TABLES, "--published")
    asked = published_engines(tables) if engines is None else engines
    check_engines(asked)
    with as_bad_input():
        if dt is not None:
            print(_reverse(tables, asked, block, dt, friction))
            return 0
        lines = advice(tables, asked, error, block)
        text = _text(lines, block, tables, friction)
    if out is None:
        print(text)
        return 0
    settings = {"error": error, "engines": asked, "width": width, "height": height}
    plan = Plan(settings=settings, tabulate=lambda _: {"advice": lines})

    def report(folder: Path) -> str:
        from studies.drawing.figures import save_all

        provenance.write_text(folder / "findings.txt", text + "\n")
        save_all(pictures(folder), folder)
        return text

    return carry_out(STUDY, plan, out, DEFAULT_RUNNING, report)


def _reverse(
    published: Path, engines: Sequence[str], block: RigidBlock, dt: float, friction: float | None
) -> str:
    lines = kept_errors(published, engines, block, dt)
    text = reverse_text(lines, block, dt, friction)
    made = fill(f"From {LADDER}, made with {_versions(published)}.", 99)
    return "\n\n".join(filter(None, (text, too_slippery(friction), made)))


def _text(lines: pd.DataFrame, block: RigidBlock, published: Path, friction: float | None) -> str:
    head = f"For a block of {block.width:g} x {block.height:g} m (p = {block.p:.5g} rad/s):"
    return "\n\n".join(
        [
            f"{head}\n{advice_text(lines)}\n{NOTE}{_beyond(block, published)}",
            settings_text(lines, block, friction) or "No setting to write out.",
            *filter(None, [too_slippery(friction)]),
            fill(f"From {listed(read_from(published))}, made with {_versions(published)}.", 99),
        ]
    )


def _beyond(block: RigidBlock, published: Path) -> str:
    """Say where a block is of another shape than any of the published cases."""
    low, high = aspects(published)
    aspect = block.height / block.width
    if low <= aspect <= high:
        return ""
    return (
        f"\nIts H/B is {aspect:.3g}, and that of the published cases from {low:.3g} to {high:.3g}."
    )


def _versions(published: Path) -> str:
    """Return the versions of the engines that the tables were made with."""
    folder = published / Path(TABLES[0]).parent
    try:
        versions = provenance.engines_of(provenance.record_of(folder))
    except (KeyError, TypeError):
        return "unknown versions"
    return listed([f"{name} {version}" for name, version in versions.items()])


def read(folder: Path) -> pd.DataFrame:
    """Read advice back, with empty words as such."""
    return read_table(folder / "advice.csv")


def headline(folder: Path) -> str:
    """Say what keeps each error cheapest."""
    return claim(read(folder))


def pictures(folder: Path) -> Pictures:
    """Draw the price of each error from a folder's advice.csv alone."""
    from studies.advise.figure import draw_advice

    return {"advice": draw_advice(read(folder))}
