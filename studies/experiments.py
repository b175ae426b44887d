"""Rocks that fell on a shake table, or did not: who predicts it, and with how many numbers."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pandas as pd
from cyclopts import Parameter
from numpy.typing import NDArray
from scipy.stats import binomtest, rankdata

from analytic.response import Outcome
from studies.cases.refusal import BadInputError
from studies.cases.rocks import MESHES, read_mesh, read_motion, read_tests
from studies.kit.jobs import Job, Question, Row
from studies.kit.study import Figures, Study, Tables
from studies.measures.margins import GRID, block_of, measure

FITTED = {1: (0.09, 0.5), 2: (0.15, 0.25)}
"""The best block of the grid for each rock, which engines and the search for margins are given."""
FOLDS, SEED = 5, 0
EXACT, RULE, AUTHORS = "exact", "rule", "authors"
MESH = ("exact, both sides of the mesh", "exact, weak side of the mesh")
SCORES = {"margin": -1.0, "pga_g": 1.0, "pgv_m_s": 1.0}
"""Columns that order tests, and the sign with which a larger one falls."""

Bits = NDArray[np.bool_]


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Options:
    """Which measurements.

    Attributes
    ----------
    rocks
        Folder of the shake-table tests: a clone of ZhiangChen/virtual_shake_robot_pybullet.
    """

    rocks: str | None = None


def jobs(sources: Sequence[str], _: bool, options: Options) -> list[Job]:
    """Return a job for each record and block, for each margin, and for each engine's block."""
    if options.rocks is None:
        words = "it must be a clone of ZhiangChen/virtual_shake_robot_pybullet"
        raise BadInputError(f"--rocks is missing; {words}")
    folder = Path(options.rocks)
    tests = read_tests(folder).to_dict("records")
    asked = [(0, "grid", GRID[0], EXACT)]
    for rock in MESHES:
        meshes = zip(MESH, read_mesh(folder, rock), strict=True)
        asked += [(rock, name, sides, EXACT) for name, sides in meshes]
        asked += [(rock, "margin", FITTED[rock], EXACT)]
        asked += [(rock, name, FITTED[rock], name) for name in sources if name != EXACT]
    found = []
    for test in tests:
        motion = read_motion(folder, test["test"])
        for rock, name, sides, source in asked if motion else ():
            case = Question(system=block_of(*sides), motion=motion)
            labels = {**test, "rock": rock, "block": name}
            found.append(Job(labels=labels, case=case, source=source))
    if not found:
        raise BadInputError(f"--rocks is {options.rocks!r}; it holds no record of a test")
    return found


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the tests of each rock with who predicts a fall; what is right; and areas under ROC.

    A source that fails predicts nan, which is wrong.
    """
    falls = (rows["outcome"] == Outcome.OVERTURNED.value).astype(float)
    falls = falls.where(rows["outcome"] != Outcome.FAILED.value)
    rows = rows.assign(falls=falls)
    tests = rows[rows["block"] == "grid"].set_index("test")
    letters = np.array([list(line) for line in tests["grid"]])
    grid = np.where(letters == "?", np.nan, letters == "f")
    tables, lines, areas = {}, list[Row](), list[Row]()
    for rock in MESHES:
        mine = rows[rows["rock"] == rock]
        margins = mine[mine["block"] == "margin"].set_index("test")["margin"]
        table = tests[["pga_g", "pgv_m_s"]].assign(margin=margins, fell=tests[f"fell_{rock}"])
        fell = table["fell"].to_numpy() == 1
        choices = {EXACT: _best_block(grid, fell), RULE: _best_rule(table, fell)}
        folds = np.random.default_rng(SEED).permutation(len(fell)) % FOLDS
        for name, choose in choices.items():
            table[name] = held_out(choose, folds)
        table[AUTHORS] = tests[f"authors_{rock}"]
        others = mine[mine["block"] != "margin"]
        table = table.join(others.pivot(index="test", columns="block", values="falls"))
        right = table[table.columns[4:]].eq(table["fell"], axis=0)
        for name, choose in choices.items():
            every, words = choose(np.ones(len(fell), dtype=bool))
            lines.append(_line(rock, f"{name}, fitted", every == fell, fell, right, words))
        lines += [_line(rock, name, right[name].to_numpy(), fell, right) for name in right]
        tables[f"rock-{rock}"] = table.reset_index()
        areas += [
            {"rock": rock, "score": name, "area": area(sign * table[name], fell)}
            for name, sign in SCORES.items()
        ]
    return {**tables, "shares": pd.DataFrame(lines), "areas": pd.DataFrame(areas)}


Choice = Callable[[Bits], tuple[NDArray[np.float64], str]]
"""Fits to some of the tests, and returns what all should do, and its numbers in words."""


def _best_block(falls: NDArray[np.float64], fell: Bits) -> Choice:
    def choose(known: Bits) -> tuple[NDArray[np.float64], str]:
        best = int((falls[known] == fell[known, None]).sum(axis=0).argmax())
        return falls[:, best], "alpha {:g} rad, R {:g} m".format(*GRID[best])

    return choose


def _best_rule(table: pd.DataFrame, fell: Bits) -> Choice:
    pga, pgv = table["pga_g"].to_numpy(), table["pgv_m_s"].to_numpy()

    def choose(known: Bits) -> tuple[NDArray[np.float64], str]:
        a, v = np.unique(pga[known]), np.unique(pgv[known])
        gain = np.where(fell[known], 1.0, -1.0)[:, None] * (pga[known, None] > a)
        place = np.unravel_index((gain.T @ (pgv[known, None] > v)).argmax(), (len(a), len(v)))
        least_a, least_v = a[place[0]], v[place[1]]
        words = f"PGA > {least_a:.3g} g, PGV > {least_v:.3g} m/s"
        return ((pga > least_a) & (pgv > least_v)).astype(float), words

    return choose


def held_out(choose: Choice, folds: NDArray[np.int64]) -> NDArray[np.float64]:
    """Return for each test what is predicted by a fit to the folds that it is not in."""
    found = np.empty(len(folds))
    for fold in range(FOLDS):
        found[folds == fold] = choose(folds != fold)[0][folds == fold]
    return found


def _line(
    rock: int, source: str, right: Bits, fell: Bits, others: pd.DataFrame, fit: str = ""
) -> Row:
    """Return how much is right, within 95 % (Wilson), and McNemar's p against rule and authors."""
    count, total = int(right.sum()), len(right)
    ends = binomtest(count, total).proportion_ci(method="wilson")
    line = {"rock": rock, "source": source, "fit": fit, "tests": total, "right": count}
    line |= {"share": count / total, "share_low": ends.low, "share_high": ends.high}
    line |= {"missed": int((~right & fell).sum()), "alarms": int((~right & ~fell).sum())}
    return line | {f"p_{name}": mcnemar(right, others[name]) for name in (RULE, AUTHORS)}


