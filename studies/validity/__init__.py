"""Where the reference is valid, and what engines do beyond."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="validity",
    help="""Where the reference is valid, and what engines do beyond: slide, lift off.

The smallest normal force and the friction needed over amplitude, frequency and H/B, and the engines
on squat blocks and with low friction. Resumable.""",
    tables=("validity.csv", "map.csv", "compared.csv"),
    chapter=Chapter(
        question="Where is the reference itself valid, and what do engines do beyond?",
        minutes=(0.1, 3.0),
        weaker="Every other case of the engines, and fewer frictions.",
    ),
    claims=("map",),
    drawings={"validity": ("draw_validity", "map", "compared")},
    captions={
        "validity": (
            "Amplitude over frequency for four H/B: where the reference holds, where its pivot "
            "would lift off, and symbols for what engines do there."
        ),
    },
)
