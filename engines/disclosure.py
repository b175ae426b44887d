"""What a reader is told of a preset: what helps it, what it gets wrong, where it is documented."""

import enum
from typing import NamedTuple


class Help(enum.Enum):
    """What an adapter does for a preset, besides setting the engine once."""

    STEPS = "steps that land on impacts, uplifts and the corners of the motion"
    PHASES = "a contact that holds as firmly as each phase of the motion needs"
    REFLECTION = "the pivot's velocity given back while the block turns about it"
    MARGIN = "the pivot kept in contact over the gap by which it rises in a step"
    PRELOAD = "the pivot pressed by its load from the start of a step"
    POSITIONS = "positions moved by the adapter, from the engine's velocities"


class Deviation(enum.Enum):
    """What an engine gets wrong with its defaults, without a word."""

    MIRROR = "shaken the other way, the block does not answer the other way"
    PEAK = "on one of the paper's histories another outcome, or a peak off by more than 0.3"
    SLEEP = "a block that stood still for two seconds sleeps on while it is shaken"
    RECORD = "under an accelerogram the rotation is off by more than 0.6 of its peak"


class Citation(NamedTuple):
    """Where documentation says what a preset sets: a page, a file or a header, and the version."""

    setting: str
    value: str
    where: str
