"""Bodies that were measured: who predicts what they did?"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter

from studies.cases.refusal import BadInputError
from studies.experiments import cubes, rocks
from studies.kit.arguments import Count
from studies.kit.jobs import Job, Row
from studies.kit.study import Study, stages

ROCKS = "Folder of 490 shake-table tests: a clone of ZhiangChen/virtual_shake_robot_pybullet."
CUBES = (
    "Folder of 550 tosses (*.pt): cleaned_cube_trajectories/data in examples of DAIRLab/dairlib, "
    "branch contact_model_verification."
)
TESTS = "Of --rocks: tests, drawn at random, in which engines are asked; all by default."


@dataclass(frozen=True, kw_only=True)
class Options:
    """Which measurements."""

    rocks: Annotated[str | None, Parameter(help=ROCKS)] = None
    cubes: Annotated[str | None, Parameter(help=CUBES)] = None
    tests: Annotated[Count | None, Parameter(help=TESTS)] = None


def jobs(sources: Sequence[str], _: bool, options: Options) -> list[Job]:
    """Return the jobs of the measurements that are named."""
    named = sum(folder is not None for folder in (options.rocks, options.cubes))
    if named != 1:
        raise BadInputError(f"--rocks or --cubes must name a folder; {named} of them do")
    if options.rocks is not None:
        return rocks.jobs(sources, Path(options.rocks), options.tests)
    if options.tests is not None:
        raise BadInputError("--tests is of --rocks; leave it out with --cubes")
    return cubes.jobs(sources, Path(str(options.cubes)))


def measure(job: Job) -> Row:
    """Return what a source makes of a measured motion."""
    return cubes.measure(job) if "settings" in job.labels else rocks.measure(job)


def _of(stage: str) -> Callable[[Any], Any]:
    """Return a stage, of whichever measurements some rows or tables are."""
    return lambda found: getattr(cubes if "settings" in found else rocks, stage)(found)


STUDY = Study(
    name="experiments",
    question="Who predicts what rocks on a shake table and tossed cubes did?",
    help="""Two rocks under 490 recorded motions of a shake table: the exact block, fitted
and from the meshes; a rule of two thresholds; the authors' model; and engines that are asked, with
two blocks. Ten minutes without engines. Or 550 tosses of a cube in MuJoCo and PyBullet: with
default settings, those of Acosta et al. (2022), and settings fitted to half of the tosses. Half an
hour. Name one folder.""",
    sources=(rocks.EXACT,),
    options=Options,
    captions={
        "rocks": "What fell and what stood, over PGA and PGV, with the tests that all get wrong; "
        "and how well the margin of the block that fits all tests, PGA and PGV tell one from the "
        "other (ROC curves).",
        "cubes": "Mean loss of tosses that no fit here has seen, within 95 %, and the part of them "
        "that ends on the right face. The authors' settings were fitted to all tosses.",
    },
    **stages(jobs, measure),
    tabulate=_of("tabulate"),
    finding=_of("finding"),
    shown=_of("shown"),
    figures=_of("figures"),
)
command = STUDY.command()
