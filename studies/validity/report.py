"""What the map of validity and the engines beyond it say."""

from __future__ import annotations

import math

import pandas as pd

from studies.measures.differences import scientific
from studies.measures.words import listed

CASE = ["aspect", "onsets", "omega_over_p"]


def compared(rows: pd.DataFrame, exact: pd.DataFrame) -> pd.DataFrame:
    """Return the engines' rows beside the exact solution of their cases.

    With the further columns exact_outcome, exact_peak, min_normal, friction_needed, agrees and
    error (relative, of the peak where both rocked).
    """
    named = exact.rename(columns={"outcome": "exact_outcome", "peak_ratio": "exact_peak"})
    joined = rows.merge(named, on=CASE, validate="many_to_one")
    both = (joined["outcome"] == "rocked") & (joined["exact_outcome"] == "rocked")
    return joined.assign(
        agrees=joined["outcome"] == joined["exact_outcome"],
        error=(joined["peak_ratio"] / joined["exact_peak"] - 1.0).where(both),
    )


def first_claim(table: pd.DataFrame) -> str:
    """Say from which amplitude on the reference does not hold, by slenderness."""
    rocked = table[table["outcome"] == "rocked"]
    words = [
        f"{f'from {ends:.2g} onsets' if math.isfinite(ends) else 'never'} at H/B {aspect:g}"
        for aspect, group in rocked.groupby("aspect")
        for ends in (group.loc[group["min_normal"] < 0.0, "onsets"].min(),)
    ]
    return f"An engine is right to differ, because the pivot lifts off: {listed(words)}."


def findings(beside: pd.DataFrame, table: pd.DataFrame) -> str:
    """Say where the reference is valid, what the engines do there, and beyond it."""
    own = beside[beside["friction_factor"].isna()]
    low = beside[beside["friction_factor"].notna()]
    return "\n".join(
        [
            "The reference under a full-sine pulse: where its pivot would lift off (N < 0), in all "
            "cases and in those that survive; the friction it needs where it survives and stays "
            "down.",
            _reference_text(table),
            "",
            "Engines with friction high enough never to slide, by the reference's normal force:",
            _verdict_text(own, _normal_class(own)),
            "",
            "Engines with a part of the friction that the reference needs (its pivot stays down):",
            _verdict_text(low, low["friction_factor"].map("{:g}".format)),
            "",
            "The slide is read up to θcr: that of a block on its way over is not.",
        ]
    )


def _reference_text(table: pd.DataFrame) -> str:
    lines = []
    for aspect, group in table.groupby("aspect"):
        lifts = group["min_normal"] < 0.0
        survives = group["outcome"] == "rocked"
        lost = group[lifts & survives]
        friction = group.loc[~lifts & survives, "friction_needed"]
        lines.append(
            {
                "H/B": f"{aspect:g}",
                "N < 0": f"{lifts.mean():.0%}",
                "of survivors": f"{len(lost) / max(int(survives.sum()), 1):.0%}",
                "from a_p/onset": f"{lost['onsets'].min():.3g}" if len(lost) else "-",
                "least friction": f"{friction.min():.3g}",
                "median": f"{friction.median():.3g}",
                "p90": f"{friction.quantile(0.9):.3g}",
            }
        )
    return pd.DataFrame(lines).to_string(index=False)


def _normal_class(rows: pd.DataFrame) -> pd.Series[str]:
    edges = [-math.inf, -0.5, 0.0, 0.2, math.inf]
    names = ["N < -0.5 mg", "-0.5 to 0", "0 to 0.2", "N > 0.2 mg"]
    return pd.cut(rows["min_normal"], edges, labels=names).astype(str)


def _verdict_text(rows: pd.DataFrame, classes: pd.Series[str]) -> str:
    lines = []
    for (source, name), group in rows.groupby([rows["source"], classes], sort=False):
        survived = group["error"].abs().dropna()
        counts = group["verdict"].value_counts()
        lines.append(
            {
                "source": source,
                "class": name,
                "cases": len(group),
                "held": counts.get("held", 0),
                "lifted off": counts.get("lifted off", 0),
                "slid": counts.get("slid", 0),
                "both": counts.get("slid and lifted off", 0),
                "gone": sum(counts.get(word, 0) for word in ("slid away", "flew off")),
                "failed": counts.get("failed", 0),
                "outcome right": f"{int(group['agrees'].sum())}/{len(group)}",
                "median error": scientific(survived.median()),
                "max error": scientific(survived.max()),
                "max slip/B": scientific(group["slip_widths"].max()),
                "max hop/B": scientific(group["hop_widths"].max()),
            }
        )
    table = pd.DataFrame(lines).sort_values(["source", "class"])
    return table.to_string(index=False)
