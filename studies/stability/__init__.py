"""Stiff and extreme cases: what stays finite, right and accurate."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="stability",
    help="""Stiff and extreme cases: who stays finite, keeps the outcome and the energy.

Writes stability.csv with its matrix (PNG), steps.csv (the largest stable and accurate steps),
sensitivity.csv and findings.txt; resumable. A failure is an answer: the exit code is 1 only where
a source gives no result at all. The full study takes about six minutes on two cores, --quick half
a minute.""",
    table="stability.csv",
    tables=("stability.csv", "steps.csv", "sensitivity.csv"),
    chapters=(
        Chapter(
            folder="stability",
            question="What stays finite, right and accurate in stiff and extreme cases?",
            tables=("steps.csv",),
            minutes=(0.3, 6.0),
            weaker="Neighbouring cases are left out, and those that take long.",
        ),
    ),
    captions={
        "stability": (
            "A matrix of extreme cases and methods: a symbol in each cell says whether the "
            "outcome is right or in which kind wrong, the peak off, or energy made."
        ),
    },
)
