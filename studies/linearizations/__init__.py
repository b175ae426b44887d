"""What in a linearization matters: onset, frequency or saddle."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="linearizations",
    help="""What in a linearization matters: onset, frequency and saddle, each alone.

All eight combinations of Housner's and the modified choices against the exact solution, on the
paper's cases and on a wider grid, and the paper's conclusions (a), (b), (c).""",
    tables=("linearizations.csv", "quantiles.csv", "findings.csv"),
    chapter=Chapter(
        question="What in a linearization matters, and do the paper's conclusions hold?",
        tables=("linearizations.csv",),
        quick=(),
        minutes=(0.1, 0.1),
    ),
    texts=("changed",),
    drawings={"linearizations": ("draw_distributions", "quantiles")},
    captions={
        "linearizations": (
            "Up to which error of the peak a part of the cases stays, for eight linearizations on"
            " two grids: the colour tells the onset, which matters most, the dash the frequency."
        ),
    },
)
