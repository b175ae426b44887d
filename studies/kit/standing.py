"""What stands on the base, from the options of a command line: one scene of several."""

from dataclasses import dataclass
from typing import Annotated, Literal

from cyclopts import Parameter

from analytic.frame import RockingFrame
from analytic.slide import SlidingBlock
from engines.layouts import System
from studies.kit.arguments import BadInputError, Count, Positive, as_bad_input, one_of, refuse_given
from studies.kit.posing import posed_block

SceneName = Literal["block", "frame", "slide"]

LEAST_COLUMNS = 2


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
        Of a frame, 2 or more.
    load
        Of a frame: the mass of its beam over that of all columns.
    """

    scene: Annotated[SceneName, one_of(SceneName)] = "block"
    columns: Count | None = None
    load: Positive | None = None

    def system(self, width: float, height: float, friction: float | None) -> System:
        """Return the system of these sizes [m].

        Raises
        ------
        BadInputError
            If an option is missing, contradicts the scene, or has a value that is not allowed.
        """
        if self.scene != "frame":
            refuse_given({"columns": self.columns, "load": self.load}, "only with --scene frame")
        block = posed_block(width, height)
        with as_bad_input():
            if self.scene == "frame":
                return self._frame(width, height)
            if self.scene == "slide":
                return _slide(width, height, friction)
            return block

    def _frame(self, width: float, height: float) -> RockingFrame:
        if self.load is None:
            raise BadInputError(
                "--load missing; a frame requires the mass of its beam, over that of all columns"
            )
        columns = LEAST_COLUMNS if self.columns is None else self.columns
        return RockingFrame(width=width, height=height, columns=columns, load=self.load)


def _slide(width: float, height: float, friction: float | None) -> SlidingBlock:
    if friction is None:
        raise BadInputError("--friction missing; a block that slides requires one below B/H")
    return SlidingBlock(width=width, height=height, friction=friction)


ONE_BLOCK = Standing()
"""One block."""
