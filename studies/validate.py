"""Random cases that no setting was tuned on: sources beside the exact solution and κ."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import asdict, dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
import pandas as pd

from analytic import simulate
from analytic.block import STANDARD_GRAVITY, RigidBlock
from analytic.motion import SinePulse
from studies import provenance
from studies.arguments import Count, Positive, check_sources, several
from studies.differences import (
    conditioning_of,
    scientific,
    with_reference,
)
from studies.executors import Executor, choose
from studies.hints import CALM, HINTED, hint_jobs, leanings, leanings_text
from studies.jobs import Job
from studies.journal import Row
from studies.runner import exit_code, fill_folder
from studies.sources import DEFAULT_EFFORT, Accuracy, Effort

if TYPE_CHECKING:
    from matplotlib.figure import Figure

PRODUCTS = (
    *("validate.csv", "errors.csv", "hints.csv", "leaning.csv"),
    *("findings.txt", "provenance.json"),
)

LEAST_NORMAL = 0.2
"""Cases are kept where the reference's normal force stays above this part of the weight."""

WELL_CONDITIONED = 10.0
"""Below this κ the error of a peak says more about its source than about the case."""


@dataclass(frozen=True, slots=True, kw_only=True)
class RandomCase:
    """A block and a pulse drawn at random."""

    case: int
    aspect: float
    width_m: float
    half_cycles: int
    amplitude_g: float
    omega_over_p: float

    @property
    def block(self) -> RigidBlock:
        """The block."""
        return RigidBlock(width=self.width_m, height=self.aspect * self.width_m)

    @property
    def motion(self) -> SinePulse:
        """The pulse."""
        return SinePulse(
            amplitude=self.amplitude_g * STANDARD_GRAVITY,
            omega=self.omega_over_p * self.block.p,
            half_cycles=self.half_cycles,
        )


def draw(seed: int) -> Iterator[RandomCase]:
    """Yield random cases without end, the same ones for the same seed.

    H/B from 1.2 to 12, B from 0.02 to 10 m, 1 to 4 half cycles, amplitudes from 1.02 to 4 onsets
    and omega/p from 0.3 to 12, width and frequency with uniform logarithms; only where the
    reference's normal force stays above LEAST_NORMAL weights.
    """
    generator = np.random.default_rng(seed)
    case = 0
    while True:
        aspect = float(generator.uniform(1.2, 12.0))
        drawn = RandomCase(
            case=case,
            aspect=aspect,
            width_m=math.exp(generator.uniform(math.log(0.02), math.log(10.0))),
            half_cycles=int(generator.integers(1, 5)),
            amplitude_g=float(generator.uniform(1.02, 4.0)) / aspect,
            omega_over_p=math.exp(generator.uniform(math.log(0.3), math.log(12.0))),
        )
        if simulate(drawn.block, drawn.motion).min_normal > LEAST_NORMAL:
            yield drawn
            case += 1


def command(
    *,
    out: Path,
    cases: Count = 500,
    seed: Count = 1,
    sources: Annotated[tuple[str, ...], several] = ("pybullet", "mujoco"),
    step: Positive | None = None,
    accuracy: Accuracy | None = None,
    jobs: Count | None = None,
    time_limit: Positive = 60.0,
    cluster: str | None = None,
) -> int:
    """Hold the sources against the exact solution on random cases.

    The first cases are asked of engines whose steps land on impacts with false hints, too: about
    when an uplift is to be expected, about which corner, and how fast the block falls.

    Parameters
    ----------
    out
        Folder for the results; made if there is none.
    cases
        Number of random cases.
    seed
        Seed of the random numbers, a positive whole number; another one draws other cases.
    sources
        exact housner modified onset-matched rk4 average-acceleration pybullet mujoco, and SciPy's
        rk45 dop853 radau lsoda; an engine takes a preset after a colon, as in mujoco:fixed.
    step
        p dt [-] of the solvers and engines, the step in units of 1/p; by default their own.
    accuracy
        loose, standard or tight, for engines whose steps land on impacts; standard by default.
    jobs
        Processes for the engines; by default the number of cores.
    time_limit
        Wall-clock time [s] after which an engine's case is given up.
    cluster
        Address of a Dask scheduler, whose workers then run all cases, as in tcp://127.0.0.1:8786.
    """
    check_sources(sources)
    executor = choose(jobs, time_limit, cluster)
    rows = validate(cases, seed, sources, out, executor=executor, effort=Effort(step, accuracy))
    print(report(out))
    return exit_code([row for row in rows if row["table"] == "validate"])


def validate(
    cases: int,
    seed: int,
    sources: Sequence[str],
    folder: Path,
    *,
    executor: Executor,
    effort: Effort = DEFAULT_EFFORT,
) -> list[Row]:
    """Run the random cases that the folder does not hold yet, and write its tables.

    Raises
    ------
    FolderError
        If the folder cannot be used.
    """
    drawn = list(islice(draw(seed), cases))
    jobs = [
        Job(
            labels={"table": "validate", **asdict(case)},
            block=case.block,
            motion=case.motion,
            source=source,
            options=effort.options(source),
        )
        for case in drawn
        for source in sources
    ]
    return fill_folder(
        folder,
        "validate",
        [*jobs, *hint_jobs(drawn[:HINTED], sources, effort)],
        executor=executor,
        settings={"seed": seed, **asdict(effort)},
        growing={"case": range(cases), "source": sources},
        products=PRODUCTS,
        tables="table",
    )


