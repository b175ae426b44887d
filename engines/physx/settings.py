"""What PhysX can be set to: its settings, the tuned ones, and what the studies try of them."""

from dataclasses import dataclass

from engines.parts.settings import check, setting
from engines.parts.shapes import NO_JAM
from engines.parts.units import Counted


@dataclass(frozen=True, slots=True, kw_only=True)
class PhysxSettings(Counted):
    """Settings of PhysX, by default those of SAPIEN; None leaves a setting to it.

    """

    geometry: str = setting("box", names=("box", "corners"))
    planar: bool = False
    locked_aside: bool = False
    friction: float = setting(1.0, least=0.0)
    tgs: bool | None = None
    pcm: bool | None = None
    iterations: int | None = setting(least=1, most=255)
    velocity_iterations: int | None = setting(least=0, most=255)
    bounce_threshold: float | None = setting(above=0.0)
    sleeping: bool | None = None
    angular_damping: float | None = setting(least=0.0)
    contact_offset: float | None = setting(above=0.0)
    depenetration: float | None = setting(above=0.0)
    units: float | None = setting(above=0.0)
    centred: bool = False
    base_depth: float = setting(1.0, above=0.0)
    corner_radius: float = setting(1e-3, above=0.0)
    floor: str = setting("target", names=("target", "position"))
    restitution: float = setting(0.0, least=0.0, most=1.0)

    def __post_init__(self) -> None:
        check(self)

    def depenetration_of(self, unit: float) -> float | None:
        """Return the fastest correction of a depth [units/s]; None leaves it to the library."""
        return None if self.depenetration is None else self.depenetration * unit


TUNED = PhysxSettings(
    geometry="box",
    friction=NO_JAM,
    tgs=True,
    iterations=50,
    velocity_iterations=1,
    bounce_threshold=1e-3,
    sleeping=False,
    angular_damping=0.0,
    units=1.0,
    centred=True,
)
