"""What was found of restitution, in words and as a table."""

import math

import pandas as pd

from studies.measures.words import listed

GOOD = 0.05
"""A coefficient that comes out within this is kept."""


def kept_text(lines: pd.DataFrame) -> str:
    """Return how far off each way is, engine by engine, and what is set."""
    parts = []
    for engine, group in lines.groupby("engine", sort=False):
        rows = [
            f"  {row['way']}: {_off(row['off'])}; over steps {_off(row['off_dt_s'])}, speeds "
            f"{_off(row['off_speed'])}, sizes {_off(row['off_radius'])}{_broken(row['broken'])}\n"
            f"    for 0.6: {row['literal']}"
            for row in group.to_dict("records")
        ]
        parts.append("\n".join([str(engine), *rows]))
    return "\n".join(parts)


def _off(value: float) -> str:
    return "broken" if value == math.inf else f"{value:.3f}"


def _broken(count: int) -> str:
    return f"; {count} drops broken" if count else ""


def best_of(lines: pd.DataFrame) -> pd.DataFrame:
    """Return the way of each engine that is off least at the base."""
    return lines.loc[lines.groupby("engine", sort=False)["off"].idxmin()]


def first_claim(lines: pd.DataFrame) -> str:
    """Say what each engine's first way makes of restitution, and the best one."""
    words = []
    for row in best_of(lines).to_dict("records"):
        first = lines[lines["engine"] == row["engine"]].iloc[0]
        words.append(
            f"in {row['engine']} it is off by up to {_off(first['off'])} with {first['way']}, and "
            f"by {_off(row['off'])} with {row['literal']}"
        )
    return f"Of a coefficient of restitution from 0 to 1: {listed(words)} (that for 0.6)."


def told(lines: pd.DataFrame) -> str:
    """Say of every way how far off it is, and whether that holds over steps, speeds and sizes."""
    sentences = []
    for engine, group in lines.groupby("engine", sort=False):
        words = [
            f"{row['way']} {_off(row['off'])} (steps {_off(row['off_dt_s'])}, speeds "
            f"{_off(row['off_speed'])}, sizes {_off(row['off_radius'])})"
            for row in group.to_dict("records")
        ]
        holding = group[group[["off", "off_dt_s", "off_speed", "off_radius"]].max(axis=1) <= GOOD]
        held = listed(list(holding["way"])) if len(holding) else "no way"
        sentences.append(
            f"{engine}, largest difference from the coefficient that is wanted: "
            f"{'; '.join(words)}; within {GOOD:g} over all of them: {held}."
        )
    return " ".join(sentences)
