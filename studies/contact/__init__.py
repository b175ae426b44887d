"""Contact models: what each setting costs and buys."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="contact",
    module="studies.contact.study",
    help="""Contact models: what each setting of an engine's contact costs and buys.

One factor at a time, from the best fixed-step setting and from the library's defaults. Writes
contact.csv, variants.csv, contact.png and findings.txt; resumable. The full study takes
about four minutes on one core, --quick less than one.""",
    table="contact.csv",
    products=("contact.csv", "variants.csv", "contact.png", "findings.txt"),
    chapters=(
        Chapter(
            folder="contact",
            question="What does each setting of a contact cost and buy?",
            tables=("variants.csv",),
            minutes=(0.8, 4.0),
            weaker="Fewer cases, and longer steps.",
        ),
    ),
    captions={
        "contact": (
            "Largest error of each preset of an engine, and with one setting of its contact "
            "changed: those ten that matter most; the others are counted."
        ),
    },
)
