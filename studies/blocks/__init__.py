"""A list of blocks under records: which overturn, and how much stronger a record they bear."""

from studies.old.study import Study

STUDY = Study(
    name="blocks",
    help="""A list of blocks under recorded ground motions: which overturn, with what margin.

For each block, record, scale and source: the outcome, the largest rotation over the critical one, κ
and the sensitivity, the friction that the exact solution needs, and the margin: the factor on the
record at which the block first overturns. A block with friction below B/H slides: its row has the
slips and no margin. Where the friction is less than the rocking needs, the row says "slides first",
and there is no margin either. A picture ranks the blocks, a page is to hand on. Resumable; forty
blocks under one record take seconds.""",
    tables=("blocks.csv",),
    others=("findings.txt", "blocks.html"),
    captions={
        "blocks": (
            "Blocks ranked by the factor on a record that overturns them first; a line from the "
            "factor that lifts a block to the one that overturns it."
        ),
    },
)
