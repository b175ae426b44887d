"""A scene written out in a library's own words, for somebody who has that library alone."""

from collections.abc import Mapping
from dataclasses import dataclass, field

from engines.world import Moment


@dataclass(frozen=True, slots=True, kw_only=True)
class Script:
    """What an engine's declaration writes of a scene: Python for the library, without this project.

    The lines are put into a script that shakes the base, watches for the largest rotation and ends
    the run, the same for all engines.

    Attributes
    ----------
    imports : tuple of str
        Lines that import the library.
    settings : tuple of str
        What the preset sets, in the library's words, a line each: calls with their numbers, or
        parts of a model. They are what a reader would copy.
    build : tuple of str
        Lines that build the scene, the settings among them where they are calls; `HERE` is the
        folder of the script, a Path.
    step : tuple of str
        Lines that take a step of `DT` [s] under the gravity `pull_x` and `pull_z` [m/s2].
    pose : tuple of str
        Lines that read `theta` [rad] and `rate` [rad/s].
    moment : Moment
        At which moment of a step the velocity holds.
    files : mapping
        Name -> text of what lies beside the script.
    """

    imports: tuple[str, ...]
    settings: tuple[str, ...]
    build: tuple[str, ...]
    step: tuple[str, ...]
    pose: tuple[str, ...]
    moment: Moment = Moment.MIDDLE
    files: Mapping[str, str] = field(default_factory=dict)
