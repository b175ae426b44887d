"""Error against run time, and what a scene costs."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="precision",
    help="""Error against run time: every method along its own setting, on the same cases.

Writes precision.csv, work-precision.csv, a work-precision diagram (PNG) and findings.txt;
resumable. The full study takes some eight minutes on one core, --quick one and a half.""",
    table="precision.csv",
    tables=("precision.csv", "work-precision.csv", "shares.csv", "scenes.csv", "reference.csv"),
    others=("findings.txt", "cost.txt"),
    chapters=(
        Chapter(
            folder="precision",
            question="Which error does which run time buy, and what is not needed?",
            tables=("work-precision.csv", "scenes.csv", "shares.csv", "reference.csv"),
            minutes=(1.6, 8.2),
            weaker="Fewer cases and settings of each method, one timing of each.",
        ),
    ),
    captions={
        "precision": (
            "Median error of the peak over run time, a panel for each engine and a line for each "
            "of its presets from coarse to fine, all other methods pale behind; in the strip above "
            "settings with which a case fails or has a wrong outcome."
        ),
        "cost": (
            "What each thing put back into a scene does to run time, on the left, and to the "
            "error, on the right."
        ),
    },
)

COST = Study(
    name="cost",
    module="studies.precision.cost",
    help="""What a scene costs, and what each thing left out of it would cost and change.

Where the time of a step goes, and the price of a free body, a full box, a moving base, a recorded
history, ... measured by putting them back. Writes shares.csv, scenes.csv and reference.csv, and,
with --starts, how long whole commands take, starts.csv, and, with --batches, what it is worth to
run many scenes at once, batches.csv.""",
    table="shares.csv",
    tables=("shares.csv", "scenes.csv", "reference.csv", "starts.csv", "batches.csv"),
    others=("cost.png", "cost.txt"),
)
