"""Rocks that fell on a shake table, or did not: who predicts it, and with how many numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path

import numpy as np
import pandas as pd
from cyclopts import Parameter
from numpy.typing import NDArray
from scipy.stats import binomtest, mannwhitneyu

from analytic.response import Outcome
from studies.cases.refusal import BadInputError
from studies.cases.rocks import MESHES, TABLE, read_mesh, read_motion, read_tests
from studies.kit.jobs import Job, Question, Row
from studies.kit.say import listed
from studies.kit.study import Figures, Study, Tables
from studies.measures.margins import GRID, block_of, measure

FITTED = {1: (0.09, 0.5), 2: (0.15, 0.25)}
"""The best block of the grid for each rock, which engines and the search for margins are given."""
FOLDS, SEED, PARTS = 5, 0, np.linspace(0.0, 1.0, 61)
"""Parts of the tests; the seed that deals them; quantiles of PGA and PGV that are tried."""
EXACT, RULE, AUTHORS = "exact", "rule", "authors"
MESH = ("exact, both sides of the mesh", "exact, weak side of the mesh")
SCORES = {"margin": -1.0, "pga_g": 1.0, "pgv_m_s": 1.0}
"""Columns that order tests, and the sign with which a larger one falls."""


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
    for rock, mesh in MESHES.items():
        asked += [(rock, *each, EXACT) for each in zip(MESH, read_mesh(folder / mesh), strict=True)]
        asked += [(rock, "margin", FITTED[rock], EXACT)]
        asked += [(rock, name, FITTED[rock], name) for name in sources if name != EXACT]
    found = []
    for test in tests:
        path = folder / TABLE / f"Test{test['test']:03d}.txt"
        motion = read_motion(path) if path.is_file() else None
        for rock, name, sides, source in asked if motion else ():
            case = Question(system=block_of(*sides), motion=motion)
            found.append(
                Job(labels={**test, "rock": rock, "block": name}, case=case, source=source)
            )
    if not found:
        raise BadInputError(f"--rocks is {options.rocks!r}; it holds no record of a test")
    return found


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the tests of each rock with who predicts a fall; what is right; and areas under ROC.

    What is fitted predicts the fifth of the tests that its fit has not seen; fitted to all, it is
    listed besides. A source that fails predicts nan, which is wrong.
    """
    falls = (rows["outcome"] == Outcome.OVERTURNED.value).astype(float)
    rows = rows.assign(falls=falls.where(rows["outcome"] != Outcome.FAILED.value))
    tests = rows[rows["block"] == "grid"].set_index("test")
    letters = np.array([list(line) for line in tests["grid"]])
    strong = tests[["pga_g", "pgv_m_s"]]
    rules = np.array(list(product(*strong.quantile(PARTS).to_numpy().T)))
    tried = {
        EXACT: (np.array(GRID), np.where(letters == "?", math.nan, letters == "f")),
        RULE: (rules, np.all(strong.to_numpy()[:, None] > rules, axis=2).astype(float)),
    }
    folds = np.random.default_rng(SEED).permutation(len(tests)) % FOLDS
    tables, lines, areas = {}, list[Row](), list[Row]()
    for rock in MESHES:
        found = rows[rows["rock"] == rock].pivot(index="test", columns="block")
        fell = tests[f"fell_{rock}"].to_numpy()
        table = strong.assign(margin=found["margin", "margin"], fell=fell)
        every = pd.DataFrame(index=tests.index)
        for name, (numbers, predicted) in tried.items():
            right = predicted == fell[:, None]
            best, table[name] = right.sum(axis=0).argmax(), math.nan
            every[f"{name}, fitted to all: {numbers[best].round(3)}"] = predicted[:, best]
            for fold in range(FOLDS):
                best = right[folds != fold].sum(axis=0).argmax()
                table.loc[folds == fold, name] = predicted[folds == fold, best]
        table[AUTHORS] = tests[f"authors_{rock}"]
        table = table.join(found["falls"].drop(columns="margin"))
        right = table.iloc[:, 4:].join(every).eq(fell, axis=0)
        lines += [{"rock": rock, "source": name, **_shares(right, name, fell)} for name in right]
        for name, sign in SCORES.items():
            falls, stays = (sign * table.loc[fell == value, name] for value in (1, 0))
            pairs = len(falls) * len(stays) or math.nan
            won = mannwhitneyu(falls, stays).statistic if pairs > 0 else math.nan
            areas.append({"rock": rock, "score": name, "area": won / pairs})
        tables[f"rock-{rock}"] = table.reset_index()
    return {**tables, "shares": pd.DataFrame(lines), "areas": pd.DataFrame(areas)}


def _shares(right: pd.DataFrame, name: str, fell: NDArray[np.int64]) -> Row:
    """Return how much is right, within 95 % (Wilson), and McNemar's p against rule and authors."""
    mine = right[name]
    ends = binomtest(mine.sum(), len(mine)).proportion_ci(method="wilson")
    line = {
        "tests": len(mine),
        "share": mine.mean(),
        "share_low": ends.low,
        "share_high": ends.high,
    }
    line |= {"missed": int((~mine & (fell == 1)).sum()), "alarms": int((~mine & (fell == 0)).sum())}
    for other in (RULE, AUTHORS):
        only, apart = (mine & ~right[other]).sum(), (mine != right[other]).sum()
        line[f"p_{other}"] = binomtest(only, apart).pvalue if apart else 1.0
    return line


def finding(tables: Tables) -> str:
    """Say how often the exact block is right, beside the rule and the authors, and the best."""
    lines = tables["shares"].set_index(["source", "rock"])
    block, rule, authors = (
        listed(100.0 * lines.loc[name, "share"].round(3)) for name in (EXACT, RULE, AUTHORS)
    )
    p = lines.loc[EXACT, ["p_rule", "p_authors"]].to_numpy().min()
    words = f"it cannot be told from these (least p {p:.2g})" if p > 0.05 else f"least p {p:.2g}"
    return (
        f"In {lines['tests'].max()} tests the exact block, of which two numbers are fitted, "
        f"predicts what two rocks do in {block} %; two thresholds of PGA and PGV do so in {rule} "
        f"% and the authors' model in {authors} %: {words}. All three miss "
        f"{len(lost_by_all(tables))} outcomes."
    )


def lost_by_all(tables: Tables) -> pd.DataFrame:
    """Return the tests that block, rule and authors all get wrong."""
    lines = pd.concat([tables[f"rock-{rock}"].assign(rock=rock) for rock in MESHES])
    wrong = lines[[EXACT, RULE, AUTHORS]].ne(lines["fell"], axis=0).all(axis=1)
    return lines.loc[wrong, ["rock", "test", *SCORES, "fell"]]


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

    rocks = {rock: tables[f"rock-{rock}"] for rock in MESHES}
    return {"rocks": draw_rocks(rocks, SCORES, lost_by_all(tables))}


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
        "rocks": "What fell and what stood, over PGA and PGV, with the tests that all get wrong; "
        "and how well the margin, PGA and PGV tell one from the other (ROC curves)."
    },
)
command = STUDY.command()
