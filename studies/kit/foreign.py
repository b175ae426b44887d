"""Engines of other packages, known where their code is not loaded: a process declares each as data.

What code does when it is imported ends, stops or silences the process that imports it: that is one
of its own, and never the one that judges, which ends with its own exit code.
"""

import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import MISSING, dataclass, field, fields, make_dataclass
from importlib import import_module
from operator import attrgetter
from typing import Any

from engines import ENGINES, registry
from engines.declaration import Engine, Preset
from engines.parts.settings import check
from engines.registry import UnloadableError
from studies.kit.fingerprint import PACKAGES, Name, files_elsewhere, names_of
from studies.kit.pool import Pool, StartError, TaskError

LOADING_S = 60.0
"""How long an engine of another package may take to be loaded [s]."""
PLAIN = (type(None), bool, int, float, str, tuple)
"""Values of settings that are kept as they are; of others it is their words."""


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
    found: tuple[Engine, dict[str, str]] = apart(_declared_here, name)
    files_elsewhere.update(found[1])
    return found[0]


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


@dataclass(frozen=True, kw_only=True)
class Call:
    """A function of an engine, which is loaded in the process that calls it, or in one apart.

    Attributes
    ----------
    engine : str
    path : tuple
        Where it is declared: attributes, and keys of mappings.
    definitions : frozenset
        Those that it stands in; see `studies.kit.fingerprint.names_of`.
    """

    engine: str
    path: tuple[Any, ...]
    definitions: frozenset[Name]

    def __call__(self, *given: Any) -> Any:
        """Call it; UnloadableError as of `apart`."""
        if registry.elsewhere:
            return apart(_called_here, self.engine, self.path, *given)
        return _called_here(self.engine, self.path, *given)


def _called_here(engine: str, path: Iterable[Any], *given: Any) -> Any:
    found: Any = registry.loaded(engine)
    for part in path:
        found = getattr(found, part) if isinstance(part, str) else found[part]
    return found(*(item.loaded() if hasattr(item, "loaded") else item for item in given))


def _declared_here(name: str) -> tuple[Engine, dict[str, str]]:
    """Return an engine as plain data, and the files of the modules that were loaded for it."""
    engine = _plain(ENGINES[name])
    files = {name: getattr(module, "__file__", None) for name, module in sys.modules.items()}
    return engine, {name: file for name, file in files.items() if isinstance(file, str)}


def _plain(engine: Engine) -> Engine:
    said = {item.name: getattr(engine, item.name) for item in fields(Engine)}
    for name in ("build", "script", "spring"):
        said[name] = said[name] and _call(engine, said[name], name)
    said["builders"] = _calls(engine, engine.builders, "builders")
    said["own_step"] = ""  # it would be imported
    said["presets"] = tuple(
        Preset(
            **{item.name: getattr(preset, item.name) for item in fields(Preset)}
            | {"settings": _settings(preset.settings)}
            | {"builders": _calls(engine, preset.builders, "presets", number, "builders")}
        )
        for number, preset in enumerate(engine.presets)
    )
    return Engine(**said)


def _call(engine: Engine, call: Callable[..., Any], *path: Any) -> Call:
    return Call(engine=engine.name, path=path, definitions=frozenset(names_of(call)))


def _calls(engine: Engine, builders: Mapping[Any, Any], *path: Any) -> dict[Any, Call]:
    return {key: _call(engine, build, *path, key) for key, build in builders.items()}


def _settings(settings: Any) -> Any:
    """Return settings, those of a class that this project does not have as `alike`."""
    kind = type(settings)
    if kind.__module__.partition(".")[0] in PACKAGES:
        return settings
    described = []
    for item in fields(settings):
        default, value = (
            part if isinstance(part, PLAIN) or part is MISSING else str(part)
            for part in (item.default, getattr(settings, item.name))
        )
        described.append((item.name, default, item.metadata.get("allowed"), value))
    return alike(kind.__module__, kind.__qualname__, described)


def alike(module: str, name: str, described: Sequence[tuple[str, Any, Any, Any]]) -> Any:
    """Return settings that are called, and checked, as those of a class that is not loaded here.

    Parameters
    ----------
    module, name : str
        Where the class stands.
    described : sequence
        Name, default, what is `engines.parts.settings.Allowed` and the value of each setting.
    """
    items = [
        (item, Any, field(default=default, metadata={"allowed": allowed} if allowed else {}))
        for item, default, allowed, _ in described
    ]
    does = {
        "__post_init__": check,
        "__reduce__": lambda it: (
            alike,
            (module, name, [(*row[:3], getattr(it, row[0])) for row in described]),
        ),
        "loaded": lambda it: attrgetter(name)(import_module(module))(**vars(it)),
    }
    made = make_dataclass(name, items, namespace=does, frozen=True, kw_only=True)
    made.__module__, made.__qualname__ = module, name
    return made(**{item: value for item, _, _, value in described})
