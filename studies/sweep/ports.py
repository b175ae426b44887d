"""Whether what steps another engine's models answers as that engine does."""

from __future__ import annotations

import pandas as pd

from studies.measures.presets import engine_of
from studies.measures.words import listed, out_of, part
from studies.sources.registry import original_of, resolve

CASE = ["figure", "aspect", "width_m", "omega_over_p"]


def port_table(rows: pd.DataFrame) -> pd.DataFrame:
    """Return a line for each source that steps another engine's models, beside the same preset.

    Parameters
    ----------
    rows : DataFrame
        Of a sweep.csv, in which both have answered.
    """
    answers = {
        source: group.set_index(CASE) for source, group in rows.groupby("source", sort=False)
    }
    lines = []
    for source, found in answers.items():
        engine = resolve(str(source)).engine
        beside = str(source).replace(engine, original_of(engine)) if engine else ""
        if beside not in answers:
            continue
        plain = answers[beside].reindex(found.index)
        both = (found["outcome"] == "rocked") & (plain["outcome"] == "rocked")
        change = (found["peak_ratio"] / plain["peak_ratio"] - 1.0).abs()[both]
        lines.append(
            {
                "source": source,
                "beside": beside,
                "cases": len(found),
                "other_outcomes": int((found["outcome"] != plain["outcome"]).sum()),
                "median_change": change.median(),
                "p90_change": change.quantile(0.9),
                "largest_change": change.max(),
                "world_steps": found["steps"].sum(),
            }
        )
    return pd.DataFrame(lines)


def same_physics(lines: pd.DataFrame) -> str:
    """Say of the lines of `port_table` how each engine answers beside the original, at worst."""
    each = lines.groupby(lines["source"].map(engine_of), sort=False)
    worst = each[["cases", "other_outcomes", "median_change", "largest_change"]].max()
    missed = [
        f"{out_of(line['other_outcomes'], line['cases'])} ({engine})"
        for engine, line in worst.iterrows()
    ]
    half, most = (listed([*map(part, worst[name])]) for name in ("median_change", "largest_change"))
    return (
        f"Beside {listed([*lines['beside'].map(engine_of).unique()])} with the same preset the "
        f"outcome is another in {listed(missed)}; half of the peaks differ by up to {half}, the "
        f"others by up to {most}."
    )
