"""Scenes beyond one block: a frame of columns and a beam, and a block that slides."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="scenes",
    module="studies.scenes.study",
    help="""A rocking frame and a sliding block in each engine, against their exact solutions.

The frame is a beam on two or three free columns; the slide is friction alone: two slips under a
pulse, a launch, and a hold below the onset. Writes frame.csv and slide.csv, a summary and a picture
of each, and findings.txt; resumable.""",
    table="frame-summary.csv",
    products=(
        "frame.csv",
        "slide.csv",
        "frame-summary.csv",
        "slide-summary.csv",
        "frame.png",
        "slide.png",
        "findings.txt",
    ),
    chapters=(
        Chapter(
            folder="scenes",
            question="Does it hold for several bodies, and for friction alone?",
            tables=("frame-summary", "slide-summary"),
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
    },
)
