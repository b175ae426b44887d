"""Random cases at the published steps: which of these keep an error on them, too."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict
from itertools import islice
from pathlib import Path

import pandas as pd

from engines import ENGINES, installed_engines
from studies.advise import STEPS
from studies.advise.choice import TARGETS
from studies.advise.evidence import SETTING, counted, judged, options_at, settings
from studies.cases.drawn import RandomCase, draw
from studies.drawing.kept import tell
from studies.old.arguments import BadInputError, Count, Out, Positive
from studies.old.jobs import Job
from studies.old.naming import CORE, Engines
from studies.old.options import CASE_BYTES, DEFAULT_RUNNING, Running, refuse_excess
from studies.old.plan import Plan, carry_out
from studies.old.tables import table_in
from studies.measures.differences import WELL_CONDITIONED
from studies.measures.finer import with_every_finer
from studies.measures.published import PUBLISHED
from studies.measures.words import per_cent

LEAST = 50
"""Random cases at every setting, however long they take, where so many are asked for."""


def command(
    *,
    out: Out,
    engines: Engines = CORE,
    cases: Count = 500,
    share: Positive = 20.0,
    seed: Count = 1,
    running: Running = DEFAULT_RUNNING,
) -> int:
    """Run random cases at the published steps that keep an error on the published cases.

    Parameters
    ----------
    engines
        Names of engines, without a preset.
    cases
        Number of random cases at a setting, at most.
    share
        Time [s] for a setting, by the published time of a case: where all cases would take longer
        there are fewer, but 50.
    seed
        Seed of the random numbers, a positive whole number; another one draws other cases.
    """
    if absent := [name for name in engines if name not in installed_engines()]:
        raise BadInputError(f"--engines is {absent[0]!r}; it must be installed here")
    refuse_excess(f"--cases is {cases}", cases * CASE_BYTES)
    return carry_out(STEPS, plan(engines, cases, share, seed), out, running, report)


def plan(engines: Sequence[str], cases: int, share_s: float, seed: int) -> Plan:
    """Return the plan that puts the first random cases to each setting worth it."""
    drawn = list(islice(draw(seed), cases))
    tried = worth_trying(settings(PUBLISHED, engines))
    return Plan(
        jobs=[
            job(str(line["engine"]), str(line["preset"]), float(line["value"]), case)
            for _, line in tried.iterrows()
            for case in drawn[: max(LEAST, int(share_s / line["wall_s"]))]
        ],
        settings={"seed": seed},
        growing={"engine": engines, "case": range(cases)},
        tabulate=lambda rows: {"random": judged(rows)},
    )


def worth_trying(known: pd.DataFrame) -> pd.DataFrame:
    """Return the settings that keep the largest of the errors with every finer one."""
    keeps = known["max_error"] <= max(TARGETS)
    return known[with_every_finer(keeps, known["engine"], known["preset"])]


def job(engine: str, preset: str, value: float, case: RandomCase) -> Job:
    """Return the question of a random case to a preset at a setting."""
    labels = {"engine": engine, "preset": preset, "value": value}
    return Job(
        labels={**labels, **asdict(case)},
        block=case.block,
        motion=case.motion,
        source=f"{engine}:{preset}",
        options=options_at(ENGINES[engine].preset(preset), value),
    )


def report(folder: Path) -> str:
    """Write and return how many random cases are off at the settings of each preset."""
    table, small = table_in(folder, "random"), f"κ < {WELL_CONDITIONED:g}"
    known = counts(table, max(TARGETS))
    tables = {
        "Random cases that are off by more than an error, at all settings of a preset": (
            off(table, "random_off")
        ),
        f"Those among them with {small}": off(table, "random_calm_off"),
        f"Settings at which a case with {small} is off by more than {per_cent(max(TARGETS))}": (
            known[known["random_calm_off"] > 0]
        ),
    }
    return tell(STEPS, folder, tables)


def counts(table: pd.DataFrame, target: float) -> pd.DataFrame:
    """Return the settings of a table of random cases, with how many are off an error."""
    return counted(table[SETTING].drop_duplicates(), table, target)


def off(table: pd.DataFrame, name: str) -> pd.DataFrame:
    """Return a column of `counts` at all settings of each preset, a column for each error."""
    found = [counts(table, target).assign(target=f"{target:g}") for target in TARGETS]
    uses = ["engine", "preset", "random_cases"]
    by_use = pd.concat(found).groupby([*uses[:2], "target"], sort=False)[[uses[2], name]].sum()
    shown = by_use.reset_index().pivot_table(name, uses, "target", sort=False)
    return shown.astype(int).reset_index()


def finding(table: pd.DataFrame) -> str:
    """Say of how many settings that keep an error on the published cases it is kept on these."""
    known = counts(table, max(TARGETS))
    fewest, most = known["random_cases"].min(), known["random_cases"].max()
    each = f"{most}" if fewest == most else f"{fewest} to {most}"
    calm, every = ((known[name] == 0).sum() for name in ("random_calm_off", "random_off"))
    return (
        f"Of {len(known)} settings of engines that keep {per_cent(max(TARGETS))} on the published "
        f"cases, with every finer one, {calm} keep it on all random ones with "
        f"κ < {WELL_CONDITIONED:g}, and {every} on all ({each} random cases at a setting)."
    )
