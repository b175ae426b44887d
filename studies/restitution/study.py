"""A sphere dropped on a base: what comes out of a coefficient of restitution."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import pandas as pd

from engines import ENGINES, core_engines
from studies.kit import provenance
from studies.kit.arguments import BadInputError, Place, check_engines, several
from studies.kit.options import DEFAULT_RUNNING
from studies.kit.plan import Plan, Tables, carry_out
from studies.restitution import STUDY
from studies.restitution.drops import BASE, PHASES, kept, measured
from studies.restitution.report import first_claim, kept_text, told

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def command(*, out: Place, engines: Annotated[tuple[str, ...], several] = core_engines()) -> int:
    """Drop a sphere on a base, and hold the speed after over before against what was asked for.

    Coefficients from 0 to 1, at a step of 1 ms, 1 m/s and a radius of 0.1 m, wherever in a step the
    impact falls; and with another step, speed or radius.

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
        rows = measured(engines)
        return {"restitution": rows, "kept": kept(rows)}

    plan = Plan(settings={"engines": engines}, tabulate=tabulate)
    return carry_out(STUDY, plan, out, DEFAULT_RUNNING, report)


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return them as text."""
    from studies.drawing.figures import save_all

    save_all(pictures(folder), folder)
    text = "\n".join(
        [
            "Largest difference of the speed after over before from the coefficient that is",
            f"wanted, 0 to 1, at {BASE.dt_s:g} s, {BASE.speed:g} m/s and a radius of "
            f"{BASE.radius:g} m, wherever",
            f"in a step the impact falls ({len(PHASES)} places); over steps, speeds and sizes:",
            kept_text(_read(folder, "kept")),
        ]
    )
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def _read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table back, with empty words as such."""
    words = dict.fromkeys(("way", "varied", "literal"), str)
    return pd.read_csv(
        folder / f"{name}.csv", keep_default_na=False, na_values=["nan"], dtype=words
    )


def headline(folder: Path) -> str:
    """Say what each engine makes of a coefficient, and which setting keeps it."""
    return first_claim(_read(folder, "kept"))


def paragraph(folder: Path) -> str:
    """Say of every way how far off it is."""
    return told(_read(folder, "kept"))


def pictures(folder: Path) -> "dict[str, Figure]":
    """Draw what is found against what is wanted from a folder's restitution.csv alone."""
    from studies.restitution.figure import draw_restitution

    return {"restitution": draw_restitution(_read(folder, "restitution"))}
