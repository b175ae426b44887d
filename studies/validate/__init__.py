"""Random cases that nothing was tuned on."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="validate",
    help="""Random cases that nothing was tuned on, held against the exact solution.

Outcomes, quantiles of the error, and how far a small error of the pulse moves the peak of each
case: its condition number κ, and its sensitivity to errors of 1e-6 and 1e-4. And with --estimate
what each engine says of its own error. Resumable.""",
    tables=("validate.csv", "errors.csv", "drawn.csv", "bands.csv", "halves.csv"),
    chapter=Chapter(
        question="And cases that nothing was tuned on?",
        tables=("drawn.csv", "bands.csv"),
        quick=("--cases", "100"),
        minutes=(0.2, 0.3),
        weaker="Fewer random cases.",
    ),
    claims=("errors",),
    drawings={"validate": ("draw_conditioning", "errors")},
    captions={
        "validate": (
            "Errors of random cases in bands of S, how far small errors of the pulse or of the "
            "impacts move a peak: for each engine the middle half, the median, and the ends."
        ),
    },
)
