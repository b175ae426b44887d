"""A block that strikes with a corner: what comes out of a coefficient of restitution."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import pandas as pd

from engines import installed_engines
from studies.drawing.kept import Pictures, keep
from studies.kit.arguments import BadInputError, Out, check_engines, several
from studies.kit.options import DEFAULT_RUNNING
from studies.kit.plan import Plan, Tables, carry_out
from studies.kit.tables import read_table
from studies.restitution import STUDY, strikes
from studies.restitution.report import (
    findings_text,
    first_claim,
)
from studies.restitution.ways import WAYS

ASKED = tuple(name for name in installed_engines() if name in WAYS)


def command(*, out: Out, engines: Annotated[tuple[str, ...], several] = ASKED) -> int:
    """Hold what a rocking block keeps at an impact against what was asked.

    Coefficients from 0 to 1, wherever in a step the impact falls: a block of 0.5 by 1 m in the
    preset "fixed" that turns about a corner at half of alpha p and strikes with the other, in steps
    of 1e-3/p, and at another step, rate, height or slenderness.

    Parameters
    ----------
    engines
        Names of engines, without a preset.
    """
    check_engines(engines)
    mute = [name for name in engines if name not in WAYS]
    if mute:
        able = ", ".join(WAYS)
        raise BadInputError(f"--engines is {mute[0]!r}; it must be one that was asked: {able}")

    def tabulate(_: object) -> Tables:
        struck = strikes.measured(engines)
        return {
            "restitution": struck,
            "corners": strikes.lines(struck, strikes.CORNER),
            "rates": strikes.lines(struck, strikes.RATE),
        }

    plan = Plan(settings={"engines": engines}, tabulate=tabulate)
    return carry_out(STUDY, plan, out, DEFAULT_RUNNING, report)


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return them as text."""
    return keep(
        folder, pictures(folder), findings_text(_read(folder, "corners"), _read(folder, "rates"))
    )


def _read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back, with empty words as such."""
    return read_table(folder / f"{name}.csv", "way", "varied", "literal")


def headline(folder: Path) -> str:
    """Say how well engines keep a coefficient."""
    return first_claim(_read(folder, "corners"))


def pictures(folder: Path) -> Pictures:
    """Draw what is found against what is wanted, from a folder's table of rows alone."""
    from studies.restitution.figure import SHOWN, draw_restitution

    rows = _read(folder, "restitution")
    return {name: draw_restitution(rows, shown) for name, shown in SHOWN.items()}
