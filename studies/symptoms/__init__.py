"""From what users see to the setting that mends it."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="symptoms",
    help="""From what users see to the setting that mends it, with the effect that was measured.

A block creeps, sinks, bounces, tips too early, a moved base carries nothing, ...: for each engine
what it is by default; of the settings changed one at a time the one that helps most, if it halves
what there is and gets no more outcomes wrong, line by line in an exported script and for your own
step (--dt); and what is left with all of them, with equal steps and with steps that land on
impacts. It runs nothing: it reads the published tables of `rocking contact`, `rocking precision`
and `rocking restitution`.""",
    tables=("symptoms.csv",),
    texts=("shown_by", "setting", "formula", "literal", "asked_in", "command"),
    claims=("symptoms",),
    drawings={"symptoms": ("draw_symptoms", "symptoms")},
    captions={
        "symptoms": (
            "What users of an engine see, a panel for each symptom, a row for each engine, "
            "its size on a logarithmic scale: as documented, with the one setting that helps most, "
            "with all of a contact tuned at equal steps, and with steps that land on impacts."
        ),
    },
    chapter=Chapter(
        question="Which setting mends what users of an engine see?",
        tables=("symptoms.csv",),
        quick=(),
        minutes=(0.1, 0.1),
    ),
)
