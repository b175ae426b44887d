"""A dropped sphere, and a block that strikes: what comes out of a coefficient of restitution."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import pandas as pd

from engines import ENGINES, installed_engines
from studies.kit import provenance
from studies.kit.arguments import BadInputError, Place, check_engines, several
from studies.kit.options import DEFAULT_RUNNING
from studies.kit.plan import Plan, Tables, carry_out
from studies.restitution import STUDY, drops, strikes
from studies.restitution.report import (
    LOST,
    block_claim,
    findings_text,
    first_claim,
    settings_claim,
    told,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure


ASKED = tuple(name for name in installed_engines() if ENGINES[name].bouncing)


def command(*, out: Place, engines: Annotated[tuple[str, ...], several] = ASKED) -> int:
    """Hold what a dropped sphere, and a rocking block, keep at an impact against what was asked.

    Coefficients from 0 to 1, wherever in a step the impact falls: a sphere at a step of 1 ms, 1 m/s
    and a radius of 0.1 m, and with another step, speed or radius; a block of 0.5 by 1 m in the
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
    mute = [name for name in engines if not ENGINES[name].bouncing]
    if mute:
        able = ", ".join(name for name, engine in ENGINES.items() if engine.bouncing)
        raise BadInputError(f"--engines is {mute[0]!r}; it must be one that was asked: {able}")

    def tabulate(_: object) -> Tables:
        dropped, struck = drops.measured(engines), strikes.measured(engines)
        return {
            "restitution": dropped,
            "kept": drops.kept(dropped),
            "strikes": struck,
            "struck": strikes.struck(struck),
        }

    plan = Plan(settings={"engines": engines}, tabulate=tabulate)
    return carry_out(STUDY, plan, out, DEFAULT_RUNNING, report)


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return them as text."""
    from studies.drawing.figures import save_all

    save_all(pictures(folder), folder)
    text = findings_text(_read(folder, "kept"), _read(folder, "struck"))
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
    return first_claim(_read(folder, "kept"))


def paragraph(folder: Path) -> str:
    """Say which setting keeps a coefficient, what a block makes of it, and which ways hold."""
    first = [settings_claim(_read(folder, "kept")), block_claim(_read(folder, "struck"))]
    tables = {"a sphere": "kept", "a block's rate": "struck"}
    held = [told(_read(folder, table), asked) for asked, table in tables.items()]
    return " ".join([*first, *held, LOST])


def pictures(folder: Path) -> "dict[str, Figure]":
    """Draw what is found against what is wanted, from a folder's tables of rows alone."""
    from studies.restitution.figure import BLOCK, SPHERE, draw_restitution

    return {
        "restitution": draw_restitution(_read(folder, "restitution"), SPHERE),
        "strikes": draw_restitution(_read(folder, "strikes"), BLOCK),
    }
