"""Bodies that were measured: who predicts what they did?"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from types import ModuleType

import pandas as pd
from cyclopts import Parameter

from studies.cases.refusal import BadInputError
from studies.experiments import cubes, rocks
from studies.kit.jobs import Job, Row
from studies.kit.study import Figures, Study, Tables, stages

BODIES = {"rocks": rocks, "cubes": cubes}


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Options:
    """Which measurements.

    Attributes
    ----------
    rocks
        Folder of 490 shake-table tests: a clone of ZhiangChen/virtual_shake_robot_pybullet.
    cubes
        Folder of 550 tosses (*.pt): cleaned_cube_trajectories/data in examples of
        DAIRLab/dairlib, branch contact_model_verification.
    """

    rocks: str | None = None
    cubes: str | None = None


def jobs(sources: Sequence[str], _: bool, options: Options) -> list[Job]:
    """Return the jobs of the measurements that are named."""
    named = {name: folder for name, folder in asdict(options).items() if folder is not None}
    if len(named) != 1:
        raise BadInputError(f"--rocks or --cubes must name a folder; {len(named)} of them do")
    ((name, folder),) = named.items()
    found: list[Job] = BODIES[name].jobs(sources, Path(folder))
    return found


def _bodies(names: Collection[str]) -> ModuleType:
    """Return whose measurements some tables or columns are."""
    return cubes if "settings" in names else rocks


def measure(job: Job) -> Row:
    """Return what a source makes of a measured motion."""
    row: Row = _bodies(job.labels).measure(job)
    return row


def tabulate(rows: pd.DataFrame) -> Tables:
    """Return the tables of the measurements that were asked."""
    tables: Tables = _bodies(rows.columns).tabulate(rows)
    return tables


def finding(tables: Tables) -> str:
    """Say what they show."""
    return str(_bodies(tables).finding(tables))


def shown(tables: Tables) -> Tables:
    """Return what is printed of them."""
    found: Tables = _bodies(tables).shown(tables)
    return found


def figures(tables: Tables) -> Figures:
    """Draw them."""
    drawn: Figures = _bodies(tables).figures(tables)
    return drawn


STUDY = Study(
    name="experiments",
    question="Who predicts what rocks on a shake table and tossed cubes did?",
    help="""Two rocks under 490 recorded motions of a shake table: the exact block, fitted
and from the meshes; a rule of two thresholds; the authors' model; and engines that are asked, with
the fitted block. Ten minutes without engines. Or 550 tosses of a cube in MuJoCo and PyBullet: with
default settings, those of Acosta et al. (2022), and settings fitted to half of the tosses. Half an
hour. Name one folder.""",
    sources=(rocks.EXACT,),
    options=Options,
    captions={
        "rocks": "What fell and what stood, over PGA and PGV, with the tests that all get wrong; "
        "and how well the margin, PGA and PGV tell one from the other (ROC curves).",
        "cubes": "Mean loss of the tosses that no fit has seen, within 95 %, and the part of them "
        "that ends on the right face.",
    },
    **stages(jobs, measure, tabulate, finding, shown, figures),
)
command = STUDY.command()
