"""What the study of extreme cases found, in a paragraph made from its tables."""

from __future__ import annotations

import math
from collections.abc import Iterable

import pandas as pd

from analytic.response import Reason
from studies.measures.differences import scientific
from studies.measures.presets import engine_of, in_order, in_words, is_engine, preset_of
from studies.measures.verdicts import ACCEPTED, Verdict
from studies.measures.words import NAMED, capital, each_out_of, in_kinds, listed, meant, out_of
from studies.measures.wrongness import KINDS
from studies.sources.registry import resolve
from studies.stability.largest_step import OWN_CONTACT
from studies.stability.remedies import NOTHING
from studies.stability.sensitivity import FRICTION

UNBOUNDED = (Reason.DIVERGED, Reason.THROWN, Reason.FAULT)
"""Failures in which a response has no bound."""

REFERENCE = "exact"
"""The source that all others are held against."""

ACCEPTED_WORDS = tuple(verdict.value for verdict in ACCEPTED)


def findings(matrix: pd.DataFrame, steps: pd.DataFrame, moved: pd.DataFrame) -> str:
    """Return the findings in a few sentences, from the numbers."""
    return " ".join(
        [*_on_verdicts(matrix), *_on_limits(matrix), *_on_steps(steps), *_on_sensitivity(moved)]
    )


def first_claim(matrix: pd.DataFrame) -> str:
    """Say how many of the extreme cases each preset gets right, of how many engines and cases.

    Cases beyond what the reference is valid for are in no count.
    """
    asked = _asked(matrix)
    right = (asked["verdict"] == Verdict.GOOD.value).groupby(asked["source"], sort=False)
    counts: dict[str, list[tuple[int, int]]] = {}
    for source, good in right:
        counts.setdefault(preset_of(str(source)), []).append((int(good.sum()), len(good)))
    engines = list(dict.fromkeys(map(engine_of, asked["source"])))
    named = listed(engines) if len(engines) <= NAMED else f"{len(engines)} engines"
    verb = "get" if len(engines) > 1 else "gets"
    parts = [
        f"{in_words(name)} {_counted(counts[name], len(engines))}" for name in in_order(counts)
    ]
    return f"Of extreme cases {named} {verb} right: {', '.join(parts)}."


def left_out(matrix: pd.DataFrame) -> str:
    """Name the engines that have a preset with which they were not asked, and who had no answer."""
    asked = _asked(matrix)
    presets = dict.fromkeys(map(preset_of, asked["source"]))
    words = "; ".join([*_not_asked(asked["source"].unique(), presets), *_no_answers(asked)])
    return f"{capital(words)}. " if words else ""


