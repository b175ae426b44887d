"""Sustained harmonic shaking: the steady states of a block, and where they end."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="harmonic",
    module="studies.harmonic.study",
    help="""Steady states under sustained harmonic shaking, over its frequency or amplitude.

The exact solution swept up and down, each point starting from the state that the last one left, so
that branches which live side by side are both found; its largest rotation to either side, the
period of the orbit and its impacts, and where the block overturns. Engines start on the exact orbit
at some points. Writes harmonic.csv, engines.csv, harmonic.png and findings.txt. About a minute.""",
    table="harmonic.csv",
    products=("harmonic.csv", "engines.csv", "harmonic.png", "findings.txt"),
    chapters=(
        Chapter(
            folder="harmonic",
            question="Which steady states does a block settle on under sustained shaking?",
            minutes=(0.1, 1.5),
            weaker="Fewer frequencies.",
        ),
    ),
    captions={
        "harmonic": (
            "Largest steady rotation over the frequency of sustained shaking, swept up and down, "
            "with the engines started on the exact orbit."
        ),
    },
)
