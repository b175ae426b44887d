"""Engines as documented, over the plane of pulses and two sizes of a block."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="defaults",
    help="""Engines as documented, over the plane of pulses: where they are right, and where not.

Half and full sines over frequency and amplitude, H/B of 2, 3 and 4, and two widths, which by
similarity are one; every other pulse begins after a second of rest, in which an engine may fall
asleep. Resumable. A case that fails is an answer, which the maps show: the exit code is 1 only
where the exact solution has no result.""",
    tables=("defaults.csv", "parts.csv", "rests.csv"),
    chapter=Chapter(
        question="Where on the map of pulses do engines go wrong as documented?",
        tables=("parts.csv", "rests.csv"),
        full=("--sources", "exact", "engines:naive"),
        minutes=(0.1, 3.5),
        weaker="One H/B, full sines and fewer pulses.",
    ),
    claims=("parts", "rests"),
    captions={
        "small": (
            "Frequency and amplitude of full-sine pulses, a map for each engine as its "
            "documentation shows it, of the smaller block: where the outcome is another than the "
            "exact one, and where the peak is off by more than a tenth."
        ),
        "large": (
            "The same maps of the larger block, which by similarity should look the same as those "
            "of the smaller one."
        ),
    },
)
