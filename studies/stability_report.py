"""What the study of extreme cases found: tables and a paragraph, from its CSVs alone."""

import math
from pathlib import Path
from textwrap import fill
from typing import Any

import pandas as pd

from studies import provenance
from studies.largest_step import LARGEST_STEP, OWN_CONTACT
from studies.remedies import NOTHING
from studies.sensitivity import FRICTION, with_growth
from studies.verdicts import ACCEPTED, Verdict

ACCEPTED_WORDS = tuple(verdict.value for verdict in ACCEPTED)
ORDER = tuple(verdict.value for verdict in Verdict)


def report(folder: Path) -> str:
    """Reduce and draw a folder's tables; return the text, which findings.txt holds too."""
    from studies.figures import save
    from studies.stability_figure import draw_matrix

    matrix, steps, moved = (_table(folder, name) for name in ("stability", "steps", "sensitivity"))
    moved = with_growth(moved)
    text = moved.to_csv(index=False, na_rep="nan")
    provenance.write_text(folder / "sensitivity.csv", text)
    save(draw_matrix(matrix), folder / "stability.png")
    text = "\n\n".join(
        [
            "Verdicts on the extreme cases:\n" + verdicts_text(matrix),
            "Failures, and the first setting that avoids each:\n" + failures_text(matrix),
            "Largest stable and accurate step, p dt (: over the contact's own time):\n"
            + steps_text(steps),
            "Change of the peak by a perturbation of the amplitude, over that of the exact\n"
            "solution; the median over the cases:\n" + sensitivity_text(moved, "amplitude"),
            "The same for the width:\n" + sensitivity_text(moved, "width"),
            fill(findings(matrix, steps, moved), 99),
        ]
    )
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def _table(folder: Path, name: str) -> pd.DataFrame:
    """Return a table with empty words as such; empty if none of the sources has a row in it."""
    path = folder / f"{name}.csv"
    if not path.is_file():
        return pd.DataFrame()
    return pd.read_csv(path, dtype={"message": str}, keep_default_na=False, na_values=["nan"])


def verdicts_text(matrix: pd.DataFrame) -> str:
    """Return how often each source met each verdict."""
    counts = pd.crosstab(matrix["source"], matrix["verdict"])
    columns = [word for word in ORDER if word in counts]
    table = counts.loc[list(matrix["source"].unique()), columns]
    return table.rename_axis(index=None, columns=None).to_string()


def failures_text(matrix: pd.DataFrame) -> str:
    """Return what went wrong, with its reason and the setting that avoids it."""
    wrong = failures(matrix)
    if wrong.empty:
        return "none"
    shown = wrong[["case", "source", "reason", "remedy"]].rename(columns={"remedy": "avoided by"})
    return left_aligned(shown.assign(reason=shown["reason"].str.slice(0, 80)))


