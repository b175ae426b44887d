"""Many motions: single responses and their statistics."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="ensemble",
    help="""Many motions, blocks and intensities: single responses and their statistics.

Distributions of the peak, fragility curves with their bounds, and the agreement of each source with
the exact solution case by case and in distribution. Resumable.""",
    tables=("ensemble.csv", "stripes.csv", "curves.csv", "agreement.csv", "confusion.csv"),
    chapter=Chapter(
        question="Are statistics predicted where single responses are not?",
        tables=("agreement.csv", "confusion.csv"),
        minutes=(0.1, 2.7),
        weaker="Fewer motions and intensities, and one block.",
    ),
    claims=("agreement",),
    captions={
        "ensemble": (
            "Share of motions that overturn a block over their intensity, by each source, and "
            "under it the capacity by each over the exact one with its interval."
        ),
        "singles": (
            "Peak of each single response by a source over the exact one: on the diagonal they "
            "agree."
        ),
    },
)
