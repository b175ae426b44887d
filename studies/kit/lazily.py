"""Imports that are put off until something of the module is used."""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class Postponed(ModuleType):
    """Stands for a module until an attribute of it is asked for.

    The loader that the standard library has for this loads a module where it is imported a second
    time.
    """

    def __getattr__(self, attribute: str) -> Any:
        """Load the module, and return its attribute."""
        name = self.__name__
        if sys.modules.get(name) is self:
            sys.modules.pop(name, None)
        loaded = import_module(name)
        self.__dict__.update(loaded.__dict__)
        return getattr(loaded, attribute)


def postpone(name: str) -> None:
    """Let a module be loaded where it is first used, not where it is imported."""
    sys.modules.setdefault(name, Postponed(name))
