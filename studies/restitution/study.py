"""A block that strikes with a corner: what comes out of a coefficient of restitution."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from engines import installed_engines
from studies.drawing.kept import tell
from studies.old.arguments import BadInputError, Out
from studies.old.naming import Engines
from studies.old.options import DEFAULT_RUNNING
from studies.old.plan import Plan, Tables, carry_out
from studies.measures.words import listed
from studies.restitution import STUDY, strikes
from studies.restitution.strikes import BASE, VARIED
from studies.restitution.ways import SHOWN, WAYS, WITHOUT

ASKED = tuple(name for name in installed_engines() if name in WAYS)

GOOD = 0.05
"""A coefficient that comes out within this is kept."""

USUAL = f"{BASE.step:g}/p, {BASE.rate:g} α p, {BASE.height:g} m and H/B {BASE.aspect:g}"
"""From which one thing at a time is varied."""

RANGES = listed(
    [
        words.format(f"{min(ends):.2g} to {max(ends):.2g}")
        for words, name in (
            *(("steps of {}/p", "step"), ("rates of {} α p", "rate")),
            *(("heights of {} m", "height"), ("H/B of {}", "aspect")),
        )
        for ends in [(*VARIED[name], getattr(BASE, name))]
    ]
)
"""Over what strikes are varied."""


def command(*, out: Out, engines: Engines = ASKED) -> int:
    """Hold what a rocking block keeps at an impact against what was asked.

    Parameters
    ----------
    engines
        Names of engines, without a preset.
    """
    mute = [name for name in engines if name not in WAYS]
    if mute:
        why = f", which has no coefficient: {WITHOUT[mute[0]]}" if mute[0] in WITHOUT else ""
        able = ", ".join(WAYS)
        raise BadInputError(f"--engines is {mute[0]!r}{why}; it must be one that was asked: {able}")

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
    corners, rates = STUDY.read(folder, "corners"), STUDY.read(folder, "rates")
    said = "^(engine|way|off)"
    tables = {
        f"Largest difference of the speed upwards of a corner that strikes the base, over that of "
        f"its approach, from the coefficient that is wanted, at {USUAL}, wherever in a step the "
        f"impact falls, and over {RANGES}; the strikes that broke; and the corner's largest speed "
        "along the base": corners.filter(regex=f"{said}|^broken|^slide"),
        f"What is set for {SHOWN:g}, DT being the step in seconds": (
            corners[["engine", "way", "literal"]]
        ),
        "Largest difference of the angular rate of the block, after over before, from 1 - 3/2 (1 + "
        "e) sin^2(alpha), of the same strikes": rates.filter(regex=said),
    }
    none = pd.DataFrame(list(WITHOUT.items()), columns=["engine", "instead"])
    return tell(STUDY, folder, {**tables, "Without a coefficient": none})


def finding(corners: pd.DataFrame) -> str:
    """Say how well the engines keep a coefficient at best, and who does not as first asked."""
    best = corners.loc[corners.groupby("engine", sort=False)["off_over_all"].idxmin()]
    first = corners.drop_duplicates("engine")
    lost = list(first.loc[first["off"] > 10.0 * GOOD, "engine"])
    beside = f"; asked in the first way that comes to mind, {listed(lost)} miss it" if lost else ""
    return (
        "With each engine's best setting a coefficient of restitution comes out within "
        f"{_ends(best, 'off')} as usually struck, and within {_ends(best, 'off_over_all')} in all "
        f"strikes that were tried{beside}."
    )


def _ends(best: pd.DataFrame, column: str) -> str:
    ends = best.sort_values(column).iloc[[0, -1]][[column, "engine"]].to_numpy()
    return " to ".join(dict.fromkeys(f"{value:.3f} in {engine}" for value, engine in ends))
