"""The paper's sensitivity analysis, figures 6 to 9."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="sweep",
    module="studies.sweep.study",
    help="""The paper's sensitivity analysis, figures 6 to 9.

240 cases a figure through every named source. Writes sweep.csv (a row for each case and source), a
PNG for each figure, summary.csv, findings.txt and provenance.json. Finished cases are stored at
once: a run that was interrupted goes on where it stopped when the same command is given again.""",
    table="sweep.csv",
    products=(
        "sweep.csv",
        "summary.csv",
        "findings.csv",
        "findings.txt",
        "figure-6.png",
        "figure-7.png",
        "figure-8.png",
        "figure-9.png",
    ),
    chapters=(
        Chapter(
            folder="sweep",
            question="Do the engines and the linearizations get the paper's 960 cases right?",
            tables=("summary.csv",),
            quick=("--accuracy", "loose"),
            minutes=(0.3, 0.6),
        ),
        Chapter(
            folder="presets",
            question="And the engines as they come, or with a tuned contact and a fixed step?",
            tables=("summary.csv",),
            quick=("--figure", "8", "--sources", "exact", "core:naive"),
            full=("--sources", "exact", "core:naive", "core:fixed"),
            minutes=(0.2, 3.0),
        ),
    ),
)
