"""Contact models: what each setting costs and buys."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="contact",
    help="""Contact models: what each setting of an engine's contact costs and buys.

Solvers, geometry, friction, compliance, damping, integrators, ...: one factor at a time, from the
best fixed-step setting and from the library's defaults, on cases of the paper, or on frames of
several bodies, at one p dt; those that change the defaults at the library's own step too.
Resumable. A failure is an answer: the exit code is 1 only where a preset as it is fails at that
p dt.""",
    tables=("contact.csv", "variants.csv", "own-steps.csv"),
    chapters=(
        Chapter(
            question="What does each setting of a contact cost and buy?",
            tables=("variants.csv", "own-steps.csv"),
            minutes=(0.3, 1.5),
            weaker="Fewer cases, and longer steps.",
        ),
        Chapter(
            folder="contact-frames",
            question="And in a frame, where several bodies touch?",
            tables=("variants.csv", "own-steps.csv"),
            quick=("--scene", "frame", "--engines", "mujoco"),
            full=(
                *("--scene", "frame", "--quick", "--engines"),
                *("pybullet", "mujoco", "pymunk", "box2d", "dart", "rapier", "physx"),
            ),
            minutes=(0.3, 6.0),
            weaker="MuJoCo alone.",
        ),
    ),
    texts=("factor", "level", "trap"),
    claims=("variants",),
    drawings={"contact": ("draw_contact", "variants")},
    captions={
        "contact": (
            "Error of the peak, median to largest, of each preset of an engine, and with one "
            "setting of its contact changed or one help of landing left out: the six that matter "
            "most, of each preset in turn, the others in one line."
        ),
    },
)
