"""What an engine makes of a coefficient of restitution."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="restitution",
    module="studies.restitution.study",
    help="""What each engine makes of a coefficient of restitution, and what setting gives which.

A sphere is dropped on a base: the speed after over before, for coefficients from 0 to 1, over
steps, speeds, sizes and where in a step the impact falls. And a block that turns about a corner
strikes with the other: what it keeps of its angular rate, beside 1 - 3/2 (1 + e) sin^2(alpha).
Writes restitution.csv, kept.csv, strikes.csv, struck.csv, two pictures and findings.txt; a
minute.""",
    table="restitution.csv",
    products=(
        *("restitution.csv", "kept.csv", "strikes.csv", "struck.csv"),
        *("restitution.png", "strikes.png", "findings.txt"),
    ),
    captions={
        "restitution": (
            "The speed of a dropped sphere after its impact over that before, against the "
            'coefficient of restitution that was asked for, a panel for each way to ask: "and" '
            "adds to the one before. The band is wherever in a step the impact falls; crosses are "
            "drops that broke."
        ),
        "strikes": (
            "The angular rate of a block after an impact of its corner over that before, against "
            "the coefficient of restitution that was asked for; the thin line is 1 - 3/2 (1 + e) "
            "sin² α, from the moment of momentum about a corner that bounces and does not slide. "
            "Bands as above."
        ),
    },
    chapters=(
        Chapter(
            folder="restitution",
            question="Which setting gives which coefficient of restitution?",
            tables=("kept.csv", "struck.csv"),
            quick=(),
            minutes=(0.4, 0.2),
        ),
    ),
)
