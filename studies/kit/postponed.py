"""A module that is loaded when it is used, however many modules import it before."""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


def postpone(name: str) -> None:
    """Let imports of a module that is not loaded yet give one that loads it when it is used."""
    sys.modules.setdefault(name, Postponed(name))


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
