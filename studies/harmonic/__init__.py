"""Sustained harmonic shaking: the steady states of a block, and where they end."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="harmonic",
    help="""Steady states under sustained harmonic shaking, over its frequency or amplitude.

The exact solution from a grid of starts, rotations by rates, at every point, and each orbit that it
finds followed to the points beside it: every attractor with its largest rotation to either side,
its period and impacts, and the share of the starts that end on it or overturn. Engines start on the
exact orbit at some points.""",
    tables=("harmonic.csv", "engines.csv"),
    chapter=Chapter(
        question="Which steady states does a block settle on under sustained shaking?",
        minutes=(0.2, 1.5),
        weaker="Fewer frequencies.",
    ),
    captions={
        "harmonic": (
            "Largest rotation of every steady state that was found over the frequency of sustained "
            "shaking, with the engines started on the exact orbit, and the share of the starts "
            "that end on each."
        ),
    },
)
