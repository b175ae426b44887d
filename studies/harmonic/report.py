"""What the steady states say: branches, doubled periods, overturning, and the engines on them."""

from pathlib import Path
from typing import TYPE_CHECKING

import pandas as pd

from studies.kit import provenance
from studies.measures.differences import scientific
from studies.measures.words import capital, out_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

APART = 1e-3
"""Two branches further apart than this, relative, are two."""


def report(folder: Path) -> str:
    """Draw a folder's tables; write and return the text."""
    from studies.drawing.figures import save_all

    save_all(pictures(folder), folder)
    table, engines = read(folder, "harmonic"), read(folder, "engines")
    text = "\n\n".join([*branches_text(table), *engines_text(engines), paragraph(folder)])
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def read(folder: Path, name: str) -> pd.DataFrame:
    """Read a table of a folder; an empty one if it has no such rows."""
    path = folder / f"{name}.csv"
    return pd.read_csv(path, dtype={"message": str}) if path.is_file() else pd.DataFrame()


def settings_of(folder: Path) -> dict[str, object]:
    """Return what a folder's sweep was asked for, from its provenance."""
    return dict(provenance.record_of(folder)["settings"])


def branches_text(table: pd.DataFrame) -> list[str]:
    """Return where each kind of steady state lies, a line for each run of points."""
    lines = ["Steady states of the exact solution (period in forcing periods; 0: none repeats):"]
    for direction, part in table.groupby("direction", sort=False):
        part = part.sort_values("x")
        kind = part["outcome"].where(part["outcome"] != "rocked", part["period"].astype(str))
        for _, run in part.groupby((kind != kind.shift()).cumsum()):
            first, last = run.iloc[0], run.iloc[-1]
            what = f"period {first['period']}, {first['impacts']} impacts"
            if first["outcome"] != "rocked":
                what = str(first["outcome"])
            elif not first["period"]:
                what = "does not repeat"
            span = f"{run['larger_ratio'].min():.3g} to {run['larger_ratio'].max():.3g} θcr"
            lines.append(
                f"  {direction:4} {first['x']:.4g} to {last['x']:.4g}: {what}"
                + (f", {span}" if first["outcome"] == "rocked" else "")
            )
    return ["\n".join(lines)]


def coexisting(table: pd.DataFrame) -> "pd.Series[bool]":
    """Return, at each abscissa, whether the sweeps up and down settle on different orbits."""
    up, down = (
        table[table["direction"] == name].set_index("x")["larger_ratio"] for name in ("up", "down")
    )
    return (up / down - 1.0).abs() > APART


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
    """Say how many points survive, and at how many abscissae two orbits live side by side."""
    table = read(folder, "harmonic")
    survivors = int((table["outcome"] == "rocked").sum())
    return (
        f"{capital(out_of(survivors, len(table)))} points survive; sweeps up and down settle on "
        f"different orbits at {out_of(int(coexisting(table).sum()), table['x'].nunique())} "
        "abscissae."
    )


def paragraph(folder: Path) -> str:
    """Say how many points settle, on how many two orbits live side by side, and the engines."""
    table, engines = read(folder, "harmonic"), read(folder, "engines")
    rocked = table[table["outcome"] == "rocked"]
    sentence = (
        f"Of {len(table)} points {len(rocked)} survive and {int((rocked['period'] > 0).sum())} "
        f"repeat, {int((rocked['period'] > 1).sum())} of them after more than one forcing period; "
        f"at {int(coexisting(table).sum())} of {table['x'].nunique()} abscissae the sweeps up and "
        "down settle on different orbits."
    )
    if len(engines):
        found = with_error(engines).groupby("source", sort=False)["error"].max()
        words = ", ".join(f"{name} {scientific(value)}" for name, value in found.items())
        sentence += f" Engines on the exact orbit, largest difference of its rotation: {words}."
    return sentence


def pictures(folder: Path) -> dict[str, "Figure"]:
    """Draw the diagram of a folder from its tables alone."""
    from studies.harmonic.figure import draw_harmonic

    swept, asked = read(folder, "harmonic"), settings_of(folder)
    return {"harmonic": draw_harmonic(swept, read(folder, "engines"), str(asked["over"]))}
