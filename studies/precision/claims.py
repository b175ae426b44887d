"""Error against run time in sentences, each made from the lines of work-precision.csv."""

import math
from collections.abc import Iterable

import numpy as np
import pandas as pd

from studies.measures.differences import scientific
from studies.measures.words import duration, listed, part, times
from studies.precision.methods import METHODS, Method
from studies.precision.orders import observed_order
from studies.sources.registry import resolve

TYPICAL, NEAR = "typical", "near overturning"
"""The sets of cases."""

ALL = "all"
"""Both sets together."""

CHOICE = [
    *("target", "among", "method", "value", "setting", "wall_s", "over_exact"),
    *("typical_error", "near_error"),
]
"""Columns of `choices`."""

TARGETS = (0.1, 1e-2, 1e-3, 1e-4)
"""Errors that somebody may ask for."""

EXACT, PAPERS, STRICT = "Taylor series", "RK4, contact to 1e-6", "RK4"
"""Methods of which a sentence is made."""

AGAIN = 2.0
"""An error that is larger by this factor than at a coarser setting has risen again."""


def kind_of(name: str) -> str:
    """Return what kind of source a method is of."""
    return resolve(METHODS[name].source).kind


def engines_of(table: pd.DataFrame) -> pd.DataFrame:
    """Return the lines of the engines along their steps."""
    engine = [
        name
        for name in table["method"].unique()
        if name in METHODS and METHODS[name].stepping and kind_of(name) == "engine"
    ]
    return table[table["method"].isin(engine)]


def at_name(line: "pd.Series[float]") -> str:
    """Return a method with its setting."""
    method = METHODS[str(line["method"])]
    if not method.setting:
        return str(line["method"])
    setting = "p dt" if method.setting == "step" else method.setting
    return f"{line['method']} at {setting} = {line['value']:g}"


def exact_cost(lines: pd.DataFrame) -> float:
    """Return the mean time [s] of a case by the exact solution at its tightest tolerance."""
    exact = lines[lines["method"] == EXACT]
    tight = exact[exact["value"] == exact["value"].min()]
    return float(np.average(tight["wall_s"], weights=tight["cases"]))


def joint(table: pd.DataFrame) -> pd.DataFrame:
    """Return both sets of a setting as one line: failures, largest error, mean time of a case."""
    groups = table.groupby(["method", "value"], sort=False)
    weighted = table.assign(total=table["wall_s"] * table["cases"])
    totals = weighted.groupby(["method", "value"], sort=False)[["total", "cases"]].sum()
    found = groups.agg(failed=("failed", "sum"), max_error=("max_error", "max")).reset_index()
    return found.assign(
        wall_s=(totals["total"] / totals["cases"]).to_numpy(), cases=totals["cases"].to_numpy()
    )


def cheapest_below(table: pd.DataFrame, target: float) -> "pd.Series[float] | None":
    """Return the cheapest line whose largest error is below a target, if there is one."""
    good = table[(table["failed"] == 0) & (table["max_error"] <= target)]
    return None if good.empty else good.loc[good["wall_s"].idxmin()]


def choices(table: pd.DataFrame) -> pd.DataFrame:
    """Return, for each target, the cheapest setting of an engine, and what it does elsewhere.

    A line each for the typical cases and for all of them, those near overturning included: method,
    value, time of a case, and the largest error on either set (inf where an outcome is wrong).
    """
    engines = engines_of(table)
    typical = table["set"] == TYPICAL
    largest = engines.pivot(index=["method", "value"], columns="set", values="max_error")
    among = {
        TYPICAL: (engines[engines["set"] == TYPICAL], exact_cost(table[typical])),
        ALL: (joint(engines), exact_cost(table)),
    }
    lines = []
    for target in TARGETS:
        for name, (part_of, exact_s) in among.items():
            line: dict[str, object] = {"target": target, "among": name}
            best = cheapest_below(part_of, target)
            if best is not None:
                errors = largest.loc[(best["method"], best["value"])]
                line |= {
                    "method": best["method"],
                    "value": best["value"],
                    "setting": at_name(best),
                    "wall_s": best["wall_s"],
                    "over_exact": best["wall_s"] / exact_s,
                    "typical_error": errors[TYPICAL],
                    "near_error": errors[NEAR],
                }
            lines.append(line)
    return pd.DataFrame(lines, columns=CHOICE)


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


def first_claims(table: pd.DataFrame) -> str:
    """Return what a reader should know first: the exact solution, the engines, the solver."""
    return " ".join((*_on_exact(table), *_on_targets(table, (1e-2, 1e-4)), *_on_solver(table)))


def _on_exact(table: pd.DataFrame) -> Iterable[str]:
    lines = table[table["method"] == EXACT]
    tight = lines[lines["value"] == lines["value"].min()]
    yield (
        f"The exact solution takes {duration(exact_cost(table[table['set'] == TYPICAL]))} a case from Python, to "
        f"{scientific(float(tight['max_error'].max()))}."
    )


def _on_targets(table: pd.DataFrame, targets: tuple[float, ...] = TARGETS) -> Iterable[str]:
    """Say which setting reaches a target on the typical cases, and which on all.

    A target that a tighter one's setting is the cheapest for, too, is passed over.
    """
    chosen = choices(table).set_index(["target", "among"])
    settings = chosen["setting"].unstack("among")
    for target, tighter in zip(targets, (*targets[1:], None), strict=True):
        if tighter is not None and settings.loc[target].equals(settings.loc[tighter]):
            continue
        typical, everywhere = chosen.loc[(target, TYPICAL)], chosen.loc[(target, ALL)]
        if not isinstance(typical["method"], str):
            yield f"No engine setting stays below {part(target)} on every typical case."
            continue
        yield (
            f"Below {part(target)} on every typical case the cheapest engine setting is "
            f"{typical['setting']}: {duration(typical['wall_s'])} a case, "
            f"{times(typical['over_exact'])} the exact solution's; {_elsewhere(typical, target)}"
            f"{_on_all(typical, everywhere)}."
        )


def _elsewhere(line: "pd.Series[float]", target: float) -> str:
    error = float(line["near_error"])
    if math.isinf(error):
        return "near overturning it gets an outcome wrong"
    return f"near overturning it errs by {part(error)}" + ("" if error > target else ", too")


def _on_all(typical: "pd.Series[float]", everywhere: "pd.Series[float]") -> str:
    if not isinstance(everywhere["method"], str):
        return ", and no setting reaches it on all cases"
    if everywhere["setting"] == typical["setting"]:
        return ""
    return f", and all cases need {everywhere['setting']}, {times(everywhere['over_exact'])}"


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
    best = line.loc[line[column].idxmin()]
    finer = line[line["value"] < best["value"]][column]
    risen = finer.max() > AGAIN * best[column] if len(finer) else False
    again = f" and rises again to {scientific(float(finer.max()))} below" if risen else ""
    return f"{scientific(float(best[column]))} at p dt = {best['value']:g}{again}"
