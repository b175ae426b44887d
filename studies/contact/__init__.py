"""Contact models: what each setting costs and buys."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="contact",
    help="""Contact models: what each setting of an engine's contact costs and buys.

One factor at a time, from the best fixed-step setting and from the library's defaults. Writes
contact.csv, variants.csv, own-steps.csv, contact.png and findings.txt; resumable. The full study
takes some four minutes on one core, --quick half a minute.""",
    table="contact.csv",
    tables=("contact.csv", "variants.csv", "own-steps.csv"),
    chapters=(
        Chapter(
            folder="contact",
            question="What does each setting of a contact cost and buy?",
            tables=("variants.csv", "own-steps.csv"),
            full=(*("--engines", "pybullet", "mujoco", "pymunk", "box2d", "dart", "rapier"),),
            minutes=(0.3, 1.5),
            weaker="Fewer cases, and longer steps.",
        ),
    ),
    captions={
        "contact": (
            "Error of the peak, median to largest, of each preset of an engine, and with one "
            "setting of its contact changed or one help of landing left out: the six that matter "
            "most, of each preset in turn, the others in one line."
        ),
    },
)
