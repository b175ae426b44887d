"""Stiff and extreme cases: what stays finite, right and accurate."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="stability",
    help="""Stiff and extreme cases: who stays finite, keeps the outcome and the energy.

The outcome, the peak and the energy of each method on extreme cases, the setting that mends a
failure, the largest stable and accurate steps, and how an answer moves with a small perturbation.
Resumable. A failure is an answer: the exit code is 1 only where a source gives no result at
all.""",
    tables=("stability.csv", "steps.csv", "sensitivity.csv"),
    chapter=Chapter(
        question="What stays finite, right and accurate in stiff and extreme cases?",
        tables=("steps.csv",),
        minutes=(0.3, 6.0),
        weaker="Neighbouring cases are left out, and those that take long.",
    ),
    claims=("stability",),
    drawings={"stability": ("draw_matrix", "stability")},
    captions={
        "stability": (
            "A matrix of extreme cases and methods: a symbol in each cell says whether the "
            "outcome is right or in which kind wrong, the peak off, or energy made."
        ),
    },
)
