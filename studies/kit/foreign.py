"""Engines of other packages, known where their code is not loaded: a process declares each as data.

What code does when it is imported ends, stops or silences the process that imports it: that is one
of its own, and never the one that judges, which ends with its own exit code.
"""

import copyreg
import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, field, fields, make_dataclass, replace
from importlib import import_module
from operator import attrgetter
from pathlib import Path
from types import MappingProxyType
from typing import Any

from engines import ENGINES, registry
from engines.declaration import Engine, Preset
from engines.parts.settings import check
from engines.registry import UnloadableError
from studies.kit.workers import Lost, answers

# the settings of a scene are one
copyreg.dispatch_table[MappingProxyType] = lambda it: (dict, (dict(it),))

PACKAGES = ("analytic", "engines", "studies")
LOADING_S = 60.0
"""How long an engine of another package may take to be loaded [s]."""


@contextmanager
def kept_out() -> Iterator[None]:
    """Load no code of other packages in this process: each engine is declared by another one."""
    registry.elsewhere = lambda name: apart(_declared_here, name)
    try:
        yield
    finally:
        registry.elsewhere = None


def apart(call: Callable[..., Any], engine: str, *given: Any) -> Any:
    """Return what a function answers, of an engine, in a process of its own.

    UnloadableError if it raises, or its process ends or takes longer than `LOADING_S`.
    """
    ((_, answer),) = answers(_tried, [(call, engine, *given)], 1, LOADING_S)
    if isinstance(answer, Lost):
        raise UnloadableError(f"engine {engine!r} cannot be loaded: {answer.why}")
    found, problem = answer
    if problem:
        raise UnloadableError(problem)
    return found


def _tried(call: Callable[..., Any], *given: Any) -> tuple[Any, str]:
    try:
        return call(*given), ""
    except ValueError as error:
        return None, str(error)


@dataclass(frozen=True)
class Call:
    """What an engine declares by some name and can be called, in a process of its own."""

    engine: str
    name: str
    files: tuple[Path, ...]  # in which its code stands

    def __call__(self, *given: Any) -> Any:
        """Call it; UnloadableError as of `apart`."""
        return apart(_called_here, self.engine, self.name, *given)


def _called_here(engine: str, name: str, *given: Any) -> Any:
    call = getattr(registry.loaded(engine), name)
    return call(*(item.loaded() if hasattr(item, "loaded") else item for item in given))


def _declared_here(name: str) -> Engine:
    """Return an engine as plain data."""
    engine = ENGINES[name]
    tops = {_top(what) for what in (engine.build, *engine.builders.values())} - {*PACKAGES}
    loaded = [module for of, module in list(sys.modules.items()) if of.partition(".")[0] in tops]
    places = [getattr(module, "__file__", None) for module in loaded]
    files = tuple(sorted(Path(file) for file in places if isinstance(file, str)))

    def call(name: str = "") -> Call:
        return Call(engine.name, name, files)

    def preset(it: Preset) -> Preset:
        builders = {key: call() for key in it.builders}
        return replace(it, settings=_settings(it.settings), builders=builders)

    return replace(
        engine,
        build=call("build"),
        script=engine.script and call("script"),
        spring=engine.spring and call("spring"),
        builders={key: call() for key in engine.builders},
        own_step="",  # it would be imported
        presets=tuple(map(preset, engine.presets)),
    )


def _top(what: Any) -> str:
    return str(getattr(what, "__module__", type(what).__module__)).partition(".")[0]


def _settings(settings: Any) -> Any:
    """Return settings, those of a class that this project does not have as `alike`."""
    kind = type(settings)
    if kind.__module__.partition(".")[0] in PACKAGES:
        return settings
    described = []
    for item in fields(settings):
        default = None if item.default is MISSING else item.default
        value = getattr(settings, item.name)
        described.append((item.name, default, item.metadata.get("allowed"), value))
    return alike(kind.__module__, kind.__qualname__, described)


def alike(module: str, name: str, described: list[tuple[str, Any, Any, Any]]) -> Any:
    """Return settings that are called, and checked, as those of a class that is not loaded here.

    Each is described by its name, its default, its `engines.parts.settings.Allowed`, and its value.
    """
    items = [
        (item, Any, field(default=default, metadata={"allowed": allowed} if allowed else {}))
        for item, default, allowed, _ in described
    ]

    def again(it: Any) -> tuple[Any, ...]:
        return alike, (module, name, [(*row[:3], getattr(it, row[0])) for row in described])

    does = {
        "__post_init__": check,
        "__reduce__": again,
        "loaded": lambda it: attrgetter(name)(import_module(module))(**vars(it)),
    }
    made = make_dataclass(name, items, namespace=does, frozen=True, kw_only=True)
    made.__module__, made.__qualname__ = module, name
    return made(**{item: value for item, _, _, value in described})
