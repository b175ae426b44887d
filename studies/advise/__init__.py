"""Which setting of which engine for which accuracy."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="advise",
    help="""Which setting of which engine keeps an error, and how it is made in the library's words.

For each engine and preset the cheapest step that keeps the error with every finer one published, or
that nothing does: on the 24 cases along all steps, on the paper's with each preset as it is
declared, and on random cases where κ is small (`rocking steps`). Beside it stands how many random
cases are off there. It runs nothing: it reads the published tables, and names them.""",
    tables=("advice.csv",),
    claims=("advice",),
    drawings={"advice": ("draw_advice", "advice")},
    captions={
        "advice": (
            "Time of a case with each preset that keeps an error with every finer step, a panel "
            "for each error, a row for each engine; at the points their steps, p dt, or the "
            "accuracy of an engine's own."
        ),
    },
    chapter=Chapter(
        folder="advice",
        question="Which setting of which engine for which accuracy?",
        tables=("advice.csv",),
        quick=(),
        minutes=(0.1, 0.1),
    ),
)

STEPS = Study(
    name="steps",
    module="studies.advise.steps",
    help="""Random cases at the published steps: which of these keep an error on them, too.

At every published step from the coarsest that keeps an error of 10 % on the published cases, with
every finer one. `rocking advise` reads what comes of it. Resumable.""",
    tables=("random.csv",),
    claims=("random",),
    chapter=Chapter(
        question="Do the steps that keep an error keep it on random cases?",
        quick=("--cases", "20"),
        minutes=(0.4, 3.0),
        weaker="Fewer random cases.",
    ),
)
