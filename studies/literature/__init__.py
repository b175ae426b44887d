"""Printed numbers that no one here wrote, held against the models and the engines."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="literature",
    help="""Printed numbers on rocking blocks against the models and the engines.

Steady states under harmonic shaking and their limits of stability, least accelerations that
overturn a block, the end of a mode, a drop without friction, measured velocity ratios: each with
its source, the printed value and its digits, and why where it does not come out. An engine joins
where the printed block has ideally inelastic impacts, as the engine's has, and the print is a
threshold; and in its authors' own tests, whose bounds are held against exact numbers.
Resumable.""",
    tables=("literature.csv", "agreement.csv", "peers.csv"),
    chapter=Chapter(
        question="Do the numbers printed in the literature come out?",
        tables=("agreement.csv",),
        quick=(),
        full=("--sources", "housner", "engines"),
        minutes=(0.1, 0.5),
    ),
    texts=("measured", "agrees", "printed", "why"),
    claims=("agreement",),
    drawings={"literature": ("draw_literature", "agreement")},
    captions={
        "literature": (
            "Answers beside the numbers printed in the literature, a line for each; inside the "
            "band they agree to every printed digit."
        ),
    },
)
