"""What a frame shows beside its columns: they turn together, and the beam rides without turning.

See EQUATIONS.md, "The rocking frame".
"""

from collections.abc import Mapping
from dataclasses import dataclass

from engines.run import watch as seen
from engines.run.watch import Watch, check_slide
from engines.scene import Layout
from engines.world import FloatArray


@dataclass(slots=True)
class Spread:
    """How far the bodies of a frame came apart."""

    # how many there are, and the number of the beam's row; 0 where there is no beam
    columns: int = 0
    homes: float = 0.0  # where the beam's centre is along the base while a column's is at 0 [m]
    level: float = 0.0  # and above it [m]
    # largest difference of two columns' rotations until one passes alpha [rad]
    parting: float = 0.0
    peak: float = 0.0  # largest rotation of the columns until now [rad]
    tilt: float = 0.0  # and of the beam [rad]
    drift: float = 0.0  # how far it slid along the tops at most [m]
    slide: float = 0.0  # and until a column passes alpha [m]


def begin_spread(layout: Layout) -> Spread:
    """Return where nothing has parted; the body after those that rock is a beam."""
    if not 0 < layout.rocking < len(layout.bodies):
        return Spread()
    (x, z), (column_x, column_z) = (layout.bodies[body].home for body in (layout.rocking, 0))
    return Spread(layout.rocking, x - 2.0 * column_x, z - 2.0 * column_z)


def see_spread(spread: Spread, watch: Watch, state: FloatArray) -> None:
    """Take in a state (bodies, 4); parting counts where a column turns further than all before."""
    columns = spread.columns
    if columns == 0:
        return
    least = most = state[0][2]
    for column in range(1, columns):
        least, most = min(least, state[column][2]), max(most, state[column][2])
    spread.tilt = max(spread.tilt, abs(state[columns][2]))
    # a corner on top of a column moves twice as far as the column's centre
    slid = state[columns][0] - 2.0 * state[0][0] - spread.homes
    spread.drift = max(spread.drift, abs(slid))
    turned = max(most, -least)
    if turned <= watch.alpha:
        spread.slide = max(spread.slide, abs(slid))
        spread.parting = max(spread.parting, most - least)
        watch.beam_slide = spread.slide
        if turned > spread.peak:
            spread.peak = turned
            raised = state[columns][1] - 2.0 * state[0][1] - spread.level
            come_apart(spread, watch, raised)


def come_apart(spread: Spread, watch: Watch, raised: float) -> None:
    """See whether the frame is one no longer, its beam so far above the columns' tops [m]."""
    width = 2.0 * watch.half_width
    if spread.parting > seen.PARTED_PART * watch.alpha:
        watch.problem, watch.far = seen.PARTED, spread.parting / watch.alpha
    elif raised > seen.THROWN_WIDTHS * width:
        watch.problem, watch.far = seen.BEAM_THROWN, raised
    else:
        check_slide(watch, spread.slide, seen.BEAM_SLIPPED, seen.BEAM_LOST)


def observables_of(spread: Spread, alpha: float) -> Mapping[str, float]:
    """Return parting and tilt over alpha, and drift_m [m]; nothing where there is no beam."""
    if not spread.columns:
        return {}
    return {
        "parting": float(spread.parting) / alpha,
        "tilt": float(spread.tilt) / alpha,
        "drift_m": float(spread.drift),
    }
