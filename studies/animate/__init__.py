"""A block, a frame or a slide in several sources side by side, as a film."""

from studies.old.study import Study

STUDY = Study(
    name="animate",
    help="""A block, a frame or a slide in several sources, side by side on one clock, as a film.

For one scene and pulse, or for the case of a sweep's results in which the sources differ most. A
GIF, or an MP4 with the extra [video]. The bodies of a frame are drawn as its first column
turns.""",
)
