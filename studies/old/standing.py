"""From the options of a command line to what stands on the base."""

from collections.abc import Iterable
from dataclasses import dataclass
from itertools import chain
from typing import Annotated, Literal

from cyclopts import Parameter

from analytic.block import RigidBlock
from analytic.frame import RockingFrame
from analytic.slide import SlidingBlock
from engines.layouts import System
from studies.old.arguments import (
    BadInputError,
    Count,
    Positive,
    as_bad_input,
    one_of,
    refuse_given,
    required,
)
from studies.old.posing import Excitation, Posed

MOST_M = 200.0
"""Size [m] up to which a block may be one; 300 are a narrow cabinet in millimetres."""

LEAST_COLUMNS = 2
"""Of a frame."""

OF_A_SCENE = {
    "frame": ("columns", "load"),
}
"""Scene -> the options that are its own."""

Width = Annotated[Positive, Parameter(help="Full width B of the block or of each column [m].")]
Height = Annotated[Positive, Parameter(help="Full height H of the block or of each column [m].")]

SceneName = Literal["block", "frame", "slide"]


def posed_block(width: float, height: float) -> RigidBlock:
    """Return the block of --width and --height.

    Parameters
    ----------
    width, height : float
        Full sizes [m], positive and at most MOST_M.

    Raises
    ------
    BadInputError
        If one is not allowed; one that was meant in millimetres is asked about.
    """
    for name, size in (("width", width), ("height", height)):
        if size > MOST_M:
            meant = f"{size:g} m? In metres: --{name} {1e-3 * size:g} for {size:g} mm"
            raise BadInputError(f"--{name} is {size:g}; it must be at most {MOST_M:g} m; {meant}")
    with as_bad_input():
        return RigidBlock(width=width, height=height)


@Parameter(name="*")
@dataclass(frozen=True, slots=True, kw_only=True)
class Standing:
    """What stands on the base.

    Attributes
    ----------
    scene
        block: one block that rocks. frame: a beam on columns that rock, of --width and --height
        each, with --load. slide: one block that slides, by a --friction below B/H.
    columns
        Of a frame, from 2 to 100.
    load
        Of a frame: the mass of its beam over that of all columns.
    """

    scene: Annotated[SceneName, one_of(SceneName)] = "block"
    columns: Count | None = None
    load: Positive | None = None

    def system(self, width: float, height: float, friction: float | None) -> System:
        """Return the system that the options mean.

        Parameters
        ----------
        width, height : float
            Full sizes of the block or of each column [m].
        friction : float or None
            Coefficient between base and a block that slides; other systems have none.

        Raises
        ------
        BadInputError
            If an option is missing, contradicts the scene, or has a value that is not allowed.
        """
        self._refuse_others()
        block = posed_block(width, height)
        sizes = {"width": width, "height": height}
        with as_bad_input():
            if self.scene == "frame":
                words = "a frame requires the mass of its beam, over that of all columns"
                (load,) = required(words, load=self.load)
                return RockingFrame(**sizes, columns=self.columns or LEAST_COLUMNS, load=load)
            if self.scene == "slide":
                words = "a block that slides requires one below B/H"
                (friction,) = required(words, friction=friction)
                return SlidingBlock(**sizes, friction=friction)
            if self.scene == "block":
                return block
        raise BadInputError(f"--scene is {self.scene!r}; it must be another one here")

    def refuse(self, allowed: str) -> None:
        """Raise BadInputError if an option was given a value, which is allowed otherwise."""
        scene = None if self.scene == ONE_BLOCK.scene else self.scene
        own = self._given(chain.from_iterable(OF_A_SCENE.values()))
        refuse_given({"scene": scene, **own}, allowed)

    def _refuse_others(self) -> None:
        for scene, names in OF_A_SCENE.items():
            if scene != self.scene:
                refuse_given(self._given(names), f"only with --scene {scene}")

    def _given(self, names: Iterable[str]) -> dict[str, object]:
        return {name.replace("_", "-"): getattr(self, name) for name in names}

    @property
    def rocks(self) -> bool:
        """Whether it is told by a rotation, and may begin with one."""
        return self.scene != "slide"

    def pose(self, system: System, excitation: Excitation) -> Posed:
        """Return the motion and the start that options mean for the system.

        Raises
        ------
        BadInputError
            As of `Excitation.pose`, or if something is tilted that does not rock.
        """
        if not self.rocks:
            refuse_given({"tilt": excitation.tilt, "rate": excitation.rate}, WHERE_IT_ROCKS)
        return excitation.pose(system)


WHERE_IT_ROCKS = "only where something rocks"
"""Of options of a rotation."""

ONE_BLOCK = Standing()
"""One block."""