def mcnemar(one: Bits, other: pd.Series[bool]) -> float:
    """Return the probability of a difference as large between two that are equally often right."""
    first, second = int((one & ~other).sum()), int((~one & other).sum())
    return float(binomtest(first, first + second).pvalue) if first + second else 1.0


def area(score: pd.Series[float], fell: Bits) -> float:
    """Return the probability that of two tests the one that fell has the larger score."""
    ones, ranks = int(fell.sum()), rankdata(score)
    pairs = ones * (len(fell) - ones)
    return float((ranks[fell].sum() - 0.5 * ones * (ones + 1)) / pairs) if pairs else math.nan


def finding(tables: Tables) -> str:
    """Say how often the exact block is right, beside the rule and the authors, and the best."""
    shares = tables["shares"].set_index(["source", "rock"])["share"].unstack()
    tests, few = tables["shares"]["tests"].max(), shares.loc[[EXACT, RULE, AUTHORS]]
    both = [" and ".join(f"{100.0 * share:.1f}" for share in few.loc[name]) for name in few.index]
    least = tables["shares"].query("source == @EXACT")[["p_rule", "p_authors"]].min().min()
    words = "no difference that these tests can tell" if least > 0.05 else f"least p {least:.2g}"
    return (
        f"A block with two fitted numbers predicts {both[0]} % of what two rocks do in {tests} "
        f"tests, two thresholds of PGA and PGV {both[1]} %, and the authors' model {both[2]} %: "
        f"{words}.\n\nIn {len(lost_by_all(tables))} tests all three are wrong."
    )


def rocks_of(tables: Tables) -> dict[int, pd.DataFrame]:
    """Return the tests of each rock."""
    return {rock: tables[f"rock-{rock}"] for rock in MESHES}


def lost_by_all(tables: Tables) -> pd.DataFrame:
    """Return the tests that block, rule and authors all get wrong."""
    lines = pd.concat([table.assign(rock=rock) for rock, table in rocks_of(tables).items()])
    wrong = lines[[EXACT, RULE, AUTHORS]].ne(lines["fell"], axis=0).all(axis=1)
    return lines.loc[wrong, ["rock", "test", "pga_g", "pgv_m_s", "margin", "fell"]]


def shown(tables: Tables) -> Tables:
    """Return the shares, the areas, and the tests that everyone gets wrong."""
    return {
        "Part of the tests that is right, of each rock, within 95 %; falls that are missed and "
        "false alarms; McNemar's p against rule and authors": tables["shares"],
        "Area under the ROC curve: how well one number orders the tests": tables["areas"],
        "Tests that block, rule and authors get wrong": lost_by_all(tables),
    }


def figures(tables: Tables) -> Figures:
    """Draw what fell over PGA and PGV, and the ROC curves."""
    from studies.drawing.rocks import draw_rocks

    return {"rocks": draw_rocks(rocks_of(tables), SCORES, lost_by_all(tables))}


STUDY = Study(
    name="experiments",
    question="Which rocks fall on a shake table, and who predicts it?",
    help="""Two granite rocks under recorded motions of a shake table, against what they did.

The exact block with its slenderness and size fitted, and from the meshes; the rule that PGA and PGV
exceed two thresholds; the authors' model; engines that are asked, with the fitted block. What is
fitted is told on the fifth of the tests that it has not seen. Ten minutes without engines. Writes
rock-1.csv and rock-2.csv, shares.csv, areas.csv, findings.txt and a picture.""",
    sources=(EXACT,),
    options=Options,
    jobs=jobs,
    measure=measure,
    tabulate=tabulate,
    finding=finding,
    shown=shown,
    figures=figures,
    captions={
        "rocks": "What fell and what stood over PGA and PGV of a test, the tests that all three get "
        "wrong marked, and how well the margin, PGA and PGV tell one from the other (ROC curve).",
    },
)
command = STUDY.command()
