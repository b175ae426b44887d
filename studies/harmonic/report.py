"""What the steady states say: branches, their shares of the starts, and the engines on them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from analytic.response import Outcome
from studies.drawing.kept import Pictures, keep
from studies.kit import provenance
from studies.measures.differences import scientific
from studies.measures.words import out_of

NO_PERIOD = "does not repeat"
NOUNS = {"frequency": "At {} frequencies", "amplitude": "At {} amplitudes"}


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return the text."""
    table, engines = read(folder, "harmonic"), read(folder, "engines")
    return keep(
        folder,
        pictures(folder),
        "\n\n".join([branches_text(table), *engines_text(engines), counts_text(folder)]),
    )


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table of a folder; an empty one if it has no such rows."""
    path = folder / f"{name}.csv"
    return pd.read_csv(path, dtype={"message": str}) if path.is_file() else pd.DataFrame()


def settings_of(folder: Path) -> dict[str, object]:
    """Return what a folder's sweep was asked for, from its provenance."""
    return dict(provenance.record_of(folder)["settings"])


def branches_text(table: pd.DataFrame) -> str:
    """Return where each kind of attractor lives and for what share of the starts, run by run."""
    lines = [
        "Attractors of the exact solution (period in forcing periods; orbits that are mirror "
        "images are one, and all that do not repeat; 0 % of the starts: found by following the "
        "orbit from the next point):"
    ]
    for kind, rows in runs(table):
        peaks = rows["larger_ratio"]
        size = f", {_range(peaks, '.3g')} θcr" if np.isfinite(peaks).all() else ""
        share = _range(100.0 * rows["start_share"], ".0f")
        lines.append(f"  {_range(rows['x'], '.4g')}: {kind}{size}, {share} % of the starts")
    return "\n".join(lines)


def _range(values: pd.Series[float], form: str) -> str:
    return " to ".join(dict.fromkeys(format(end, form) for end in (values.min(), values.max())))


def kind_of(row: pd.Series[Any]) -> str:
    """Return what a row of harmonic.csv is: an orbit of some period, or another end."""
    if row["outcome"] != Outcome.ROCKED.value:
        return str(row["outcome"])
    return f"period {row['period']}, {row['impacts']} impacts" if row["period"] else NO_PERIOD


def runs(table: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """Yield each kind of attractor with its rows, for every run of neighbouring abscissae."""
    grid = {x: place for place, x in enumerate(sorted(table["x"].unique()))}
    for kind, rows in table.groupby(table.apply(kind_of, axis=1), sort=False):
        rows = rows.sort_values("x", kind="stable")
        for _, run in rows.groupby((rows["x"].map(grid).diff() > 1).cumsum()):
            yield str(kind), run


def counts(table: pd.DataFrame) -> dict[str, int]:
    """Count abscissae: of several steady states, of a longer period, of some and all overturned."""
    steady = table["outcome"].isin([Outcome.ROCKED.value, Outcome.AT_REST.value])
    states = steady.groupby(table["x"]).sum()
    fallen = (table["outcome"] == Outcome.OVERTURNED.value).groupby(table["x"]).any()
    return {
        "all": len(states),
        "several": int((states > 1).sum()),
        "longer": table.loc[table["period"] > 1, "x"].nunique(),
        "both": int((fallen & (states > 0)).sum()),
        "fallen": int((fallen & (states == 0)).sum()),
    }


def engines_text(engines: pd.DataFrame) -> list[str]:
    """Return how far each engine is from the exact orbit on which it started."""
    if engines.empty:
        return []
    found = with_error(engines)
    lines = ["Engines after some time on the exact orbit, difference of its larger rotation:"]
    for source, rows in found.groupby("source", sort=False):
        kept = rows["error"].dropna()
        lines.append(
            f"  {source}: median {scientific(kept.median())}, largest {scientific(kept.max())}, "
            f"{len(rows) - len(kept)} of {len(rows)} left it"
        )
    return ["\n".join(lines)]


def with_error(engines: pd.DataFrame) -> pd.DataFrame:
    """Return an engines.csv with the relative difference from the exact orbit."""
    return engines.assign(error=(engines["larger_ratio"] / engines["larger_exact"] - 1.0).abs())


def headline(folder: Path) -> str:
    """Say at how many abscissae several steady states live, and where the start decides a fall."""
    found = counts(read(folder, "harmonic"))
    several, both = out_of(found["several"], found["all"]), out_of(found["both"], found["all"])
    over = settings_of(folder)["over"]
    return (
        f"{NOUNS[str(over)].format(several)} a block has more than one steady state, and at {both} "
        "its start decides whether it overturns."
    )


def counts_text(folder: Path) -> str:
    """Say from how many starts how many steady states were found, and where."""
    found, side = counts(read(folder, "harmonic")), settings_of(folder)["starts"]
    total = found["all"]
    return (
        f"From {side} rotations by {side} rates at each of {total} abscissae, with steady states "
        f"counted and overturning not: {out_of(found['several'], total)} have more than one, "
        f"{out_of(found['longer'], total)} one that takes more than one forcing period; at "
        f"{out_of(found['both'], total)} some starts overturn and others do not, at "
        f"{out_of(found['fallen'], total)} all overturn. An orbit may live where no start of the "
        "grid found it."
    )


def pictures(folder: Path) -> Pictures:
    """Draw the diagram of a folder from its tables alone."""
    from studies.harmonic.figure import draw_harmonic

    swept, asked = read(folder, "harmonic"), settings_of(folder)
    return {"harmonic": draw_harmonic(swept, read(folder, "engines"), str(asked["over"]))}
