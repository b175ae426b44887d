"""The paper's cases as one batch of worlds: cases a second at an error, and does it repeat?"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import product
from typing import Any, Literal

import numpy as np
import pandas as pd

from engines.world import FloatArray
from studies.cases.refusal import BadInputError
from studies.kit.jobs import Job, Question, Row
from studies.kit.say import listed, part, say
from studies.kit.study import Figures, Study, Tables, stages
from studies.kit.tables import unpacked
from studies.measures import batches
from studies.measures.batches import BATCHED, EVERY, EXACT, NAMES, PAPER, RANDOM, C
from studies.measures.wrongness import KINDS, kinds_of

TARGETS = (0.1, 0.01, 0.001)
"""Median errors at which cases a second are compared."""
FEW, ALL = 64, EVERY[PAPER]
WORLDS = (8192, 1, FEW, 1024, 32_768)
"""Worlds on a GPU: of each preset and step, then of the first alone."""
USUAL = (("tuned, impratio 100", 1.0), ("default", 2.0), ("recommended", 1.0), ("tuned", 1.0))
STEPS_MS = (2.0, 1.0, 0.5, 0.25)
RATIO = "tuned, impratio "
RATIOS = tuple((f"{RATIO}{each}", 2.0) for each in (100, 200, 300, 500, 1000, 2000, 10_000))
"""Presets from one that works in float32 to one that does not, the tuned one; their step."""
RUNS = 20
SAME = ["backend", "device", "case_set", "preset", "dt_ms", "worlds", "runs"]


@dataclass(frozen=True, kw_only=True)
class Options:
    """Where MuJoCo Warp and MJX run."""

    device: Literal["cpu", "cuda"] | None = None
    """cpu or cuda, where MuJoCo Warp and MJX run; by default they are left out."""


def jobs(_: Sequence[str], quick: bool, options: Options) -> list[Job]:
    """Return a job for each batch: of the exact solution, of MuJoCo's C, of Warp and of MJX."""
    device = options.device
    ways = [way for way, (module, _) in BATCHED.items() if device and find_spec(module)]
    if device and not ways:
        raise BadInputError(f"--device is {device}; it needs rocking[warp] or rocking[mjx]")
    for way in set(BATCHED).difference(ways) if device else ():
        say(f"{NAMES[way]} is left out: install rocking[{BATCHED[way][1]}]")
    pairs = [(C, "cpu"), *((way, str(device)) for way in ways)]
    rows = [(EXACT, "cpu", PAPER, "", 0.0, ALL, 1)]
    rows += [(*pair, *row) for pair in pairs for row in _batches(*pair, quick)]
    first = batches.all_cases()[0]
    case = Question(system=first.block, motion=first.motion)
    sources = [f"mujoco:{row[3].partition(',')[0]}" if row[3] else EXACT for row in rows]
    return [Job(labels=dict(zip(SAME, row, strict=True)), case=case, source=source)
            for row, source in zip(rows, sources, strict=True)]  # fmt: skip


