"""Cases a second, beside general-purpose integrators."""

from studies.kit.study import Study

STUDY = Study(
    name="throughput",
    help="""Cases per second of an overturning map, beside general-purpose integrators.

A million cases of each pulse through every model, on all cores and on one; SciPy's DOP853 and
heyoka.py, where it is installed, on a sample of them. Writes throughput.csv.""",
    tables=("throughput.csv",),
)
