"""Engines that declare a `Moment` which is not theirs, one in each class."""

import my_engine
import rocking_moreau

from engines.registry import PlainSettings
from engines.world import Moment


class Middle(my_engine.World):
    moment = Moment.MIDDLE


class End(my_engine.World):
    moment = Moment.END


class Moreau(rocking_moreau.MoreauWorld):
    """Its own is END."""

    moment = Moment.MIDDLE

    def __init__(self, scene, settings: PlainSettings, dt_s):
        tuned = rocking_moreau.MoreauSettings(friction=settings.friction, closing=True)
        super().__init__(scene, tuned, dt_s)
