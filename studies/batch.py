"""The paper's cases as one batch of worlds: cases a second at an error, and does it repeat?"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import product
from typing import Any, Literal

import numpy as np
import pandas as pd

from engines.world import FloatArray
from studies.cases.refusal import BadInputError
from studies.kit.jobs import Job, Question, Row
from studies.kit.say import listed, say
from studies.kit.study import Figures, Study, Tables, stages
from studies.kit.tables import unpacked
from studies.measures import batches
from studies.measures.batches import EVERY, EXACT, MEASURED, MJX, MJX32, NAMES, SPREAD, WARP, C
from studies.measures.wrongness import KINDS, kinds_of

TARGETS = (0.1, 0.01, 0.001)
"""Median errors at which cases a second are compared."""
WORLDS = {"cpu": (64,), "cuda": (8192, 1, 64, 1024, 32768)}
"""Device -> worlds: at every preset and step, then at the first."""
USUAL = (("tuned, impratio 100", 1.0), ("default", 2.0), ("recommended", 1.0), ("tuned", 1.0))
STEPS_MS = (2.0, 1.0, 0.5, 0.25)
RATIO = "tuned, impratio "
RATIOS = tuple(f"{RATIO}{ratio}" for ratio in (100, 200, 300, 500, 1000, 2000, 10_000))
"""Presets from one that works in float32 to one that does not: the tuned one."""
RUNS = 20
BATCHED = {WARP: ("mujoco_warp", "warp"), **dict.fromkeys((MJX, MJX32), ("mujoco.mjx", "mjx"))}
"""What steps a batch -> its module, and the extra that installs it."""
SAME = ["backend", "device", "preset", "dt_ms", "worlds", "runs"]


@dataclass(frozen=True, kw_only=True)
class Options:
    """Where MuJoCo Warp and MJX run."""

    device: Literal["cpu", "cuda"] | None = None
    """cpu or cuda, where MuJoCo Warp and MJX run; by default they are left out."""
    impratio: bool = False
    """Ask instead up to which impratio tuned contact has an answer: 64 cases at steps of 2 ms."""


def jobs(_: Sequence[str], quick: bool, options: Options) -> list[Job]:
    """Return a job for each batch: of the exact solution, of MuJoCo's C, of Warp and of MJX."""
    device = options.device
    ways = [way for way, (module, _) in BATCHED.items() if device and find_spec(module)]
    if device and not ways:
        raise BadInputError(f"--device is {device}; it needs rocking[warp] or rocking[mjx]")
    for way in set(BATCHED).difference(ways) if device else ():
        say(f"{NAMES[way]} is left out: install rocking[{BATCHED[way][1]}]")
    asked, few = USUAL if quick else tuple(product(dict(USUAL), STEPS_MS)), quick
    if options.impratio:
        asked, few = tuple(product(RATIOS, STEPS_MS[:1])), True
    rows: list[tuple[Any, ...]] = [(EXACT, "cpu", "", 0.0, EVERY, 1)]
    rows += [(C, "cpu", *each, 64 if few else EVERY, 1) for each in asked]
    for way in ways:
        most, *others = (64,) if few else WORLDS[str(device)]
        rows += [(way, device, *each, most, 1) for each in asked]
        rows += [(way, device, *USUAL[0], worlds, 1) for worlds in others]
        if not options.impratio:
            rows.append((way, device, *USUAL[0], *((64, 2) if quick else (EVERY, RUNS))))
    first = batches.all_cases()[0]
    case = Question(system=first.block, motion=first.motion)
    sources = [f"mujoco:{row[2].partition(',')[0]}" if row[2] else EXACT for row in rows]
    return [Job(labels=dict(zip(SAME, row, strict=True)), case=case, source=source)
            for row, source in zip(rows, sources, strict=True)]  # fmt: skip


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return errors and rates of each batch, the best rates at an error, and what differs."""
    rows = rows.reindex(columns=[*dict.fromkeys([*rows.columns, *MEASURED, *SPREAD])])
    plain = {}
    for row in rows[(rows["backend"] == C) & rows["wall_s"].notna()].to_dict("records"):
        peaks = plain[row["preset"], row["dt_ms"]] = np.full(EVERY, math.nan)
        peaks[batches.numbers_of(row["worlds"])] = unpacked(row["peaks"])
    lines = []
    for row in rows.to_dict("records"):
        line = {str(name): row[name] for name in (*SAME, "message", *MEASURED)}
        if not row["message"]:
            numbers = batches.numbers_of(min(row["worlds"], EVERY))
            mine, other = unpacked(row["peaks"]), plain.get((row["preset"], row["dt_ms"]))
            line |= _off(mine, batches.exact_peaks()[numbers], "")
            line |= {} if other is None else _off(mine, other[numbers], "c_")
        lines.append(line)
    batch = pd.DataFrame(lines)
    # what lacks answers is fast without them
    fast = batch[~(batch["no_answer"] > 0)].sort_values("cases_per_s", ascending=False)
    kept = [fast[fast["median_error"] <= target].assign(target=target) for target in TARGETS]
    best = pd.concat(kept).drop_duplicates(["backend", "device", "worlds", "target"])
    several = rows[(rows["worlds"] * rows["runs"] > EVERY) | (rows["runs"] > 1)]
    rates = best[[*SAME[:4], "worlds", "target", "cases_per_s", "median_error"]]
    spread = {"spread": several[[*SAME, *SPREAD]]} if len(several) else {}
    return {"batch": batch, "rates": rates, **spread}


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
    """Say how many cases each way gives at a median error of 1 %, and what repeats or is lost."""
    if tables["batch"]["preset"].isin(RATIOS[1:]).any():
        return _answered(tables["batch"])
    best = tables["rates"].query("target == 0.01").sort_values("cases_per_s")
    best = best.drop_duplicates("backend", keep="last")
    devices = tables["batch"].groupby("device")["name"].first()
    rates = "; ".join(
        f"{NAMES[line['backend']]} {line['cases_per_s']:,.0f} on {devices[line['device']]}"
        for line in best.to_dict("records")
    )
    said = f"Cases per second at a median error below 1 %: {rates}."
    repeated = tables["spread"].query("runs > 1") if "spread" in tables else pd.DataFrame()
    for line in repeated.to_dict("records"):
        said += f" In {line['runs']} equal runs {line['bits_differ']:.0f} of {line['worlds']}"
        said += " worlds differ by a bit."
    return said


def _answered(batch: pd.DataFrame) -> str:
    """Say up to which impratio each way to step has an answer for every case."""
    mine = batch[batch["preset"].isin(RATIOS)]
    mine = mine.assign(ratio=mine["preset"].str.removeprefix(RATIO).astype(int))
    lost = mine[(mine["no_answer"] > 0) | (mine["message"] != "")].groupby("backend")["ratio"].min()
    most = {
        str(way): lines.loc[lines["ratio"] < lost.get(way, math.inf), "ratio"].max()
        for way, lines in mine.groupby("backend", sort=False)
    }
    ends = [f"{ratio:,.0f} in {NAMES[way]}" for way, ratio in most.items()]
    return (
        f"With tuned contact at 2 ms each of {mine['worlds'].max()} cases has an answer up to an "
        f"impratio of {listed(ends)}, of those asked from 100 to 10,000."
    )


def shown(tables: Tables) -> Tables:
    """Return the tables in short."""
    columns = [*SAME, "no_answer", "cases_per_s", "median_error", "c_median_error", *KINDS[:2]]
    found = {
        "Errors and rates": tables["batch"].reindex(columns=columns),
        "Most cases a second at a median error": tables["rates"],
    }
    if "spread" in tables:
        found["Worlds of one case that differ from its first"] = tables["spread"]
    return found


def figures(tables: Tables) -> Figures:
    """Draw the error against the rate; of impratio the table says all."""
    from studies.drawing.precision import draw_batch

    asked = tables["batch"]["preset"].isin(RATIOS[1:]).any()
    return {} if asked else {"batch": draw_batch(tables["batch"])}


STUDY = Study(
    name="batch",
    question="How many cases a second does a batch of worlds give, at which error?",
    help="""The paper's 960 cases as worlds of MuJoCo Warp and MJX; MuJoCo in C beside them.

All take equal steps on a base at rest. On an H100, 1024 worlds of an earlier MJX at 1 ms did not
end within 160 s. Ten minutes without --device; hours with it on a CPU.""",
    options=Options,
    quick="64 cases, and one step of each preset.",
    captions={
        "batch": "A line for each preset and way to step, from coarse steps to fine; hollow: other"
        " numbers of worlds."
    },
    alone=True,
    **stages(jobs, batches.measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
