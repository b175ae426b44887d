"""Scenes beyond one block: a frame, a slide, a moving floor."""

from studies.old.study import Chapter, Study

KINDS = ("frame", "slide", "floor", "block")

STUDY = Study(
    name="scenes",
    help="""A frame, a slide, a moving floor; their exact solutions.

The frame is a beam on two or three free columns, which turn as a block of another size and
restitution does, and once on five, or much lighter or heavier than they are; the slide is friction
alone: two slips under a pulse, a launch, and a hold below the onset; the floor is moved in each way
that an engine has, and should carry a block along; a block that rocks on it is held against the
exact answer on the floor as it should move, and as it moved. What an engine is not built for is a
row that says so. Resumable.""",
    table="frame-summary.csv",
    tables=(
        *(f"{kind}.csv" for kind in KINDS),
        *(f"{kind}-summary.csv" for kind in KINDS),
        "frame-extremes.csv",
        "frame-steps.csv",
    ),
    chapter=Chapter(
        question="Does it hold for frames, friction alone, moving floors?",
        tables=(
            *(f"{kind}-summary.csv" for kind in KINDS),
            *("frame-extremes.csv", "frame-steps.csv"),
        ),
        minutes=(0.5, 12.0),
        weaker="One frame, one slide, two places of the steps.",
    ),
    captions={
        "frame-scene": (
            "A rocking frame: two columns that lean to the right about their right corners, and on "
            "their tops a beam that stays level; dashed, where they stand at rest."
        ),
        "slide-scene": (
            "A sliding block on its base, to the right of where it began, which is dashed; it "
            "stays flat, and only friction holds it."
        ),
        **{
            f"{scene}-time": (
                f"{scenes}: for each engine and preset a line from the median to the largest error "
                f"of {what}, against the run time of a case, both on logarithmic scales."
            )
            for scene, scenes, what in (
                ("frame", "Frames", "the peak"),
                ("slide", "Slides", "a slip"),
            )
        },
        "floor": (
            "How far a floor carries a block of what it should, for each engine and each way of "
            "moving the floor, when it moves at once and when it moves after a second of rest."
        ),
    },
)
