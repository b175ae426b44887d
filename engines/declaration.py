"""What an engine says of itself: what it can do, how it is used, and what each use is helped by."""

import enum
import importlib.util
import math
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Any, NamedTuple

from engines.factors import Factor
from engines.scene import ACCURACIES, FRAMES, Scene
from engines.settings import one_of
from engines.world import REST_FACTOR, ROUNDINGS, Resolution, Script, World


class Help(enum.Enum):
    """What an adapter does for a preset, besides setting the engine once."""

    STEPS = "steps that land on impacts, uplifts and the corners of the motion"
    PHASES = "a contact that holds as firmly as each phase of the motion needs"
    REFLECTION = "the pivot's velocity given back while the block turns about it"
    MARGIN = "the pivot kept in contact over the gap by which it rises in a step"
    PRELOAD = "the pivot pressed by its load from the start of a step"
    POSITIONS = "positions moved by the adapter, from the engine's velocities"


class Citation(NamedTuple):
    """Where documentation says what a preset sets: a page, a file or a header, and the version."""

    setting: str
    value: str
    where: str


def citations(table: str) -> tuple[Citation, ...]:
    """Read "setting | value | where", one a line; a line that begins with blanks goes on."""
    rows = re.split(r"\n(?! )", table.strip("\n"))
    return tuple(Citation(*" ".join(row.split()).split(" | ")) for row in rows)


Builder = Callable[[Scene, Any, float], World]
"""``(scene, settings, dt_s)`` -> the built scene, in the ordinary steps dt_s [s]."""


class Stepping(enum.Enum):
    """Who chooses the steps of a preset."""

    FIXED = "equal steps"
    LANDING = "steps that land on impacts"
    OWN = "the engine's own steps, by its own estimate of the error"


class Precision(enum.Enum):
    """The numbers that an engine computes with; the value is their relative rounding."""

    DOUBLE = 2.0**-53
    SINGLE = 2.0**-24


AT_REST = "default-at-rest"
"""The library as it is documented, but for its floor: that is at rest, and gravity aimed anew."""

RECOMMENDED = "recommended"
"""The library as its documentation, or who maintains it, recommends it for accurate contact."""

PASTED = "pasted"
"""The library's own ways, but for a few lines to paste: a free body in space on a floor at rest."""

UNTUNED = ("default", AT_REST, RECOMMENDED, PASTED)
"""Names of the presets that are the library's own, or nearly."""

REST_S = 0.2
"""For so long [s] the ground is at rest in these before the motion, in equal steps: a body just put
down carries no load yet. A block that begins leaning or moving is let go at once."""

