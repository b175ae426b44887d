"""Random cases that nothing was tuned on."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="validate",
    module="studies.validate.study",
    help="""Random cases that nothing was tuned on, held against the exact solution.

Outcomes, quantiles of the error, and the condition number κ of each case: how far a small error of
the pulse moves its peak. Writes validate.csv, errors.csv and provenance.json; resumable.""",
    table="validate.csv",
    products=("validate.csv", "errors.csv", "validate.png", "findings.txt"),
    chapters=(
        Chapter(
            folder="validate",
            question="And cases that nothing was tuned on?",
            quick=("--cases", "100"),
            minutes=(0.1, 0.3),
        ),
    ),
)
