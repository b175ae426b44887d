"""Rocks that fell on a shake table, or did not: who predicts it, and with how many numbers."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product
from pathlib import Path
from typing import cast

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from analytic.block import RigidBlock
from analytic.conditioning import scaled
from analytic.record import Record
from analytic.response import Outcome
from studies.cases.refusal import BadInputError
from studies.cases.rocks import MESHES, TABLE, read_mesh, read_motion, read_tests
from studies.kit.jobs import Job, Question, Row, answer, unanswered
from studies.kit.say import listed
from studies.kit.study import Figures, Tables

GRID = list(product((0.07, 0.09, 0.11, 0.13, 0.15, 0.18, 0.22), (0.25, 0.35, 0.5, 0.7)))
"""Slenderness [rad] and half diagonal [m] of blocks."""
FACTORS = [2.0 ** (0.5 * step) for step in range(-4, 5)]
"""Factors on a record, of which the margin is the least that overturns."""
LETTERS = {Outcome.OVERTURNED: "f", Outcome.FAILED: "?"}
FITTED = {1: (0.11, 0.35), 2: (0.13, 0.25)}
"""The best block of the grid for each rock, which engines and the search for margins are given."""
FOLDS, SEED, PARTS = 5, 0, np.linspace(0.0, 1.0, 61)
"""Parts of the tests; the seed that deals them; quantiles of PGA and PGV that are tried."""
EXACT, RULE, AUTHORS = "exact", "rule", "authors"
GAINS = {EXACT: "gain_exact", RULE: "gain_rule"}
MESH = ("mesh, weak side right", "mesh, weak side left", "mesh, weak side on both")
"""The blocks of a mesh, in their order: the data do not say which side faced where."""
BEST = "best fit"
LIFTS, BEFORE_S, AFTER_S = 0.8, 0.5, 5.0
"""For engines a record lasts from the first to the last time that so much of what lifts a block is
reached, and so long [s] before and after."""
SCORES = {"margin": -1.0, "pga_g": 1.0, "pgv_m_s": 1.0}  # with the sign of what falls


def jobs(sources: Sequence[str], folder: Path, most: int | None) -> list[Job]:
    """Return a job for each record and block, for each margin, and for engines in some tests."""
    tests = cast("list[Row]", read_tests(folder).to_dict("records"))
    asked, posed = [(0, "grid", block_of(*GRID[0]))], []
    for rock, mesh in MESHES.items():
        fitted, blocks = block_of(*FITTED[rock]), read_mesh(folder / mesh)
        asked += [(rock, *each) for each in zip(MESH, blocks, strict=True)]
        asked += [(rock, "margin", fitted)]
        posed += [(rock, BEST, fitted), (rock, MESH[0], blocks[0])]
    found, kept = [], []
    for test in tests:
        path = folder / TABLE / f"Test{test['test']:03d}.txt"
        if not path.is_file():
            continue  # the public folder lacks some
        motion = read_motion(path)
        kept.append((test, motion))
        for rock, name, block in asked:
            case = Question(system=block, motion=motion)
            labels = {**test, "rock": rock, "block": name}
            found.append(Job(labels=labels, case=case, source=EXACT))
    if not found:
        raise BadInputError(f"--rocks is {str(folder)!r}; it holds no record of a test")
    for place in np.random.default_rng(SEED).permutation(len(kept))[:most]:
        test, motion = kept[place]
        for rock, name, block in posed:
            case = Question(system=block, motion=lifting(motion, block))
            labels = {**test, "rock": rock, "block": name}
            found += [Job(labels=labels, case=case, source=it) for it in sources if it != EXACT]
    return found


def lifting(motion: Record, block: RigidBlock) -> Record:
    """Return the part of a record that may lift a block, or its strongest one, and what is near."""
    strength = np.abs(motion.samples)
    enough = min(LIFTS * block.gravity * math.tan(block.alpha), strength.max())
    first, last = np.flatnonzero(strength >= enough)[[0, -1]]
    start, end = first - round(BEFORE_S / motion.dt), last + round(AFTER_S / motion.dt)
    return Record(dt=motion.dt, samples=motion.samples[max(0, start) : end].copy())


def block_of(alpha: float, radius: float) -> RigidBlock:
    """Return a block by its slenderness [rad] and half diagonal [m]."""
    return RigidBlock(width=2.0 * radius * math.sin(alpha), height=2.0 * radius * math.cos(alpha))


def measure(job: Job) -> Row:
    """Return an answer; or of GRID a letter a block, f for a fall; or the margin of the block."""
    block, motion = job.case.system, job.case.motion
    if job.labels["block"] == "grid":
        found = [scaled(block_of(*sides), motion)(1.0, 1.0)[1] for sides in GRID]
        letters = "".join(LETTERS.get(outcome, "-") for outcome in found)
        return {**unanswered(""), "outcome": "found", "grid": letters}
    if job.labels["block"] == "margin":
        solve = scaled(block, motion)  # type: ignore[arg-type]  # it is a RigidBlock
        falls = (each for each in FACTORS if solve(each, 1.0)[1] is Outcome.OVERTURNED)
        return {**unanswered(""), "outcome": "found", "margin": next(falls, math.inf)}
    return answer(job)


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the tests of each rock with who predicts a fall, what is right, and areas of ROC."""
    from scipy.stats import mannwhitneyu

    # what is fitted predicts the fifth of the tests that its fit has not seen; nan is wrong
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
    tables, lines, areas, engines = {}, list[Row](), list[Row](), list[Row]()
    exacts, runs = (rows[(rows["source"] == EXACT) == it] for it in (True, False))
    for rock in MESHES:
        found = exacts[exacts["rock"] == rock].pivot(index="test", columns="block")
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
        for source in map(str, right):
            line = _shares(right, source, fell, RULE, AUTHORS)
            lines.append({"rock": rock, "source": source, **line})
        fitted = pd.Series(tried[EXACT][1][:, GRID.index(FITTED[rock])], tests.index)
        for block, mine in runs[runs["rock"] == rock].groupby("block"):
            exact = fitted if block == BEST else table[block]
            told = _against(
                mine, pd.DataFrame({EXACT: exact, RULE: every.iloc[:, 1], "fell": fell})
            )
            engines += [{"rock": rock, "block": block, **line} for line in told]
        pairs = (fell == 1).sum() * (fell == 0).sum()
        for name, sign in SCORES.items() if pairs else ():
            falls, stays = (sign * table.loc[fell == value, name] for value in (1, 0))
            area = mannwhitneyu(falls, stays).statistic / pairs
            areas.append({"rock": rock, "score": name, "area": area})
        tables[f"rock-{rock}"] = table.reset_index()
    if engines:
        outcomes = runs[["rock", "block", "test", "source", "outcome", "peak_ratio"]]
        tables |= {"engines": pd.DataFrame(engines), "outcomes": outcomes}
    return {**tables, "shares": pd.DataFrame(lines), "areas": pd.DataFrame(areas)}


