"""Box2D: bodies that rest on others, in steps that land.

The free corners above come into contact with those below in the steps of an impact, and not before
it: the least that one of them comes early, the impact is split in two, and the peak is 20 % off.
Nor does the solver begin with the impulses of the step before: from there it finds columns that
part, whose friction and load would hold, too.
"""

from engines.box2d.build import Box2DWorld
from engines.box2d.settings import Box2DSettings
from engines.parts import imported
from engines.scene import Scene
from engines.world import ContactPhase, Step

DEEPER = 3.0
"""By how many of a pivot's reaches a free corner above is out of reach before an impact."""


class Box2DStacks(Box2DWorld):
    """Columns that a beam rests on by a polygon for each side, whose skin says what touches it."""

    def __init__(self, scene: Scene, settings: Box2DSettings, dt_s: float) -> None:
        super().__init__(scene, settings, dt_s)
        box2d, (*columns, beam) = imported("Box2D"), self._bodies
        self._world.warmStarting = False
        self._skin, (first,) = box2d.b2_polygonRadius, beam.fixtures
        apart = box2d.b2Filter(categoryBits=128, maskBits=64)
        again = box2d.b2PolygonShape(vertices=first.shape.vertices)
        second = beam.CreateFixture(shape=again, friction=first.friction, filter=apart)
        for corner in (fixture for column in columns for fixture in column.fixtures):
            x, z = corner.shape.pos
            if x > 0.0 and z > 0.0:
                corner.filterData = box2d.b2Filter(categoryBits=64, maskBits=128)
        # a column that turns about its corner at +x bears the beam by the one at -x
        self._tops = (1.0, first.shape), (-1.0, second.shape)

    def step(self, step: Step) -> None:
        """Advance by a step."""
        strikes, reach = step.phase is ContactPhase.STRIKE, self._reach
        free = -DEEPER * reach if step.phase is ContactPhase.APPROACH else -reach
        for side, shape in self._tops:
            touches = strikes or step.phase is ContactPhase.REST or step.side in (side, 0.0)
            shape.radius = max(self._skin + (reach if touches else free), 0.0)
        super().step(step._replace(side=0.0) if strikes else step)
