"""A list of blocks under records: which overturn, and how much stronger a record they bear."""

from studies.kit.study import Study

STUDY = Study(
    name="blocks",
    help="""A list of blocks under recorded ground motions: which overturn, with what margin.

For each block, record, scale and source: the outcome, the largest rotation over the critical one, κ
and the sensitivity, the friction that the exact solution needs, and the margin: the factor on the
record at which the block first overturns. Writes blocks.csv, a picture that ranks the blocks, a
page to hand on and findings.txt; resumable. Forty blocks under one record take seconds.""",
    table="blocks.csv",
    tables=("blocks.csv",),
    others=("blocks.html", "findings.txt"),
    captions={
        "blocks": (
            "Blocks ranked by the factor on a record that overturns them first; a line from the "
            "factor that lifts a block to the one that overturns it."
        ),
    },
)
