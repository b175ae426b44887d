"""Engines of other packages, known where their code is not loaded: a process declares each as data.

What code does when it is imported ends, stops or silences the process that imports it: that is one
of its own, and never the one that judges, which ends with its own exit code.
"""

import copyreg
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, field, fields, make_dataclass, replace
from importlib import import_module
from operator import attrgetter
from types import MappingProxyType
from typing import Any

from engines import ENGINES, registry
from engines.declaration import Engine
from engines.parts.settings import check
from engines.registry import UnloadableError
from studies.old.fingerprint import PACKAGES, Name, files_elsewhere, names_of
from studies.old.pool import Pool, StartError, TaskError

# the settings of a scene are one
copyreg.dispatch_table[MappingProxyType] = lambda it: (dict, (dict(it),))

LOADING_S = 60.0
"""How long an engine of another package may take to be loaded [s]."""


@contextmanager
def kept_out() -> Iterator[None]:
    """Load no code of other packages in this process: each engine is declared by another one."""
    registry.elsewhere = declared
    try:
        yield
    finally:
        registry.elsewhere = None


def declared(name: str) -> Engine:
    """Return an engine as a process of its own declares it; UnloadableError if it cannot."""
    engine: Engine
    engine, files = apart(_declared_here, name)
    files_elsewhere.update(files)
    return engine


def apart(call: Callable[..., Any], engine: str, *given: Any) -> Any:
    """Return what a function answers, of an engine, in a process of its own.

    Raises
    ------
    UnloadableError
        If it raises, or its process ends or takes longer than `LOADING_S`.
    """
    with Pool(1) as pool:
        try:
            found, problem = pool.schedule(_tried, (call, engine, *given), LOADING_S).result()
        except (TaskError, StartError) as error:
            found, problem = None, f"engine {engine!r} cannot be loaded: {error}"
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
    """What an engine declares by some name and can be called, in a process of its own.

    The definitions that it stands in are those of `studies.old.fingerprint.names_of`.
    """

    engine: str
    name: str
    definitions: frozenset[Name]

    def __call__(self, *given: Any) -> Any:
        """Call it; UnloadableError as of `apart`."""
        return apart(_called_here, self.engine, self.name, *given)


def _called_here(engine: str, name: str, *given: Any) -> Any:
    call = getattr(registry.loaded(engine), name)
    return call(*(item.loaded() if hasattr(item, "loaded") else item for item in given))


def _declared_here(name: str) -> tuple[Engine, dict[str, str]]:
    """Return an engine as plain data, and the files of the modules that were loaded for it."""
    engine = ENGINES[name]

    def call(what: Callable[..., Any], name: str = "") -> Call:
        return Call(engine.name, name, frozenset(names_of(what)))

    def calls(builders: Mapping[Any, Any]) -> dict[Any, Any]:
        return {key: call(build) for key, build in builders.items()}

    plain = replace(
        engine,
        build=call(engine.build, "build"),
        script=engine.script and call(engine.script, "script"),
        spring=engine.spring and call(engine.spring, "spring"),
        builders=calls(engine.builders),
        own_step="",  # it would be imported
        presets=tuple(
            replace(each, settings=_settings(each.settings), builders=calls(each.builders))
            for each in engine.presets
        ),
    )
    files = {name: getattr(module, "__file__", None) for name, module in sys.modules.items()}
    return plain, {name: file for name, file in files.items() if isinstance(file, str)}


def _settings(settings: Any) -> Any:
    """Return settings, those of a class that this project does not have as `alike`."""
    kind = type(settings)
    if kind.__module__.partition(".")[0] in PACKAGES:
        return settings
    described = [
        (
            *(item.name, None if item.default is MISSING else item.default),
            *(item.metadata.get("allowed"), getattr(settings, item.name)),
        )
        for item in fields(settings)
    ]
    return alike(kind.__module__, kind.__qualname__, described)


def alike(module: str, name: str, described: list[tuple[str, Any, Any, Any]]) -> Any:
    """Return settings that are called, and checked, as those of a class that is not loaded here.

    They are described by their names, defaults, what is `engines.parts.settings.Allowed`, and
    values.
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
