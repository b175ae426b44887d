"""What an engine makes of a coefficient of restitution."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="restitution",
    module="studies.restitution.study",
    help="""What each engine makes of a coefficient of restitution, and what setting gives which.

A sphere is dropped on a base: the speed after over before, for coefficients from 0 to 1, over
steps, speeds, sizes and where in a step the impact falls. Writes restitution.csv, kept.csv,
restitution.png and findings.txt; a minute.""",
    table="restitution.csv",
    products=("restitution.csv", "kept.csv", "restitution.png", "findings.txt"),
    captions={
        "restitution": (
            "The speed of a dropped sphere after its impact over that before, against the "
            "coefficient of restitution that was asked for, a panel for each way to ask; on the "
            "diagonal they are the same. The band is wherever in a step the impact falls, dashed "
            "lines are other steps, dotted ones other speeds, crosses drops that broke."
        ),
    },
    chapters=(
        Chapter(
            folder="restitution",
            question="Which setting gives which coefficient of restitution?",
            tables=("kept.csv",),
            quick=(),
            minutes=(0.2, 0.2),
        ),
    ),
)
