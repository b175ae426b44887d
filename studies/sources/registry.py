"""Who answers: the models, the paper's solvers and the engines, each by its name."""

import inspect
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, fields, replace
from functools import partial
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from analytic import MODELS, Response, RigidBlock, SlidingBlock, integrate, simulate
from analytic.motion import BothWays, Motion
from engines import ENGINES, core_engines, installed_engines
from engines.declaration import Engine, Preset, Stepping
from engines.registry import FURTHER, named
from engines.registry import announce as announce_engine
from engines.scene import Scene, System
from engines.settings import one_of, perhaps
from studies.sources.scipy_peers import solve_ivp_response

Kind = Literal["model", "solver", "peer", "engine"]
"""Models, solvers and peers (general-purpose integrators) do not crash; an engine may."""

NOT_OPTIONS = frozenset({"block", "system", "motion", "model", "method", "preset", "times"})
"""What is asked and who, beside which an option is a question of how."""


class UnknownSourceError(ValueError):
    """A source or preset that does not exist."""


@dataclass(frozen=True, slots=True)
class Source:
    """Who answers a question; it can be sent to another process or machine."""

    kind: Kind
    call: Callable[..., Response]  # (block, motion, *, duration, times, **options)
    engine: str = ""
    preset: str = ""  # by default that of the best there is
    stepping: bool = False  # whether it has an option `step`, p dt
    name: str = ""  # by which it was asked for

    def check(self, block: System, motion: Motion, **options: Any) -> None:
        """Refuse what it cannot be asked, before it is, by a TypeError or ValueError."""
        if isinstance(block, SlidingBlock) and not self.engine and self.name != "exact":
            raise ValueError(f"{self.name} solves what rocks, and this block slides")
        if isinstance(block, RigidBlock) and not (
            block.is_even or self.engine or self.kind == "model"
        ):
            raise ValueError(f"{self.name} takes no block with an offset; models and engines do")
        if isinstance(motion, BothWays) and not self.engine and self.name != "exact":
            raise ValueError(f"{self.name} takes no vertical motion; exact and engines do")
        if getattr(self.call, "func", None) is run_engine:
            self.declared.use(scene_of(block, motion, self.preset, **options))
            return
        taken = inspect.signature(self.call).parameters
        if all(item.kind is not item.VAR_KEYWORD for item in taken.values()):
            for name in options.keys() - {"duration", "times"}:
                one_of("option", name, [name for name in taken if name not in NOT_OPTIONS])

    @property
    def declared(self) -> Engine:
        """What the engine says of itself; KeyError for other sources."""
        return ENGINES[self.engine]

    @property
    def used(self) -> Preset:
        """How the engine is used; KeyError for other sources."""
        return self.declared.preset(self.preset)

    @property
    def lands(self) -> bool:
        """Whether it is an engine whose steps land on impacts."""
        return bool(self.engine) and self.used.stepping is Stepping.LANDING

    @property
    def accurate(self) -> bool:
        """Whether it is an engine whose steps are not all equal."""
        return bool(self.engine) and self.used.stepping is not Stepping.FIXED


def run_engine(
    block: System, motion: Motion, *, engine: str, preset: str | None, **options: Any
) -> Response:
    """Build the scene, as `scene_of` does, and let the engine run it."""
    from engines.run.run import run

    scene = scene_of(block, motion, preset, **options)
    return run(ENGINES[engine].use(scene))


def scene_of(
    block: System,
    motion: Motion,
    preset: str | None,
    *,
    times: ArrayLike | None = None,
    **options: Any,
) -> Scene:
    """Return the scene that an engine is asked about, with other options of `Scene` by name."""
    allowed = [item.name for item in fields(Scene) if item.name not in NOT_OPTIONS]
    for name in options:
        one_of("option", name, allowed)
    sampled = None if times is None else np.asarray(times, dtype=np.float64).tolist()
    return Scene(system=block, motion=motion, preset=preset, times=sampled, **options)


def _engine(name: str, preset: str) -> Source:
    call = partial(run_engine, engine=name, preset=None)  # the best that a scene allows
    return Source("engine", call, name, preset, stepping=True)


SOURCES: dict[str, Source] = {
    **{name: Source("model", partial(simulate, model=name)) for name in MODELS},
    **{
        name: Source("solver", partial(integrate, method=name), stepping=True)
        for name in ("rk4", "average-acceleration")
    },
    **{
        name.lower(): Source("peer", partial(solve_ivp_response, method=name))
        for name in ("RK45", "DOP853", "Radau", "LSODA")
    },
    **{name: _engine(name, ENGINES[name].best.name) for name in ENGINES},
}
"""Every source; a new model or engine appears here by being registered in its own storey."""


def announce(place: str, name_of: Callable[[str], str] = named) -> str:
    """Make an engine a source that no package announces; see `engines.registry.announce`."""
    name = announce_engine(place, name_of)
    SOURCES[name] = _engine(name, ENGINES[name].best.name)
    return name


def resolve(name: str) -> Source:
    """Return the source called `name`, which may be an engine with a preset after a colon."""
    plain, colon, preset = name.partition(":")
    source = SOURCES.get(plain)
    if source is None:
        near = perhaps(plain, list(SOURCES))
        own = f"; your own: {FURTHER}='mine={name}'" if colon and not near else ""
        raise UnknownSourceError(f"source is {name!r}{near}; it must be one of {allowed()}{own}")
    if colon and preset not in presets_of(source):
        able = [f"{plain}:{own}" for own in presets_of(source)]
        words = f"one of {', '.join(able)}" if able else f"{plain!r}, for only engines have presets"
        raise UnknownSourceError(f"source is {name!r}{perhaps(name, able)}; it must be {words}")
    if not colon:
        return replace(source, name=name)
    call = partial(source.call, preset=preset)
    return replace(source, call=call, preset=preset, name=name)


def presets_of(source: Source) -> list[str]:
    """Return the names of an engine's presets; none of other sources."""
    return [preset.name for preset in ENGINES[source.engine].presets] if source.engine else []


def all_presets() -> list[str]:
    """Return the names of presets that some engine has."""
    return list(dict.fromkeys(name for source in SOURCES.values() for name in presets_of(source)))


def allowed() -> str:
    """Return the sentence that lists the sources and presets."""
    presets = ", ".join(all_presets())
    return f"{', '.join(SOURCES)}; an engine takes a preset after a colon: {presets}"


Accuracy = Literal["loose", "standard", "tight"]
"""Of an engine whose steps land on impacts; `engines.scene.ACCURACIES` says how many steps."""

GROUPS = {"core": core_engines, "engines": installed_engines}
"""Word -> the names of the engines for which it stands."""


def core_sources(*presets: str) -> tuple[str, ...]:
    """Return the core engines by name, each with some presets; "" is its best."""
    return tuple(
        f"{name}:{preset}" if preset else name
        for name in core_engines()
        for preset in presets or ("",)
    )


def expanded(names: Iterable[str]) -> Iterator[str]:
    """Yield the names with those of engines in place of a group's; "engines:tuned" has a preset."""
    # engines without that preset are left out, unless none has it; so are repeats of another group
    had: set[tuple[str, str]] = set()
    for name in names:
        group, colon, preset = name.partition(":")
        if group not in GROUPS:
            yield name
            continue
        engines = GROUPS[group]()
        having = [e for e in engines if not colon or preset in presets_of(resolve(e))]
        for engine in having or engines:
            use = engine, preset or resolve(engine).preset
            if use not in had:
                yield f"{engine}{colon}{preset}"
            had.add(use)
