"""Cases a second, beside general-purpose integrators."""

from studies.kit.study import Study

STUDY = Study(
    name="throughput",
    help="""Cases per second of an overturning map, beside general-purpose integrators.

A million cases of each pulse through every model, on all cores and on one; SciPy's DOP853 and
heyoka.py, where it is installed, on a sample of them, alone and in its batch mode. All but one find
the outcome only: no peaks, nothing after the pulse but its energy; SciPy follows the free rocking
to its turning point.""",
    tables=("throughput.csv",),
)
