"""Cases a second, beside SciPy."""

from studies.kit.study import Study

STUDY = Study(
    name="throughput",
    help="""Cases per second of an overturning map, beside SciPy.

A million cases of each pulse through every model, on all cores and on one; SciPy's DOP853 on
a sample of them. Writes throughput.csv.""",
    tables=("throughput.csv",),
)
