"""Free rocking: period and decay against the closed forms."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="free",
    help="""Free rocking: quarter periods and decay of each source against the closed forms.

Over the rotation from which the block falls and over H/B. Writes free.csv, free.png and
findings.txt; resumable. Less than a minute.""",
    table="free.csv",
    tables=("free.csv",),
    chapters=(
        Chapter(
            folder="free",
            question="Is free rocking as the closed forms say?",
            minutes=(0.1, 0.3),
            weaker="Fewer blocks and tilts.",
        ),
    ),
    captions={
        "free": (
            "Errors of the time between impacts, of the rotation after an impact and of the time "
            "of twenty impacts, over the rotation from which a block falls, on a logarithmic "
            "scale."
        ),
    },
)
