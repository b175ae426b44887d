"""How far off an answer is, without the exact one."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="estimate",
    help="""How far off an answer is, told by the engine itself at half the step.

The difference of the two runs, held against the true error on random cases that survive: by how
much it is to be multiplied to bound it, told by the upper end of that factor's 95 % interval and
tried on other cases, and with which presets there is no bound. Resumable.""",
    tables=("estimate.csv", "estimates.csv", "factors.csv"),
    claims=("factors",),
    drawings={"estimate": ("draw_estimates", "estimates")},
    captions={
        "estimate": (
            "Part of the cases whose true error is within so many times the engine's own estimate "
            "of it, the difference from half the step; a line for each engine, by preset."
        ),
    },
    chapter=Chapter(
        question="How far off is an answer, where there is no exact one?",
        tables=("factors.csv",),
        quick=("--cases", "20", "--tests", "10"),
        minutes=(0.5, 25.0),
        weaker="So few random cases that no factor has an upper end.",
    ),
)
