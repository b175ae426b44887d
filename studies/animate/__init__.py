"""A block in several sources side by side, as a film."""

from studies.kit.study import Study

STUDY = Study(
    name="animate",
    help="""A block rocking in several sources side by side, on the same clock, as a film.

For one block and pulse, or for the case of a sweep's results in which the sources differ most. A
GIF, or an MP4 with the extra [video].""",
)
