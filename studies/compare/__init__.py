"""One block, one motion, every source side by side."""

from studies.old.study import Study

STUDY = Study(
    name="compare",
    help="""One block and one pulse or record through every source, side by side.

For each source: the outcome, the largest rotation over the critical one θcr = atan(B/H), its
relative difference from the exact solution, κ and the sensitivity of that, the impacts and their
velocity ratio beside Housner's η, the steps and the run time. All observe the same window of
time.""",
)
