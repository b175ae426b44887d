"""Values that are allowed and unusual: a note of what they would be in another unit."""

import math
from collections.abc import Iterator

from analytic.block import GRAVITY
from analytic.motion import Motion
from analytic.record import Record
from studies.old.posing import Excitation

SMALL_M, LARGE_M = 0.005, 20.0
"""Sizes [m] beyond which a block is unusual."""
STRONG_G = 2.0
"""Amplitude of a pulse [g] from which it is unusual."""
STRONG_RECORD_G = 3.0
"""The same of a record; the strongest ever recorded had some 3 to 4 g."""
SLOW_RAD_S = 1.0
"""Frequency of a pulse [rad/s] below which it is unusual: its period is more than 6 s."""


def unusual(width: float, height: float, given: Excitation, motion: Motion) -> Iterator[str]:
    """Say which values are unusual, and what they are in another unit.

    Parameters
    ----------
    width, height : float
        Full sizes of the block or of each column [m].
    given : Excitation
        What was given of the motion and the start.
    motion : Motion
        What that means; of a `Record` the largest acceleration [m/s2] is looked at.
    """
    for name, size in (("width", width), ("height", height)):
        if size > LARGE_M:
            less = 1e-3 * size
            yield f"--{name} is {size:g} m, large for a block; --{name} {less:g} for as many mm"
        if size < SMALL_M:
            yield f"--{name} is {size:g} m, small for a block"
    if given.amplitude is not None and given.amplitude > STRONG_G:
        less = given.amplitude / GRAVITY
        yield (
            f"--amplitude is {given.amplitude:g} g, strong for a pulse; "
            f"--amplitude {less:.4g} for as many m/s²"
        )
    if given.omega is not None and given.omega < SLOW_RAD_S:
        more = 2.0 * math.pi * given.omega
        yield f"--omega is {given.omega:g} rad/s, slow for a pulse; {more:.4g} for as many Hz"
    if given.tilt is not None and abs(given.tilt) > 1.0 and not given.degrees:
        yield f"--tilt is {given.tilt:g} α, from where a block falls; --degrees for an angle"
    if isinstance(motion, Record) and motion.peak > STRONG_RECORD_G * GRAVITY:
        yield (
            f"--record has {motion.peak / GRAVITY:.3g} g at most, strong for a record; "
            "its header, or --units, says in which unit it is"
        )
