"""Units of length that suit an engine, and where its heights begin."""

from engines.parts.shapes import Point
from engines.scene import Scene


class Counted:
    """Settings of an engine that need not count lengths in metres from the base.

    In single precision it matters: numbers are told apart by a part of themselves, and a rounding
    of the pivot's height is a velocity in a short step.

    Attributes
    ----------
    units : float or None
        Units of length in the height of the block; None counts in metres.
    centred : bool
        Count heights from where the block's centre is at rest, not from the base.
    """

    __slots__ = ()

    units: float | None
    centred: bool

    def unit_of(self, scene: Scene) -> float:
        """Return the units of length in a metre."""
        return 1.0 if self.units is None else self.units / scene.system.height

    def sunk_of(self, scene: Scene) -> float:
        """Return how far below the origin the base is, in units of length."""
        return 0.5 * scene.system.height * self.unit_of(scene) if self.centred else 0.0


def counted(lengths: Point, unit: float) -> Point:
    """Return lengths in an engine's units.

    Parameters
    ----------
    lengths : (float, float, float), [m]
    unit : float, how many units are in a metre
    """
    x, y, z = lengths
    return x * unit, y * unit, z * unit