TITLES = {
    "default": "as its documentation shows it",
    AT_REST: "the same on a base at rest",
    RECOMMENDED: "as its documentation recommends for stiff contact",
    PASTED: "a few lines to paste, for a body of one's own",
    "tuned": "best at a fixed step",
    "landing": "steps that land on impacts",
}
"""Name of a preset -> what a reader is told it is."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Preset:
    """One way to use an engine.

    Attributes
    ----------
    name, title : "default" (as documented), "tuned", ...; what a reader is told if not `TITLES`
    settings : the engine's settings class, one of whose fields is "friction"
    stepping : who chooses the steps
    step, step_s : p dt of equal steps, or the library's own [s]
    documented : what the documentation sets of "default" and "recommended", and where it says so;
        of "pasted" where each line is from
    frame : one of `FRAMES`, where a scene does not say
    accuracy_knob : the setting that trades time for accuracy where that is not the step, and its
        values from cheap to dear
    helped_by : what helps -> the settings that leave it out; None where it is the preset itself
    stacked : settings in place of some of these where bodies rest on others; None where none can
    sliding : settings in place of some of these where nothing rocks
    stacks : builds a scene of bodies that rest on others, in place of the engine's build
    rest_s : for how long the ground is at rest before the motion [s], where it is not `REST_S`
    own : of "default", settings that are not the library's own -> what it has by itself
    """

    name: str
    title: str = ""
    settings: Any
    stepping: Stepping = Stepping.FIXED
    step: float = math.nan
    step_s: float = math.nan
    documented: tuple[Citation, ...] = ()
    frame: str = "base"
    accuracy_knob: tuple[str, tuple[float, ...]] | None = None
    helped_by: Mapping[Help, Mapping[str, Any] | None] = field(default_factory=dict)
    stacked: Mapping[str, Any] | None = field(default_factory=dict)
    sliding: Mapping[str, Any] = field(default_factory=dict)
    stacks: Builder | None = None
    rest_s: float | None = None
    own: Mapping[str, Any] = field(default_factory=dict)

    def __post_init__(self) -> None:
        object.__setattr__(self, "title", self.title or TITLES.get(self.name, self.name))
        if self.rest_s is None:
            rests = self.name in UNTUNED and self.stepping is Stepping.FIXED
            object.__setattr__(self, "rest_s", REST_S if rests else 0.0)
        given = sum(map(math.isfinite, (self.step, self.step_s)))
        if given != (self.stepping is Stepping.FIXED):
            raise ValueError(
                f"step, step_s of preset {self.name!r} are {self.step!r}, {self.step_s!r}; "
                "equal steps need one of them, other steps none"
            )

    def at_rest(self) -> "Preset":
        """Return the same on a base at rest, of which no documentation speaks."""
        return self._changed(AT_REST, (), {}, frame="base")

    def recommended(
        self, *documented: Citation, step_s: float | None = None, **settings: Any
    ) -> "Preset":
        """Return the same with what is recommended, and where it is."""
        return self._changed(RECOMMENDED, documented, settings, step_s=step_s or self.step_s)

    def pasted(self, *documented: Citation, **settings: Any) -> "Preset":
        """Return the same with a few lines to paste, on a base at rest at a friction of 0.8."""
        rough = {"friction": 0.8, **settings}
        return self._changed(PASTED, documented, rough, frame="base", own={})

    def _changed(
        self, name: str, documented: tuple[Citation, ...], settings: Mapping[str, Any], **own: Any
    ) -> "Preset":
        changed = replace(self.settings, **settings)
        return replace(self, name=name, title="", settings=changed, documented=documented, **own)

    def takes(self, **settings: Any) -> bool:
        """Return whether its settings can be changed so."""
        try:
            replace(self.settings, **settings)
        except (TypeError, ValueError):
            return False
        return True

    def ordinary_step(self, accuracy: str = "standard") -> float:
        """Return the ordinary p dt, or that between two looks; nan where it is in seconds."""
        return self.step if self.stepping is Stepping.FIXED else 1.0 / ACCURACIES[accuracy]


def default(settings: Any, step_s: float, documented: tuple[Citation, ...], **own: float) -> Preset:
    """Return a library as its documentation shows it, and its own settings where others are."""
    said: dict[str, Any] = {"documented": documented, "own": own}
    return Preset(name="default", settings=settings, step_s=step_s, frame="world", **said)


def landing(
    settings: Any, helped_by: Mapping[Help, Mapping[str, Any]] | None = None, **options: Any
) -> Preset:
    """Return steps that land, and what helps besides; options are of `Preset`."""
    options["helped_by"] = {Help.STEPS: None, **(helped_by or {})}
    return Preset(name="landing", settings=settings, stepping=Stepping.LANDING, **options)


@dataclass(frozen=True, slots=True, kw_only=True)
class Engine:
    """A physics engine: its name, what it can do, how it is used.

    Attributes
    ----------
    name, title : what a user types, and what a reader sees
    library, packages, install : the module to import, the distributions whose versions decide its
        numbers, by default of its name, and what pip is told to install, by default our extra
    build : builds a scene; only this and `Preset.stacks` may import the library, when called
    presets : from the library's own to the best there is, which the engine's plain name means
    core : whether the published studies ask it by default
    frames : those of `FRAMES` that it has
    stacks : whether it can hold several bodies, and bodies that rest on others
    offsets : whether its block can have a mass that is not spread evenly
    lifts : ways to move its base, as its setting `floor` names them, that move it vertically too
    precision : of its numbers
    shortest_step : p dt below which a step has no effect that is resolved
    rest_factor : up to how many ordinary steps long one of a block at rest may be; 1 where how the
        block lies depends on the step
    script : a scene in the library's own words; without it none is exported or quoted
    factors : what its contact can be set to
    compiles : whether library or adapter is compiled when first used on a machine: once before a
        study's cases, outside their time limit
    """

    name: str
    title: str
    library: str
    packages: tuple[str, ...] = None  # type: ignore[assignment]  # names once it is made
    install: str = ""
    build: Builder
    presets: tuple[Preset, ...]
    core: bool = False
    frames: tuple[str, ...] = FRAMES
    stacks: bool = False
    offsets: bool = False
    lifts: tuple[str, ...] = ()
    precision: Precision = Precision.DOUBLE
    shortest_step: float = 1e-12
    rest_factor: float = REST_FACTOR
    script: Callable[[Scene, Any, float], Script] | None = None
    factors: tuple[Factor, ...] = ()
    compiles: bool = False

    def __post_init__(self) -> None:
        if self.packages is None:
            object.__setattr__(self, "packages", (self.library,))
        object.__setattr__(self, "install", self.install or f"rocking[{self.name}]")

    @property
    def best(self) -> Preset:
        """The preset for which the plain name stands."""
        return self.presets[-1]

    @property
    def installed(self) -> bool:
        """Whether its library is there."""
        return importlib.util.find_spec(self.library) is not None

    def preset(self, name: str | None) -> Preset:
        """Return the preset of a name, the best for None; ValueError if there is none."""
        if name is None:
            return self.best
        one_of(f"preset of {self.name}", name, [preset.name for preset in self.presets])
        return next(preset for preset in self.presets if preset.name == name)

    def use(self, scene: Scene) -> "Use":
        """Return how it is used for a scene; ValueError if a preset or setting is not its own."""
        presets = self.presets[::-1] if scene.preset is None else (self.preset(scene.preset),)
        lacking = [self._lacks(scene, each) for each in presets]
        best = lacking.index("") if "" in lacking else 0
        preset = presets[best]
        names = [item.name for item in fields(preset.settings)]
        for name in scene.settings:
            one_of("setting", name, names)
        other = preset.stacked if scene.stacked else {} if scene.layout.rocking else preset.sliding
        given = {} if scene.friction is None else {"friction": scene.friction}
        if scene.step is not None:
            dt_s = scene.step / scene.system.p
        elif preset.stepping is not Stepping.FIXED:
            dt_s = 1.0 / (ACCURACIES[scene.accuracy] * scene.system.p)
        else:
            dt_s = preset.step / scene.system.p if math.isnan(preset.step_s) else preset.step_s
        rest_s = scene.rest_s
        if rest_s is None:
            rest_s = preset.rest_s if scene.begins_at_rest else 0.0
        return Use(
            self,
            preset,
            replace(scene, frame=scene.frame or preset.frame, rest_s=rest_s),
            replace(preset.settings, **{**(other or {}), **scene.settings, **given}),
            dt_s,
            lacking[best],
        )

    def _lacks(self, scene: Scene, preset: Preset) -> str:
        """Say what of a scene it cannot do with a preset, or return an empty string."""
        layout, lands = scene.layout, preset.stepping is Stepping.LANDING
        stacked, built = len(layout.bodies) > 1, "is not built here for"
        uneven, frame = not layout.bodies[0].is_homogeneous, scene.frame or preset.frame
        own = f"{self.name}:{preset.name}"
        way = scene.settings.get("floor", getattr(preset.settings, "floor", ""))
        lacking = {
            f"{self.title} {built} {STACKED}": stacked and not self.stacks,
            f"{self.title} {built} {UNEVEN}": uneven and not self.offsets,
            f"nothing rocks here on whose impacts {own} could land": lands and not layout.rocking,
            "only equal steps can begin before the motion": (
                scene.rest_s and preset.stepping is not Stepping.FIXED
            ),
            f"{own} {built} {UNEVEN}": uneven and lands,
            f"{own} {built} {HEAVING}": scene.heaves and lands,
            f"{own} {built} {HEAVING}; presets on a base at rest are": (
                scene.heaves and frame == "world" and way not in self.lifts
            ),
            f"{own} {built} {STACKED}": stacked and preset.stacked is None,
            f"{self.title} has no frame {frame!r}": frame not in self.frames,
        }
        return next((words for words, lacks in lacking.items() if lacks), "")


STACKED = "bodies that rest on other bodies"
UNEVEN = "a block whose mass is not spread evenly"
HEAVING = "a base that moves vertically"


@dataclass(frozen=True, slots=True)
class Use:
    """How an engine is used for a scene, resolved once; dt_s is the ordinary step [s]."""

    engine: Engine
    preset: Preset
    scene: Scene
    settings: Any
    dt_s: float
    lacking: str = ""

    @property
    def build(self) -> Builder:
        """What builds the scene."""
        return (self.preset.stacks if self.scene.stacked else None) or self.engine.build

    @property
    def resolution(self) -> Resolution:
        """What the engine's numbers tell apart about the system."""
        system, part = self.scene.system, ROUNDINGS * self.engine.precision.value
        shortest = self.engine.shortest_step / system.p
        return Resolution(part * system.height, shortest, part, self.engine.rest_factor)
