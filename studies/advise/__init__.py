"""Which setting of which engine for which accuracy."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="advise",
    module="studies.advise.study",
    help="""Which setting of which engine keeps an error, and how it is made in the library's words.

For each engine and preset the cheapest step with which every published case keeps the error, or
that nothing does. It runs nothing: it reads the published tables, and names them.""",
    table="advice.csv",
    products=("advice.csv", "advice.png", "findings.txt"),
    captions={
        "advice": (
            "Time of a case over the largest error that is to be kept, a line for each engine and "
            "preset that keeps it on every published case; beside the points their steps, p dt, "
            "or the accuracy of an engine's own."
        ),
    },
    chapters=(
        Chapter(
            folder="advice",
            question="Which setting of which engine for which accuracy?",
            tables=("advice.csv",),
            quick=(),
            minutes=(0.1, 0.1),
        ),
    ),
)
