"""Error against run time, and what a scene costs."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="precision",
    help="""Error against run time: every method along its own setting, on the same cases.

Every method along its own setting (tolerance, step, solver iterations) on 12 cases of the paper
whose peaks lie before or after impacts, and 12 near overturning. Timing is serial, on one thread,
warm, the best of five runs or more, until the shortest two agree, or of fewer where these take
longer than half a second: how many is a column. A compiled loop over mj_step takes MuJoCo's steps;
Python takes all others. Building and compiling are apart. Resumable.""",
    tables=("precision.csv", "work-precision.csv", "shares.csv", "scenes.csv", "reference.csv"),
    others=("findings.txt", "cost.txt"),
    chapter=Chapter(
        question="Which error does which run time buy, and what is not needed?",
        tables=("work-precision.csv", "scenes.csv", "shares.csv", "reference.csv"),
        minutes=(1.6, 8.2),
        weaker="Fewer cases and settings of each method, one timing of each.",
    ),
    claims=("work-precision",),
    drawings={
        "precision": ("draw_precision", "work-precision"),
        "cost": ("draw_scenes", "scenes"),
    },
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
history, ... measured by putting them back, on the block and pulse of the paper's figure 5-b: of one
thread, warm, the best of five or more, the scenes of an engine in turn.""",
    tables=("shares.csv", "scenes.csv", "reference.csv"),
    claims=("shares",),
    drawings={"cost": ("draw_scenes", "scenes")},
    others=("cost.txt", "cost.png"),
)
