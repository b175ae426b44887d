"""Which setting of which engine for which accuracy."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="advise",
    help="""Which setting of which engine keeps an error, and how it is made in the library's words.

For each engine and preset the cheapest step that keeps the error with every finer one published, or
that nothing does. It runs nothing: it reads the published tables, and names them.""",
    table="advice.csv",
    tables=("advice.csv",),
    captions={
        "advice": (
            "Time of a case with each preset that keeps an error with every finer step, a panel "
            "for each error, a row for each engine; at the points their steps, p dt, or the "
            "accuracy of an engine's own."
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

STEPS = Study(
    name="steps",
    module="studies.advise.steps",
    help="""Random cases at the published steps: which of these keep an error on them, too.

At every published step from the coarsest that keeps an error of 10 % on the published cases, with
every finer one. `rocking advise` reads what comes of it. Writes random.csv; resumable.""",
    table="random.csv",
    tables=("random.csv",),
    chapters=(
        Chapter(
            folder="steps",
            question="Do the steps that keep an error keep it on random cases?",
            quick=("--cases", "20"),
            minutes=(0.4, 3.0),
            weaker="Fewer random cases.",
        ),
    ),
)
