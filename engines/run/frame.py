"""What a frame shows beside its columns: they turn together, and the beam rides without turning.

See EQUATIONS.md, "The rocking frame".
"""

from collections.abc import Mapping
from dataclasses import dataclass

from engines.scene import Layout
from engines.world import FloatArray


@dataclass(slots=True)
class Spread:
    """How far the bodies of a frame came apart.

    Attributes
    ----------
    columns : how many there are, and the number of the beam's row; 0 where there is no beam
    homes : where the beam's centre is while a column's is at 0 [m]
    parting, tilt : largest difference of two columns' rotations, largest one of the beam [rad]
    drift, slide : how far it slid along the tops [m] at most, at all and until they pass alpha
    """

    columns: int = 0
    homes: float = 0.0
    parting: float = 0.0
    tilt: float = 0.0
    drift: float = 0.0
    slide: float = 0.0


def begin_spread(layout: Layout) -> Spread:
    """Return where nothing has parted; the body after those that rock is a beam."""
    if not 0 < layout.rocking < len(layout.bodies):
        return Spread()
    beam, first = layout.bodies[layout.rocking], layout.bodies[0]
    return Spread(columns=layout.rocking, homes=beam.home[0] - 2.0 * first.home[0])


def see_spread(spread: Spread, state: FloatArray, alpha: float) -> None:
    """Take in a state (bodies, 4), a `Pose` a row, of columns of the slenderness alpha [rad]."""
    columns = spread.columns
    if columns == 0:
        return
    for column in range(1, columns):
        spread.parting = max(spread.parting, abs(state[column][2] - state[0][2]))
    spread.tilt = max(spread.tilt, abs(state[columns][2]))
    # a corner on top of a column moves twice as far as the column's centre
    slid = state[columns][0] - 2.0 * state[0][0] - spread.homes
    spread.drift = max(spread.drift, abs(slid))
    if abs(state[0][2]) <= alpha:
        spread.slide = max(spread.slide, abs(slid))


def observables_of(spread: Spread, alpha: float) -> Mapping[str, float]:
    """Return parting and tilt over alpha, and drift_m [m]; nothing where there is no beam."""
    if not spread.columns:
        return {}
    return {
        "parting": float(spread.parting) / alpha,
        "tilt": float(spread.tilt) / alpha,
        "drift_m": float(spread.drift),
    }