def _batches(way: str, device: str, quick: bool) -> Iterator[tuple[str, str, float, int, int]]:
    """Yield the batches of a way to step: cases, preset, step [ms], worlds and runs."""
    few = quick or (device == "cpu" and way != C)
    most, *others = (FEW,) if few else (ALL,) if way == C else WORLDS
    steps = USUAL if few else tuple(product(dict(USUAL), STEPS_MS))
    yield from ((PAPER, *each, most, 1) for each in steps)
    ratios, random = (RATIOS[1:], USUAL) if way == C else (RATIOS, USUAL[::2])
    if way != C:
        yield from ((PAPER, *USUAL[0], worlds, 1) for worlds in others)
        yield PAPER, *USUAL[0], min(most, ALL), 2 if quick else RUNS
    if not quick:
        yield from ((PAPER, *each, FEW, 1) for each in ratios)
        yield from ((RANDOM, *each, EVERY[RANDOM], 1) for each in random)


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return errors and rates of each batch, the best rates at an error, and what differs."""
    rows = rows.reindex(
        columns=[*dict.fromkeys([*rows.columns, *batches.MEASURED, *batches.SPREAD])]
    )
    plain: dict[Any, FloatArray] = {}
    for row in rows[(rows["backend"] == C) & rows["wall_s"].notna()].to_dict("records"):
        every, of = EVERY[row["case_set"]], (row["case_set"], row["preset"], row["dt_ms"])
        peaks = plain.setdefault(of, np.full(every, math.nan))
        peaks[batches.numbers_of(row["worlds"], every)] = unpacked(row["peaks"])
    lines = []
    for row in rows.to_dict("records"):
        line = {str(name): row[name] for name in (*SAME, "message", *batches.MEASURED)}
        if not row["message"]:
            cases, every = row["case_set"], EVERY[row["case_set"]]
            numbers = batches.numbers_of(min(row["worlds"], every), every)
            mine, other = unpacked(row["peaks"]), plain.get((cases, row["preset"], row["dt_ms"]))
            line |= _off(mine, batches.exact_peaks(cases)[numbers], "")
            line |= {} if other is None else _off(mine, other[numbers], "c_")
        lines.append(line)
    batch = pd.DataFrame(lines)
    # what lacks answers is fast without them
    fast = batch[(batch["case_set"] == PAPER) & ~(batch["no_answer"] > 0)]
    fast = fast.sort_values("cases_per_s", ascending=False)
    kept = [fast[fast["median_error"] <= target].assign(target=target) for target in TARGETS]
    best = pd.concat(kept).drop_duplicates(["backend", "device", "worlds", "target"])
    several = rows[(rows["worlds"] > rows["case_set"].map(EVERY)) | (rows["runs"] > 1)]
    rates = best[[*SAME[:2], *SAME[3:6], "target", "cases_per_s", "median_error"]]
    return {"batch": batch, "rates": rates, "spread": several[[*SAME, *batches.SPREAD]]}


def _off(mine: FloatArray, right: FloatArray, whose: str) -> Row:
    """Return how many outcomes are wrong, and errors where both rock."""
    told = ~np.isnan(right)
    words = [np.select([np.isnan(peaks), np.isinf(peaks)], ["failed", "overturned"], "rocked")
             for peaks in (mine, right)]  # fmt: skip
    kinds = kinds_of(words[0][told], mine[told], words[1][told], right[told])
    both = np.isfinite(mine) & np.isfinite(right) & (right > 0.0)
    sizes = pd.Series(np.abs(mine[both] / right[both] - 1.0)).quantile([0.5, 0.9, 1.0])
    found: Row = {kind: int((kinds == kind).sum()) for kind in KINDS}
    found |= dict(zip(("median_error", "p90_error", "max_error"), sizes, strict=True))
    return {f"{whose}{name}": value for name, value in found.items()}


def finding(tables: Tables) -> str:
    """Say which rates are reached, what repeats, what random cases give, and what is lost."""
    batch, best = tables["batch"], tables["rates"].query("target == 0.01")
    best = best.sort_values("cases_per_s").drop_duplicates(["backend", "device"], keep="last")
    on = batch.groupby("device")["name"].first()
    repeated = tables["spread"].query("runs > 1")
    drawn = batch.query("case_set == @RANDOM and preset == 'recommended'")
    said = {
        f"Cases per second at a median error below 1 %, {on[device]}": [
            f"{NAMES[it['backend']]} {it['cases_per_s']:,.0f}" for it in lines.to_dict("records")
        ]
        for device, lines in best.groupby("device")
    }
    said |= {
        f"Worlds that differ by a bit in {repeated['runs'].max()} equal runs": [
            f"{NAMES[it['backend']]} {it['bits_differ']:.0f} of {it['worlds']}"
            for it in repeated.to_dict("records")
        ],
        f"Wrong outcomes in {EVERY[RANDOM]} random cases and the median error, recommended": [
            f"{NAMES[it['backend']]} {sum(it[kind] for kind in KINDS):.0f} and "
            f"{part(it['median_error'])}"
            for it in drawn.to_dict("records")
        ],
    }
    sentences = [f"{head}: {'; '.join(items)}." for head, items in said.items() if items]
    asked = batch["preset"].isin(dict(RATIOS[1:])).any()
    return " ".join([*sentences, _answered(batch)] if asked else sentences)


def _answered(batch: pd.DataFrame) -> str:
    """Say up to which impratio each way to step has an answer for every case."""
    mine = batch.merge(pd.DataFrame(RATIOS, columns=["preset", "dt_ms"]))
    mine = mine.assign(ratio=mine["preset"].str.removeprefix(RATIO).astype(int))
    lost = mine[(mine["no_answer"] > 0) | (mine["message"] != "")].groupby("backend")["ratio"].min()
    most = {
        str(way): lines.loc[lines["ratio"] < lost.get(way, math.inf), "ratio"].max()
        for way, lines in mine.groupby("backend", sort=False)
    }
    ends = [f"{ratio:,.0f} in {NAMES[way]}" for way, ratio in most.items()]
    said = "With tuned contact at 2 ms each case has an answer up to an impratio of"
    return f"{said} {listed(ends)}, of those asked from 100 to 10,000."


def shown(tables: Tables) -> Tables:
    """Return the tables in short."""
    columns = [*SAME, "no_answer", "cases_per_s", "median_error", "c_median_error", *KINDS[:2]]
    return {
        "Errors and rates": tables["batch"].reindex(columns=columns),
        "Most cases a second at a median error": tables["rates"],
        "Worlds of one case that differ from its first": tables["spread"],
    }


def figures(tables: Tables) -> Figures:
    """Draw the error against the rate; of other impratios the table says all."""
    from studies.drawing.precision import draw_batch

    lines = tables["batch"].query("case_set == @PAPER and runs == 1 and no_answer == 0")
    return {"batch": draw_batch(lines[~lines["preset"].isin(dict(RATIOS[1:]))])}


STUDY = Study(
    name="batch",
    question="How many cases a second does a batch of worlds give, at which error?",
    help="""The paper's 960 cases as worlds of MuJoCo Warp and MJX; MuJoCo in C beside them.

All take equal steps on a base at rest; also 500 random cases, 20 equal runs, and other values of
impratio. On an H100, 1024 worlds of an earlier MJX at 1 ms did not end within 160 s. Ten minutes
without --device; an hour more with it on a CPU.""",
    options=Options,
    quick="64 cases, and one step of each preset.",
    captions={
        "batch": "A line for each preset and way to step, from coarse steps to fine; hollow: other"
        " numbers of worlds. Batches in which a world has no answer are left out."
    },
    alone=True,
    **stages(jobs, batches.measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