def report(folder: Path) -> str:
    """Hold a folder's tables against the exact solution; write two more, return the text.

    errors.csv has, for each row of validate.csv, the exact peak and outcome, the error and κ;
    leaning.csv has a row for each source and hint, where hints.csv is there.
    """
    from studies.figures import save_all

    compared = compare(folder, "validate")
    provenance.write_text(folder / "errors.csv", compared.to_csv(index=False, na_rep="nan"))
    save_all(pictures(folder), folder)
    sensitivity = conditioning_of(compared)
    calm = compared[sensitivity < WELL_CONDITIONED]
    text = "\n".join(
        [
            "Relative error of the peak over cases that survive both, outcomes right:",
            summary_text(compared),
            "\nThe same where κ, the larger of |∂ln θmax/∂ln a_p| and |∂ln θmax/∂ln η|, is below "
            f"{WELL_CONDITIONED:g}:",
            summary_text(calm),
            "\nError over κ, the relative error of the pulse or of the impact that does as much:",
            summary_text(compared.assign(error=compared["error"] / sensitivity)),
            "\nThe largest errors:",
            worst_text(compared),
            *leaning_lines(folder, compared),
        ]
    )
    provenance.write_text(folder / "findings.txt", text + "\n")
    return text


def compare(folder: Path, table: str) -> pd.DataFrame:
    """Read a table back, and hold it against the exact solution."""
    return with_reference(pd.read_csv(folder / f"{table}.csv", dtype={"message": str}))


def leaning_lines(folder: Path, compared: pd.DataFrame) -> list[str]:
    """Write leaning.csv, and return what it says; nothing where no source was given hints."""
    if not (folder / "hints.csv").exists():
        return []
    table = pd.DataFrame(map(asdict, leanings(compared, compare(folder, "hints"))))
    provenance.write_text(folder / "leaning.csv", table.to_csv(index=False, na_rep="nan"))
    cases = table["cases"].max()
    return [
        f"\nWhat landing steps lean on: the first {cases} cases with hints that are false,",
        f"and again at {CALM:g} of what lifts the block, where it must stay:",
        leanings_text(table),
    ]


def pictures(folder: Path) -> dict[str, "Figure"]:
    """Draw the errors of a folder against κ, from its errors.csv alone."""
    from studies.diagrams import draw_conditioning

    return {"validate": draw_conditioning(pd.read_csv(folder / "errors.csv"))}


def headline(folder: Path) -> str:
    """Say how many outcomes each source gets right, and its largest error over κ."""
    compared = pd.read_csv(folder / "errors.csv")
    scaled = compared["error"].abs() / conditioning_of(compared)
    words = [
        f"{source} {int(rows['agrees'].sum())} of {len(rows)} "
        f"({scientific(float(scaled[rows.index].max()))})"
        for source, rows in compared.groupby("source", sort=False)
    ]
    return (
        "On random cases, outcomes that agree with the exact solution, and the largest error of a "
        f"peak over its condition number: {', '.join(words)}."
    )


def summary_text(compared: pd.DataFrame) -> str:
    """Return outcomes and quantiles of the error of each source as an aligned table."""
    lines = []
    for source, group in compared.groupby("source", sort=False):
        errors = group["error"].abs().dropna()
        quantiles = [float(errors.quantile(q)) for q in (0.5, 0.9, 0.99, 1.0)]
        right = f"{int(group['agrees'].sum())}/{len(group)}"
        failed = int((group["outcome"] == "failed").sum())
        lines.append([source, right, failed, *(scientific(value) for value in quantiles)])
    columns = ["source", "outcomes", "failed", "median", "p90", "p99", "max"]
    return pd.DataFrame(lines, columns=columns).to_string(index=False)


def worst_text(compared: pd.DataFrame, count: int = 5) -> str:
    """Return the cases in which each source errs most, and those of which it gets wrong."""
    erring = compared.assign(size=compared["error"].abs().where(compared["agrees"], math.inf))
    worst = erring.sort_values("size", ascending=False).groupby("source", sort=False).head(count)
    shown = worst.sort_values(["source", "size"], ascending=[True, False]).assign(
        error=worst["error"].map(scientific),
        aspect=worst["aspect"].map("{:.2f}".format),
        width_m=worst["width_m"].map("{:.3g}".format),
        amplitude=(worst["amplitude_g"] * worst["aspect"]).map("{:.3f}".format),
        omega_over_p=worst["omega_over_p"].map("{:.3f}".format),
        exact_peak=worst["exact_peak"].map("{:.3g}".format),
        kappa=worst["kappa"].map("{:.3g}".format),
        kappa_eta=worst["kappa_eta"].map("{:.3g}".format),
    )
    names = {
        "source": "source",
        "case": "case",
        "aspect": "H/B",
        "width_m": "B m",
        "half_cycles": "n",
        "amplitude": "a/onset",
        "omega_over_p": "ω/p",
        "outcome": "outcome",
        "exact_outcome": "exact",
        "exact_peak": "peak",
        "error": "error",
        "kappa": "κ",
        "kappa_eta": "κη",
    }
    return shown[list(names)].rename(columns=names).to_string(index=False)