def _against(runs: pd.DataFrame, fits: pd.DataFrame) -> list[Row]:
    """Return how much engines get right in their tests, and the exact block and a rule there."""
    told = runs.pivot(index="test", columns="source", values="falls").fillna(-1.0)
    told = fits.loc[told.index, [EXACT, RULE]].join(told)
    fell, lines = fits.loc[told.index, "fell"], []
    right = told.eq(fell, axis=0)
    for name in map(str, told):
        line = {"source": name, **_shares(right, name, fell.to_numpy(), EXACT, RULE)}
        line |= {gain: line["share"] - right[other].mean() for other, gain in GAINS.items()}
        differ, failed = (told[name] != told[EXACT]).sum(), (told[name] == -1.0).sum()
        lines.append({**line, "differ": differ, "no_result": failed})
    return lines


def _shares(right: pd.DataFrame, name: str, fell: NDArray[np.int64], *others: str) -> Row:
    """Return how much is right, within 95 % (Wilson), and McNemar's p against others."""
    from scipy.stats import binomtest

    mine = right[name]
    low, high = binomtest(int(mine.sum()), len(mine)).proportion_ci(method="wilson")
    line = {"tests": len(mine), "share": mine.mean(), "share_low": low, "share_high": high}
    line |= {"missed": (~mine & (fell == 1)).sum(), "alarms": (~mine & (fell == 0)).sum()}
    for other in others:
        only, apart = (mine & ~right[other]).sum(), (mine != right[other]).sum()
        line[f"p_{other}"] = binomtest(only, apart).pvalue if apart else 1.0
    return line