def _asked(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows of engines on cases for which the reference is valid."""
    valid = matrix["verdict"] != Verdict.INVALID.value
    return matrix[matrix["source"].map(is_engine) & valid]


def _counted(pairs: list[tuple[int, int]], engines: int) -> str:
    """Return how many are right of how many, of each engine or of all; and of how many engines."""
    right, total = zip(*pairs, strict=True)
    if len(pairs) <= NAMED:
        return each_out_of(right, total)
    few = f" ({len(pairs)} engines)" if len(pairs) < engines else ""
    return f"{out_of(sum(right), sum(total))}{few}"


def _not_asked(sources: Iterable[str], presets: Iterable[str]) -> list[str]:
    """Name the engines that have one of the presets, and were not asked with it."""
    asked = {(engine_of(source), preset_of(source)): resolve(source) for source in sources}
    words = []
    for name in in_order(presets):
        have = [
            engine
            for engine, declared in {key[0]: its.declared for key, its in asked.items()}.items()
            if any(preset.name == name for preset in declared.presets)
        ]
        missing = [engine for engine in have if (engine, name) not in asked]
        words += [f"{listed(missing)} {in_words(name)}"] if missing else []
    return [f"not asked: {', '.join(words)}"] if words else []


def _no_answers(asked: pd.DataFrame) -> list[str]:
    """Name who gave no answer, and in how many of the cases that count."""
    lost = asked.loc[asked["verdict"] == Verdict.FAILED.value, "source"].map(engine_of)
    words = [f"{engine} in {count}" for engine, count in lost.value_counts().items()]
    return [f"no answer: {listed(words)}"] if words else []


def verdicts_sentence(matrix: pd.DataFrame) -> str:
    """Return how many of the extreme cases each source gets right, strictly counted.

    A rocking too small to be seen is told apart from a right answer, and so is a case beyond what
    the reference is valid for, where no answer is wrong.
    """
    others = matrix[matrix["source"] != REFERENCE]
    scores = "; ".join(
        _score(str(source), rows["verdict"])
        for source, rows in others.groupby("source", sort=False)
    )
    return (
        "Extreme cases, outcome right and peak within 1 % or 1e-6 of θcr, counted strictly: "
        f"{scores}. The kinds are {meant()}. "
        f"{left_out(matrix)}{reference_sentence(matrix)}".rstrip()
    )


def _score(source: str, verdicts: pd.Series[str]) -> str:
    counts = verdicts.value_counts()
    beyond, unseen = (
        int(counts.get(verdict.value, 0)) for verdict in (Verdict.INVALID, Verdict.UNSEEN)
    )
    good = int(counts.get(Verdict.GOOD.value, 0))
    wrong = {kind: counts.get(kind, 0) for kind in KINDS}
    besides = [
        *([in_kinds(wrong)] if any(wrong.values()) else []),
        *([f"{unseen} too small to be seen"] if unseen else []),
        *([f"{beyond} more beyond the reference"] if beyond else []),
    ]
    return f"{source} {out_of(good, len(verdicts) - beyond)}" + (
        f" ({', '.join(besides)})" if besides else ""
    )


def reference_sentence(matrix: pd.DataFrame) -> str:
    """Say how the exact solution stands beside the independent integrators of the same equation.

    It is what all others are held against, so that its own verdicts say nothing.
    """
    peers = matrix[matrix["source"].map(lambda source: resolve(source).kind == "peer")]
    if peers.empty:
        return ""
    same = int((peers["outcome"] == peers["exact_outcome"]).sum())
    apart = (peers["peak_ratio"] - peers["exact_peak"]).where(peers["error"].notna()).abs().max()
    return (
        "The exact solution is what the others are held against; beside it the independent "
        f"integrators {listed(list(peers['source'].unique()))} have the same outcome in "
        f"{out_of(same, len(peers))} runs, and peaks within {scientific(float(apart))} of θcr."
    )


def _on_verdicts(matrix: pd.DataFrame) -> list[str]:
    wrong = failures(matrix)
    tried = wrong[wrong["remedy"] != ""]
    remedied = tried[tried["remedy"] != NOTHING]
    void = matrix[(matrix["invalid"] != "") & (matrix["verdict"] == "invalid")]
    unbounded = int(wrong["failure"].isin([reason.name for reason in UNBOUNDED]).sum())
    return [
        verdicts_sentence(matrix),
        f"Answers that are not finite, throw the block away, or that the engine itself calls "
        f"faulty: {unbounded}; in which energy grows "
        f"in free rocking: {int((wrong['verdict'] == 'energy').sum())}.",
        f"Another setting mends {len(remedied)} of {len(wrong)} failures.",
        f"In {void['case'].nunique()} cases an engine differs where the reference itself does not "
        f"hold ({'; '.join(void['case'].unique())}).",
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
        usual = group[~with_own_contact(group)]
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


def with_own_contact(steps: pd.DataFrame) -> pd.Series[bool]:
    """Return which rows are of a contact that was given a time of its own.

    With its defaults a library may have one by itself.
    """
    return steps["source"].str.endswith(":fixed") & steps["contact_s"].notna()


def _on_contacts(steps: pd.DataFrame) -> list[str]:
    """Say for which steps a contact with a time of its own is stable."""
    own = steps[with_own_contact(steps)]
    return [
        f"A contact of {OWN_CONTACT:g}/p in {source} is stable up to steps of "
        f"{span(group['stable_over_contact'])} of that time and accurate up to "
        f"{span(group['accurate_over_contact'])} of it."
        for source, group in own.groupby("source", sort=False)
    ]


def span(values: pd.Series[float]) -> str:
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


def _from_which(follows: pd.Series[bool], delta: pd.Series[float]) -> str:
    """Say from which size of perturbation on all are followed."""
    rough = delta[~follows].max()
    smooth = delta[delta > rough] if (~follows).any() else delta
    return f"from {smooth.min():.0e} on" if len(smooth) else "at no size tried"


def _largest(values: pd.Series[float]) -> float:
    return float(values.abs().max())


def failures(matrix: pd.DataFrame) -> pd.DataFrame:
    """Return the rows whose verdict is a failure of their source."""
    return matrix[~matrix["verdict"].isin(ACCEPTED_WORDS)]
