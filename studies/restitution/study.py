"""A block that strikes with a corner: what comes out of a coefficient of restitution."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import pandas as pd

from engines import installed_engines
from studies.kit import provenance
from studies.kit.arguments import BadInputError, Place, check_engines, several
from studies.kit.options import DEFAULT_RUNNING
from studies.kit.plan import Plan, Tables, carry_out
from studies.restitution import STUDY, strikes
from studies.restitution.report import (
    LOST,
    findings_text,
    first_claim,
    rate_claim,
    settings_claim,
    told,
)
from studies.restitution.ways import WAYS

if TYPE_CHECKING:
    from matplotlib.figure import Figure


ASKED = tuple(name for name in installed_engines() if name in WAYS)


def command(*, out: Place, engines: Annotated[tuple[str, ...], several] = ASKED) -> int:
    """Hold what a rocking block keeps at an impact against what was asked.

    Coefficients from 0 to 1, wherever in a step the impact falls: a block of 0.5 by 1 m in the
    preset "fixed" that turns about a corner at half of alpha p and strikes with the other, in steps
    of 1e-3/p, and at another step, rate, height or slenderness.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
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
    from studies.drawing.figures import save_all

    save_all(pictures(folder), folder)
    text = findings_text(_read(folder, "corners"), _read(folder, "rates"))
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def _read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back, with empty words as such."""
    words = dict.fromkeys(("way", "varied", "literal"), str)
    return pd.read_csv(
        folder / f"{name}.csv", keep_default_na=False, na_values=["nan"], dtype=words
    )


def headline(folder: Path) -> str:
    """Say how well engines keep a coefficient."""
    return first_claim(_read(folder, "corners"))


def paragraph(folder: Path) -> str:
    """Say which setting keeps a coefficient, what a block makes of it, and which ways hold."""
    corners, rates = _read(folder, "corners"), _read(folder, "rates")
    held = [told(corners, "the coefficient"), told(rates, "the rate")]
    return " ".join([settings_claim(corners), rate_claim(corners, rates), *held, LOST])


def pictures(folder: Path) -> dict[str, Figure]:
    """Draw what is found against what is wanted, from a folder's table of rows alone."""
    from studies.restitution.figure import SHOWN, draw_restitution

    rows = _read(folder, "restitution")
    return {name: draw_restitution(rows, shown) for name, shown in SHOWN.items()}
