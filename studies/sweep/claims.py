"""What the paper's cases say about each source: the engines by preset, and the linearizations."""

from __future__ import annotations

from pathlib import Path

import pandas as pd

from studies.measures.posed import Posed
from studies.measures.presets import engine_of, in_order, in_words, preset_of
from studies.measures.words import (
    alike,
    between,
    capital,
    in_kinds,
    part,
)
from studies.measures.wrongness import KINDS
from studies.sources.registry import resolve


def whole(folder: Path) -> pd.DataFrame:
    """Return the lines of a folder's summary.csv that are about all its figures."""
    return over_all(pd.read_csv(folder / "summary.csv"))


def over_all(summary: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of a summary that are about all its figures."""
    lines: pd.DataFrame = summary[summary["figure"] == summary["figure"].iloc[-1]]
    return lines.reset_index(drop=True)


def engines_by_preset(lines: pd.DataFrame) -> dict[str, pd.DataFrame]:
    """Return the engines' lines of a summary, by preset, in the order in which these get better."""
    rows = lines.assign(preset=lines["source"].map(preset_of))
    rows = rows[rows["preset"] != ""]
    return {name: rows[rows["preset"] == name] for name in in_order(rows["preset"])}


def first_claim(lines: pd.DataFrame) -> str:
    """Say what the first and the best of the presets, and each linearization, are off by."""
    groups = engines_by_preset(lines)
    parts = [
        _wrong_by_up_to(preset, groups[preset]["max_error"], groups[preset])
        for preset in dict.fromkeys([*groups][:1] + [*groups][-1:])
    ]
    models = [f"{row['source']} {in_kinds(row)}" for _, row in linearized(lines).iterrows()]
    parts += [f"by linearization: {'; '.join(models)}"] if models else []
    return capital("; ".join(parts)) + "."


def _wrong_by_up_to(preset: str, errors: pd.Series[float], lines: pd.DataFrame) -> str:
    """Say of a preset what is wrong, source by source or between which counts, and how far."""
    cases = alike([f"{count:.0f}" for count in lines["cases"]])
    said = between(lines, lines["source"].map(engine_of))
    engines = f"{len(lines)} engines have" if len(lines) > 1 else "one engine has"
    return (
        f"{in_words(preset)}, {engines} {said} of {cases} cases{' each' * (len(lines) > 1)}, and "
        f"peaks off by up to {part(errors.max())}"
    )


def linearized(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the linearizations."""
    kinds = lines["source"].map(lambda source: resolve(source).kind)
    return lines[(kinds == "model") & (lines["source"] != "exact")]


def preset_table(lines: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each preset and engine: outcomes, errors of the peak, time of a case."""
    groups = engines_by_preset(lines)
    if not groups:
        return pd.DataFrame()
    found = pd.concat(groups.values(), ignore_index=True)
    return pd.DataFrame(
        {
            "preset": found["preset"],
            "engine": found["source"].map(engine_of),
            "source": found["source"],
            "right": found["agree"],
            **{kind: found[kind] for kind in KINDS},
            "cases": found["cases"],
            "median": found["median_error"],
            "p90": found["p90_error"],
            "max": found["max_error"],
            "ms": 1e3 * found["wall_s"] / found["cases"],
        }
    )


def verdict(table: pd.DataFrame, asked: Posed) -> str:
    """Say what was asked, and what the first and the best of the presets are off by, at worst.

    Parameters
    ----------
    table : DataFrame
        From `preset_table`, of one folder or several.
    asked : Posed
        What was asked.
    """
    names = in_order(table["preset"])
    ends = {name: table[table["preset"] == name] for name in (names[0], names[-1])}
    parts = [_wrong_by_up_to(name, lines["max"], lines) for name, lines in ends.items()]
    return f"{capital(asked.words)}. {' '.join(f'{capital(words)}.' for words in parts)}"