def finding(tables: Tables) -> str:
    """Say how often block, rule and authors are right, and whether that differs."""
    lines = tables["shares"].set_index(["source", "rock"])
    shares = (100.0 * lines["share"]).map("{:.1f}".format).unstack()
    block, rule, authors = map(listed, shares.loc[[EXACT, RULE, AUTHORS]].to_numpy())
    p = lines.loc[EXACT, ["p_rule", "p_authors"]].to_numpy().min()
    said = "no difference beyond chance" if p > 0.05 else "they differ"
    return (
        f"The exact block with two fitted numbers predicts {block} % of what two rocks did in "
        f"{lines['tests'].max()} tests, two thresholds of PGA and PGV {rule} %, and the authors' "
        f"model {authors} %: {said} (p {p:.2g}).{_of_engines(tables)}"
    )


def _of_engines(tables: Tables) -> str:
    """Say which engines predict better, and how many worse, than the exact block and the rule."""
    if "engines" not in tables:
        return ""
    lines = tables["engines"][tables["engines"]["block"] == BEST]
    lines = lines[~lines["source"].isin([EXACT, RULE])]
    chance = 0.05 / (2.0 * len(lines))  # of a wrong verdict (Bonferroni)
    exact, rule = (
        lines[gain].where(lines[f"p_{name}"] < chance, 0.0) for name, gain in GAINS.items()
    )
    better = sorted(set(lines.loc[(exact > 0.0) | (rule > 0.0), "source"]))
    return (
        f" Given the block that fits best, {listed(better) if better else 'no engine'} predicts "
        f"{lines['tests'].max()} tests better, beyond chance, than the exact block or two "
        f"thresholds; {lines.loc[exact < 0.0, 'source'].nunique()} of "
        f"{lines['source'].nunique()} engines and presets predict them worse than the exact block."
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
        "false alarms; McNemar's p against rule and authors. Exact and rule are told on tests that "
        "their fit has not seen; the authors' settings are their best on all": tables["shares"],
        "Area under the ROC curve: how well one number orders the tests; the margin is that of the "
        "block that fits all tests": tables["areas"],
        "Tests that block, rule and authors get wrong": lost_by_all(tables),
        **{
            f"Engines with the block {block!r} in {lines['tests'].max()} tests drawn at random, of "
            "each record the part that can lift it; in the same tests the exact block, of whole "
            "records, and a rule, fitted to all: part that is right, within 95 %; "
            "McNemar's p; outcomes other than the exact block's; runs without a result, which "
            "count as wrong. In the plane; with each preset's friction, as the rocks' is unknown": (
                lines.drop(columns=["block", "tests", "missed", "alarms", *GAINS.values()])
            )
            for block, lines in (tables["engines"].groupby("block") if "engines" in tables else ())
        },
    }


def figures(tables: Tables) -> Figures:
    """Draw what fell over PGA and PGV, and the ROC curves."""
    from studies.drawing.experiments import draw_rocks

    return {"rocks": draw_rocks(tables, SCORES, lost_by_all(tables))}
