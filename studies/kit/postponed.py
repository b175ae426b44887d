"""A module that is loaded when it is used, however many modules import it before."""

import sys
from importlib import import_module
from types import ModuleType
from typing import Any


class Postponed(ModuleType):
    """Stands for a module until an attribute is asked for; LazyLoader loads at a second import."""

    def __getattr__(self, attribute: str) -> Any:
        """Load the module, and return its attribute."""
        if sys.modules.get(self.__name__) is self:
            sys.modules.pop(self.__name__, None)
        loaded = import_module(self.__name__)
        self.__dict__.update(loaded.__dict__)
        return getattr(loaded, attribute)


def postpone(name: str) -> None:
    """Let imports of a module that is not loaded yet give one that loads it when it is used."""
    sys.modules.setdefault(name, Postponed(name))
