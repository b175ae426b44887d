"""How far off an answer is, without the exact one."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="estimate",
    module="studies.estimate.study",
    help="""How far off an answer is, told by the engine itself at half the step.

The difference of the two runs, held against the true error on random cases: by how much it is to
be multiplied to bound it, and with which presets it does not see the error. Writes estimate.csv,
estimates.csv, factors.csv, estimate.png and findings.txt; resumable.""",
    table="estimate.csv",
    products=("estimate.csv", "estimates.csv", "factors.csv", "estimate.png", "findings.txt"),
    captions={
        "estimate": (
            "Part of the cases whose true error is within so many times the engine's own estimate "
            "of it, the difference from half the step; a line for each engine, by preset."
        ),
    },
    chapters=(
        Chapter(
            folder="estimate",
            question="How far off is an answer, where there is no exact one?",
            tables=("factors.csv",),
            quick=("--cases", "20"),
            minutes=(0.3, 4.0),
        ),
    ),
)
