"""The paper's time histories, figures 2, 4 and 5."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="histories",
    module="studies.histories.study",
    help="""The paper's time histories, figures 2, 4 and 5.

Writes for each figure its samples (CSV), its drawing (PNG) and what was found (text).""",
    table="figure-[245].csv",
    products=(
        "figure-2.csv",
        "figure-2.png",
        "figure-2.txt",
        "figure-4.csv",
        "figure-4.png",
        "figure-4.txt",
        "figure-5.csv",
        "figure-5.png",
        "figure-5.txt",
        "findings.csv",
    ),
    chapters=(
        Chapter(
            folder="histories",
            question="Do the paper's time histories come out, and what it says about them?",
            quick=(),
            minutes=(0.1, 0.1),
        ),
    ),
)
