"""Scenes beyond one block: a frame of columns and a beam, a block that slides, a moving floor."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="scenes",
    module="studies.scenes.study",
    help="""A rocking frame, a sliding block and a moving floor, against their exact solutions.

The frame is a beam on two or three free columns; the slide is friction alone: two slips under a
pulse, a launch, and a hold below the onset; the floor is moved in each way that an engine has, and
should carry a block along; a block that rocks on it is held against the exact answer on the floor
as it should move, and as it moved. Writes frame.csv, slide.csv, floor.csv, block.csv, their
summaries and pictures, and findings.txt; resumable.""",
    table="frame-summary.csv",
    products=(
        "frame.csv",
        "slide.csv",
        "floor.csv",
        "block.csv",
        "frame-summary.csv",
        "slide-summary.csv",
        "floor-summary.csv",
        "block-summary.csv",
        "frame.png",
        "slide.png",
        "floor.png",
        "findings.txt",
    ),
    chapters=(
        Chapter(
            folder="scenes",
            question="Does it hold for frames, for friction alone, on moving floors?",
            tables=tuple(f"{kind}-summary.csv" for kind in ("frame", "slide", "floor", "block")),
            minutes=(0.5, 12.0),
            weaker="One frame, one slide, two places of the steps.",
        ),
    ),
    captions={
        "frame": (
            "Error of the peak of a rocking frame for each engine, a bar from the median to the "
            "largest for its defaults, its tuned contact at equal steps and steps that land on "
            "impacts, on a logarithmic scale."
        ),
        "slide": (
            "Largest error of a slip of a sliding block, in millimetres, for each engine by its "
            "defaults and with its tuned contact at equal steps, on a logarithmic scale."
        ),
        "floor": (
            "How far a floor carries a block of what it should, for each engine and each way of "
            "moving the floor, when it moves at once and when it moves after a second of rest."
        ),
    },
)
