"""Where the reference is valid, and what engines do beyond."""

from studies.kit.study import Chapter, Study

STUDY = Study(
    name="validity",
    help="""Where the reference is valid, and what engines do beyond: slide, lift off.

The smallest normal force and the friction needed over amplitude, frequency and H/B, and the engines
on squat blocks and with low friction. Writes validity.csv, map.csv, compared.csv, a
picture and findings.txt; resumable. The full study takes about a minute on one core, --quick a
quarter of one.""",
    table="validity.csv",
    tables=("validity.csv", "map.csv", "compared.csv"),
    chapters=(
        Chapter(
            folder="validity",
            question="Where is the reference itself valid, and what do engines do beyond?",
            minutes=(0.1, 3.0),
            weaker="Every other case of the engines, and fewer frictions.",
        ),
    ),
    captions={
        "validity": (
            "Amplitude over frequency for four H/B: where the reference holds, where its pivot "
            "would lift off, and symbols for what engines do there."
        ),
    },
)
