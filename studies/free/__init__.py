"""Free rocking: period and decay against the closed forms."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="free",
    help="""Free rocking: quarter periods and decay of each source against the closed forms.

A block is released at rest from a tilt, on ground that does not move. Its first impact comes after
the quarter period of that tilt; the time between two impacts is twice the quarter period of the
rotation between them, which follows from the one before by the velocity ratio at the impact. What
the errors of many impacts add up to is the drift: how much too late the 20th comes. Resumable.""",
    tables=("free.csv",),
    chapter=Chapter(
        question="Is free rocking as the closed forms say?",
        minutes=(0.1, 0.3),
        weaker="Fewer blocks and tilts.",
    ),
    drawings={"free": ("draw_free", "free")},
    captions={
        "free": (
            "Errors of the time between impacts, of the rotation after an impact and of the time "
            "of twenty impacts, over the rotation from which a block falls, on a logarithmic "
            "scale."
        ),
    },
)
