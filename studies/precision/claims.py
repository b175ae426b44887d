"""Error against run time in sentences, each made from the lines of work-precision.csv."""

from __future__ import annotations

import math
from collections.abc import Iterable
from dataclasses import replace

import pandas as pd

from studies.measures.costs import LOOPS, cost_text
from studies.measures.differences import scientific
from studies.measures.words import duration, listed, part, times
from studies.precision.choices import (
    EXACT,
    NEAR,
    TYPICAL,
    Choice,
    cheapest_below,
    choices,
    engines_of,
    exact_cost,
)
from studies.precision.methods import METHODS, Method
from studies.precision.orders import observed_order

PAPERS, STRICT = "RK4, contact to 1e-6", "RK4"
"""The paper's solver, with its criterion for contact and with a strict one."""

AGAIN = 2.0
"""An error that is larger by this factor than at a coarser setting has risen again."""


def claims(table: pd.DataFrame) -> str:
    """Return the findings in sentences."""
    sentences = (
        *_on_exact(table),
        *_on_targets(table),
        *_on_solver(table),
        *_on_papers_criterion(table),
        *_on_orders(table),
        *_on_the_end(table),
    )
    return " ".join(sentences)


def first_claim(table: pd.DataFrame) -> str:
    """Say what the smallest of the targets costs with an engine, and with the paper's solver."""
    reached = [chosen for chosen in choices(table) if chosen.typical is not None]
    if not reached:
        return "No engine setting reaches any of the errors asked for on every typical case."
    last = reached[-1]
    engines = [
        f"{times(chosen.over_exact)} that {words}, {LOOPS[chosen.loop]}"
        for chosen, words in (
            (last.typical, "on typical cases"),
            (last.everywhere, "with those near overturning"),
        )
        if chosen is not None
    ]
    typical = table[table["set"] == TYPICAL]
    own = exact_cost(typical)
    best = cheapest_below(typical[typical["method"] == STRICT], last.target)
    rival = "" if best is None else f", and RK4 {times(best['wall_s'] / own)} it"
    return (
        f"The exact solution takes {duration(own)} a case; an error below {last.target:g} costs "
        f"an engine {listed(engines)}{rival}."
    )


def _on_exact(table: pd.DataFrame) -> Iterable[str]:
    lines = table[table["method"] == EXACT]
    tight = lines[lines["value"] == lines["value"].min()]
    cost = duration(exact_cost(table[table["set"] == TYPICAL]))
    yield (
        f"The exact solution takes {cost} a case from Python, to "
        f"{scientific(float(tight['max_error'].max()))}."
    )


def _on_targets(table: pd.DataFrame) -> Iterable[str]:
    """Say which setting reaches a target on the typical cases, and which on all.

    A target that a tighter one's setting is the cheapest for, too, is passed over.
    """
    found, others = choices(table), choices(table, "python")
    for chosen, other, tighter in zip(found, others, (*found[1:], None), strict=True):
        if chosen.typical is None:
            yield f"No engine setting stays below {part(chosen.target)} on every typical case."
        elif tighter is None or replace(tighter, target=chosen.target) != chosen:
            beside = "" if other == chosen else _beside(other.typical)
            yield _on_target(chosen.target, chosen.typical, chosen.everywhere, beside)


def _on_target(target: float, typical: Choice, everywhere: Choice | None, beside: str) -> str:
    return (
        f"Below {part(target)} on every typical case the cheapest engine setting is "
        f"{typical.setting}: {cost_text(typical.wall_s, typical.runs, ' a case')}, "
        f"{LOOPS[typical.loop]}, {times(typical.over_exact)} the exact solution's{beside}; "
        f"{_elsewhere(typical, target)}{_on_all(typical, everywhere)}."
    )


def _beside(other: Choice | None) -> str:
    """Say what is the cheapest of the engines that are stepped from Python."""
    if other is None:
        return f" (none that is {LOOPS['python']})"
    return f" ({LOOPS[other.loop]}, {other.setting}: {cost_text(other.wall_s, other.runs)})"


def _elsewhere(typical: Choice, target: float) -> str:
    if math.isinf(typical.near_error):
        return "near overturning it gets an outcome wrong"
    too = "" if typical.near_error > target else ", too"
    return f"near overturning it errs by {part(typical.near_error)}{too}"


def _on_all(typical: Choice, everywhere: Choice | None) -> str:
    if everywhere is None:
        return ", and no setting reaches it on all cases"
    if everywhere.setting == typical.setting:
        return ""
    return f", and all cases need {everywhere.setting}, {times(everywhere.over_exact)}"


def _on_solver(table: pd.DataFrame) -> Iterable[str]:
    """Say what the paper's solver costs where its contacts are found well."""
    typical = table[table["set"] == TYPICAL]
    words = []
    for target in (1e-4, 1e-6):
        best = cheapest_below(typical[typical["method"] == STRICT], target)
        if best is not None:
            over = times(best["wall_s"] / exact_cost(table[table["set"] == TYPICAL]))
            words.append(
                f"at most {part(best['max_error'])} in {over} the exact solution's time "
                f"(p dt = {best['value']:g})"
            )
    if words:
        yield f"For scale, RK4 errs by {listed(words)}."


def _on_papers_criterion(table: pd.DataFrame) -> Iterable[str]:
    """Say between what the errors lie under the paper's criterion of contact."""
    lines = table[table["method"] == PAPERS]
    if lines.empty:
        return
    of = dict(iter(lines.groupby("set")))
    words = [
        f"between {scientific(group[name].min())} and {scientific(group[name].max())} {word}"
        for name, word in (("median_error", "in the median"), ("max_error", "at most"))
        for group in (of[TYPICAL],)
    ]
    near = f" ({part(of[NEAR]['max_error'].max())} near overturning)" if NEAR in of else ""
    yield (
        "The paper's criterion for contact, |θ| < 1e-6, keeps RK4 "
        f"{listed(words)}{near} whatever the step."
    )


def _on_orders(table: pd.DataFrame) -> Iterable[str]:
    """Give every observed order with its uncertainty."""
    typical = table[table["set"] == TYPICAL]
    words = [
        f"{name} {order:.2f} ± {spread:.2f}"
        for name, method in METHODS.items()
        if not math.isnan((found := _order(typical, name, method))[0])
        for order, spread in (found,)
    ]
    if words:
        yield f"Observed order of the median error in the step: {', '.join(words)}."


def _order(typical: pd.DataFrame, name: str, method: Method) -> tuple[float, float]:
    return observed_order(typical[typical["method"] == name], method)


def _on_the_end(table: pd.DataFrame) -> Iterable[str]:
    """Say where the errors of steps that land on impacts end, and whether they rise again."""
    typical = engines_of(table[table["set"] == TYPICAL])
    for name, group in typical.groupby("method", sort=False):
        if METHODS[str(name)].source.endswith(":landing"):
            ends = [_end(group, column) for column in ("median_error", "max_error")]
            yield f"{name}: the median error falls to {ends[0]}, the largest to {ends[1]}."


def _end(line: pd.DataFrame, column: str) -> str:
    best = line.sort_values(column).iloc[0]
    finer = line[line["value"] < best["value"]][column]
    risen = finer.max() > AGAIN * best[column] if len(finer) else False
    again = f" and rises again to {scientific(float(finer.max()))} below" if risen else ""
    return f"{scientific(float(best[column]))} at p dt = {best['value']:g}{again}"
