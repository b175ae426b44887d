"""The paper's time histories, figures 2, 4 and 5."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="histories",
    help="""The paper's time histories, figures 2, 4 and 5.

For each figure its samples, its drawing, and whether what the paper says of it holds.""",
    table="figure-[245].csv",
    tables=("figure-2.csv", "figure-4.csv", "figure-5.csv", "findings.csv"),
    others=("figure-2.txt", "figure-4.txt", "figure-5.txt"),
    chapter=Chapter(
        question="Do the paper's time histories come out, and its words on them?",
        quick=(),
        minutes=(0.1, 0.1),
    ),
    captions={
        "figure-2": (
            "Rotation over time by the exact solution, Runge–Kutta and average acceleration, "
            "which cannot be told apart; under each, by how much they are off."
        ),
        "figure-4": (
            "Rotation over time of three blocks under a half-sine pulse: exact, Housner's "
            "linearization and the modified one."
        ),
        "figure-5": (
            "Rotation over time of three blocks under a full-sine pulse: exact, Housner's "
            "linearization, which overturns two of them, and the modified one."
        ),
    },
)