def failures(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is a failure of their source."""
    return matrix[~matrix["verdict"].isin(ACCEPTED_WORDS)]


def left_aligned(table: pd.DataFrame) -> str:
    """Return a table of words."""
    width = {name: max(len(str(name)), int(table[name].str.len().max())) for name in table}
    lines = [{name: str(name) for name in table}, *table.to_dict("records")]
    return "\n".join(
        "  ".join(str(line[name]).ljust(width[name]) for name in table).rstrip() for line in lines
    )


def steps_text(steps: pd.DataFrame) -> str:
    """Return the largest steps: a line for each source, a pair for each problem."""
    if steps.empty:
        return "none of the sources steps"
    cells = steps.assign(
        method=[
            method_name(*pair) for pair in zip(steps["source"], steps["contact_s"], strict=True)
        ],
        cell=[step_cell(row) for _, row in steps.iterrows()],
    )
    table = cells.pivot(index="method", columns="case", values="cell")
    table = table.loc[list(cells["method"].unique()), list(cells["case"].unique())]
    return table.rename_axis(index=None, columns=None).fillna("").to_string()


def method_name(source: str, contact_s: float) -> str:
    """Return a source, with its contact where that has a time of its own."""
    return source if math.isnan(contact_s) else f"{source}, own contact time"


def step_cell(row: "pd.Series[Any]") -> str:
    """Return both largest steps of a row, and over the contact's time where there is one."""
    if row["invalid"]:
        return "not valid"
    pairs = zip(
        (row["largest_stable"], row["largest_accurate"]),
        (row["stable_over_contact"], row["accurate_over_contact"]),
        strict=True,
    )
    return " ".join(_step(value, over) for value, over in pairs)


def _step(value: float, over: float) -> str:
    if math.isnan(value):
        return "-"
    sign = ">" if value >= LARGEST_STEP else ""
    return f"{sign}{value:.2g}" + ("" if math.isnan(over) else f":{over:.2g}")


def sensitivity_text(moved: pd.DataFrame, quantity: str) -> str:
    """Return the median growth over κ for each source and perturbation."""
    part = moved[(moved["quantity"] == quantity) & (moved["delta"] > 0.0)]
    medians = part.groupby(["source", "delta"], sort=False)["change_over_exact"].median()
    table = medians.unstack("delta").map(lambda value: f"{value:.3g}")
    table.columns = [f"{delta:.0e}" for delta in table.columns]
    return table.rename_axis(index=None).to_string()


def findings(matrix: pd.DataFrame, steps: pd.DataFrame, moved: pd.DataFrame) -> str:
    """Return the findings in a few sentences, from the numbers."""
    return " ".join(
        [*_on_verdicts(matrix), *_on_limits(matrix), *_on_steps(steps), *_on_sensitivity(moved)]
    )


def _on_verdicts(matrix: pd.DataFrame) -> list[str]:
    valid = matrix[matrix["verdict"] != "invalid"]
    passed = valid["verdict"].isin(ACCEPTED_WORDS).groupby(valid["source"], sort=False)
    scores = ", ".join(f"{source} {int(good.sum())} of {len(good)}" for source, good in passed)
    wrong = failures(matrix)
    tried = wrong[wrong["remedy"] != ""]
    mended = tried[tried["remedy"] != NOTHING]
    void = matrix[(matrix["invalid"] != "") & (matrix["verdict"] == "invalid")]
    unbounded = int(wrong["reason"].str.contains("not finite|thrown|BADQACC").sum())
    return [
        f"Of the extreme cases where the reference holds, right outcome and a peak within 1 %: "
        f"{scores}.",
        f"Answers that are not finite or throw the block away: {unbounded}; in which energy grows "
        f"in free rocking: {int((wrong['verdict'] == 'energy').sum())}.",
        f"Another setting mends {len(mended)} of {len(wrong)} failures.",
        f"In {void['case'].nunique()} cases an engine differs where the reference itself does not "
        f"hold ({', '.join(void['case'].unique())}).",
    ]


def _on_limits(matrix: pd.DataFrame) -> list[str]:
    """Say where an engine did not get what was asked for, and how far a block crept."""
    sentences = []
    clamped = matrix[(matrix["case"] == "friction 1e9") & (matrix["friction"] < 1e9)]
    if len(clamped):
        sources = ", ".join(clamped["source"])
        sentences.append(
            f"Friction of 1e9 is friction of {clamped['friction'].max():g} in {sources}, the most "
            "that the library takes."
        )
    crept = matrix[(matrix["case"] == "60 s at rest") & matrix["slip_widths"].notna()]
    if len(crept):
        pairs = zip(crept["source"], crept["slip_widths"], strict=True)
        words = ", ".join(f"{source} {slip:.1e} B" for source, slip in pairs)
        sentences.append(f"A block that shakes without rocking and rests for 60 s creeps: {words}.")
    return sentences


def _on_steps(steps: pd.DataFrame) -> list[str]:
    if steps.empty:
        return []
    sentences = []
    for source, group in steps.groupby("source", sort=False):
        usual = group[group["contact_s"].isna() | (source == "mujoco:naive")]
        usual = usual[usual["invalid"] == ""]
        accurate = usual["largest_accurate"]
        if accurate.notna().any():
            missing = int(accurate.isna().sum())
            never = f", none in {missing} of {len(accurate)} problems" if missing else ""
            sentences.append(f"{source} {span(accurate)}{never}")
        else:
            sentences.append(f"{source} none")
    words = f"The largest p dt that is accurate to 1 %: {'; '.join(sentences)}."
    return [words, *_on_contacts(steps)]


def _on_contacts(steps: pd.DataFrame) -> list[str]:
    """Say for which steps a contact with a time of its own is stable."""
    own = steps[steps["source"].str.endswith(":fixed") & steps["contact_s"].notna()]
    return [
        f"A contact of {OWN_CONTACT:g}/p in {source} is stable up to steps of "
        f"{span(group['stable_over_contact'])} of that time and accurate up to "
        f"{span(group['accurate_over_contact'])} of it."
        for source, group in own.groupby("source", sort=False)
    ]


def span(values: "pd.Series[float]") -> str:
    """Return the least and the largest of some numbers."""
    low, high = values.min(), values.max()
    if math.isnan(low):
        return "none"
    return f"{low:.2g}" if low == high else f"{low:.2g}–{high:.2g}"


def _on_sensitivity(moved: pd.DataFrame) -> list[str]:
    part = moved[(moved["quantity"] == "amplitude") & (moved["delta"] > 0.0)]
    follows = (part["change_over_exact"] - 1.0).abs() <= 0.1
    words = [
        f"{source} {_from_which(follows[group.index], group['delta'])}"
        for source, group in part.groupby("source", sort=False)
    ]
    sentences = [
        "A perturbed amplitude moves the peak as far as it moves the exact one, within 10 %: "
        f"{'; '.join(words)}."
    ]
    largest = moved[moved["quantity"] == "friction"].groupby("source", sort=False)["change"]
    if len(largest):
        found = [f"{name} {value:.0e}" for name, value in largest.apply(_largest).items()]
        sentences.append(
            f"Friction, on which the exact peak does not depend, changes ln(peak) "
            f"at {FRICTION:g} by at most: {'; '.join(found)}."
        )
    return sentences


def _from_which(follows: "pd.Series[bool]", delta: "pd.Series[float]") -> str:
    """Say from which size of perturbation on all are followed."""
    rough = delta[~follows].max()
    smooth = delta[delta > rough] if (~follows).any() else delta
    return f"from {smooth.min():.0e} on" if len(smooth) else "at no size tried"


def _largest(values: "pd.Series[float]") -> float:
    return float(values.abs().max())
