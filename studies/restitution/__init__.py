"""What an engine makes of a coefficient of restitution."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="restitution",
    help="""What each engine makes of a coefficient of restitution, and what setting gives which.

A block of 0.5 by 1 m in the preset "fixed" turns about a corner at half of alpha p and strikes its
base with the other, in steps of 1e-3/p: the speed of that corner after over before, for
coefficients from 0 to 1, wherever in a step the impact falls, and at another step, rate, height or
slenderness; and what the block keeps of its angular rate, beside 1 - 3/2 (1 + e) sin^2(alpha).""",
    tables=("restitution.csv", "corners.csv", "rates.csv"),
    texts=("way", "varied", "literal"),
    claims=("corners",),
    drawings={"corners": ("draw_corners", "restitution"), "rates": ("draw_rates", "restitution")},
    captions={
        "corners": (
            "How far the speed upwards of a corner that strikes the base, over that of its "
            "approach, is at most from the coefficient of restitution that was asked for, a row "
            'for each way, where "and" adds to the one before, and below what comes out of those '
            "neither kept nor ignored: a band for wherever in a step the impact falls, crosses "
            "for strikes that broke."
        ),
        "rates": (
            "The angular rate of a block after an impact of its corner over that before, against "
            "the coefficient of restitution that was asked for; the thin line is 1 - 3/2 (1 + e) "
            "sin² α, of a corner that bounces and does not slide."
        ),
    },
    chapter=Chapter(
        question="Which setting gives which coefficient of restitution?",
        tables=("corners.csv", "rates.csv"),
        quick=(),
        minutes=(0.4, 0.2),
    ),
)
