"""Overturning maps: which pulses overturn a block, and who draws that map wrongly."""

from studies.old.study import Chapter, Study

STUDY = Study(
    name="overturning",
    help="""Overturning maps: which pulses overturn a block, after how many impacts.

Amplitude over frequency, slenderness or size, for each model; the engines on a coarse grid and
beside the edges; where each differs from the exact solution. The engines' runs are resumable.""",
    table="boundaries.csv",
    tables=(
        *("map.csv", "boundaries.csv", "conditioning.csv", "engines.csv", "edges.csv"),
        *("thresholds.csv", "differences.csv", "checks.csv"),
    ),
    chapter=Chapter(
        question="Which pulses overturn a block, and who draws that map wrongly?",
        tables=("differences.csv", "checks.csv"),
        minutes=(0.1, 5.0),
        weaker="A coarser map, 64 cells for each engine, and one place on each edge.",
    ),
    claims=("differences",),
    captions={
        "map": (
            "Amplitude over frequency: which pulses overturn a block at once, which after an "
            "impact, and the least that does by each linearization."
        ),
        "differences": (
            "The same map for each linearization and engine with its wrong parts filled: "
            "overturned falsely, or overturning missed."
        ),
        "conditioning": (
            "The same map with κ as colour, by which a small error of the pulse grows into one of"
            " the peak."
        ),
    },
)
