"""Settings of an engine: a frozen dataclass whose fields say what they allow, and reading back.

Its defaults are the library's own, so that ``Settings()`` changes nothing; None leaves a setting to
the library.
"""

import math
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, fields
from difflib import get_close_matches
from numbers import Real
from typing import Any

from engines.world import ROUNDINGS


def one_of(name: str, value: str, allowed: Iterable[str]) -> None:
    """Raise ValueError unless `value` is one of those allowed; the message names them."""
    allowed = tuple(allowed)
    if value not in allowed:
        near = perhaps(value, allowed)
        raise ValueError(f"{name} is {value!r}{near}; it must be one of {', '.join(allowed)}")


RENAMED = {"naive": "default", "naive-base-at-rest": "default-at-rest", "fixed": "tuned"}
"""Name that a preset had until 0.3 -> its name."""


def perhaps(value: str, allowed: Sequence[str]) -> str:
    """Return the words that name the one of those allowed which a value is like, if one is."""
    owner, colon, preset = str(value).rpartition(":")
    renamed = f"{owner}{colon}{RENAMED.get(preset, '')}"
    if renamed in allowed:
        return f", now {renamed!r}"
    near = get_close_matches(str(value).lower(), allowed, 1, 0.7)
    return f", perhaps {near[0]!r}" if near else ""


@dataclass(frozen=True, slots=True, kw_only=True)
class Allowed:
    """What a setting may be: between bounds, without `above`, one of names, or with others."""

    above: float = -math.inf
    least: float = -math.inf
    most: float = math.inf
    names: tuple[str, ...] = ()
    beside: tuple[str, ...] = ()

    def check(self, name: str, value: Any) -> None:
        """Raise ValueError unless `value` is allowed."""
        if self.names:
            one_of(name, value, self.names)
        elif words := self._words():
            held = isinstance(value, Real) and math.isfinite(value)
            if not (held and self.above < value and self.least <= value <= self.most):
                raise ValueError(f"{name} is {value!r}; it must be {words}")

    def _words(self) -> str:
        most = "" if self.most == math.inf else f"at most {self.most:g}"
        if self.above == 0.0:
            return f"positive and {most}" if most else "positive"
        if self.least > -math.inf:
            return f"from {self.least:g} to {self.most:g}" if most else f"{self.least:g} or more"
        return most


def setting(default: Any = None, *, names: Sequence[str] = (), **allowed: Any) -> Any:
    """Return a field with the library's default, or None, and what it allows; see `Allowed`."""
    return field(default=default, metadata={"allowed": Allowed(names=tuple(names), **allowed)})


def check(settings: Any) -> None:
    """Raise ValueError unless each setting is allowed; None leaves it to the library, if it may."""
    for item in fields(settings):
        allowed, value = item.metadata.get("allowed"), getattr(settings, item.name)
        if hasattr(value, "item"):  # a number of NumPy, which is not written as one of Python is
            object.__setattr__(settings, item.name, value := value.item())
        if allowed is None:
            continue
        together = {item.name: value, **{n: getattr(settings, n) for n in allowed.beside}}
        if len({v is None for v in together.values()}) > 1:
            values = ", ".join(map(repr, together.values()))
            raise ValueError(
                f"{', '.join(together)} are {values}; they must be given together or not at all"
            )
        if value is not None or (allowed.names and item.default is not None):
            allowed.check(item.name, value)


class Settings:
    """Settings of an engine, which are checked when they are made."""

    __slots__ = ()

    def __post_init__(self) -> None:
        check(self)


def given(settings: Mapping[str, Any]) -> dict[str, Any]:
    """Return the settings that are not left to the library."""
    return {name: value for name, value in settings.items() if value is not None}


def disagreement(pairs: Mapping[str, tuple[Any, Any]], rounding: float = 2.0**-53) -> str:
    """Name the first of the pairs (set, None being the library's, and read) that differ, or ""."""
    near = max(1e-9, ROUNDINGS * rounding)
    for name, (wanted, found) in pairs.items():
        if wanted is None or wanted == found:
            continue
        if isinstance(wanted, str) or not math.isclose(wanted, found, rel_tol=near):
            return f"{name} was set to {wanted!r} but reads {found!r}"
    return ""
