"""What in a linearization matters: onset, frequency or saddle."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="linearizations",
    help="""What in a linearization matters: onset, frequency and saddle, each alone.

All eight combinations against the exact solution, on the paper's cases and on a wider grid, and
the paper's conclusions (a), (b), (c). Writes linearizations.csv, quantiles.csv, a PNG and
findings.txt. A few seconds.""",
    table="linearizations.csv",
    tables=("linearizations.csv", "quantiles.csv", "findings.csv"),
    chapters=(
        Chapter(
            folder="linearizations",
            question="What in a linearization matters, and do the paper's conclusions hold?",
            tables=("linearizations.csv",),
            quick=(),
            minutes=(0.1, 0.1),
        ),
    ),
    captions={
        "linearizations": (
            "Up to which error of the peak a part of the cases stays, for eight linearizations on"
            " two grids: the colour tells the onset, which matters most, the dash the frequency."
        ),
    },
)
