"""What the command line accepts: numbers with their range, sources, folders; one line if not."""

import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any

from cyclopts import Parameter, Token

from studies.cases.refusal import BadInputError as BadInputError


def _number(allowed: str, accepts: Callable[[float], bool]) -> Any:
    def convert(type_: type, tokens: Sequence[Token]) -> Any:
        token = tokens[0]
        try:
            value = type_(token.value)
            if math.isfinite(value) and accepts(value):
                return value
        except ValueError:
            pass
        raise BadInputError(f"{token.keyword} is {token.value!r}; it must be {allowed}")

    return Parameter(converter=convert, n_tokens=1, allow_leading_hyphen=True)


Positive = Annotated[float, _number("a positive finite number", lambda value: value > 0)]
"""A positive finite number."""

Count = Annotated[int, _number("a positive whole number", lambda value: value > 0)]
"""A positive whole number."""


def figures(*allowed: int) -> Parameter:
    """Return what makes an argument take some of the paper's figures, separated by spaces."""

    def convert(type_: type, tokens: Sequence[Token]) -> tuple[int, ...]:
        for token in tokens:
            if token.value not in map(str, allowed):
                words = ", ".join(map(str, allowed))
                raise BadInputError(f"{token.keyword} is {token.value!r}; it must be among {words}")
        return tuple(int(token.value) for token in tokens)

    return Parameter(
        converter=convert, consume_multiple=True, metavar="INT...", show_default=_spaced
    )


def _spaced(values: Iterable[Any]) -> str:
    return " ".join(str(value) for value in values)


several = Parameter(consume_multiple=True, show_default=_spaced)
"""Values separated by spaces."""


def check_sources(names: Sequence[str]) -> None:
    """Raise BadInputError if there is no source, an unknown one, or one named twice."""
    from studies.sources.registry import UnknownSourceError, allowed, resolve

    if not names:
        raise BadInputError(f"--sources is empty; it must name at least one of {allowed()}")
    for name in names:
        try:
            resolve(name)
        except UnknownSourceError as error:
            raise BadInputError(f"--sources: {error}") from error
    refuse_repeats("--sources", names)


def check_engines(names: Sequence[str]) -> None:
    """Raise BadInputError if there is no engine, an unknown one, or one named twice."""
    from engines import ENGINES

    for name in names:
        if name not in ENGINES:
            allowed = ", ".join(ENGINES)
            raise BadInputError(f"--engines is {name!r}; it must be among {allowed}")
    refuse_repeats("--engines", names)


def refuse_repeats(argument: str, values: Iterable[Any]) -> None:
    """Raise BadInputError if a value is given twice, or none."""
    values = list(values)
    if not values:
        raise BadInputError(f"{argument} is empty; it must have at least one value")
    for number, value in enumerate(values):
        if value in values[:number]:
            raise BadInputError(f"{argument} names {value!r} twice; each may be named once")


def refuse_given(options: Mapping[str, object], allowed: str) -> None:
    """Raise BadInputError if one of the options, named without dashes, was given a value."""
    given = [f"--{name} is {value}" for name, value in options.items() if value is not None]
    if given:
        raise BadInputError(f"{' and '.join(given)}; it may be given {allowed}")


def check_plot(path: Path | None) -> None:
    """Raise BadInputError if a figure cannot be written to `path`."""
    if path is None:
        return
    if path.suffix not in (".png", ".pdf", ".svg"):
        raise BadInputError(f"--plot is {str(path)!r}; it must end in .png, .pdf or .svg")
    try:
        with path.open("ab") as probe:
            fresh = probe.tell() == 0
        if fresh:
            path.unlink()
    except OSError as error:
        raise BadInputError(
            f"--plot is {str(path)!r}; it must be a file that can be written ({error.strerror})"
        ) from error
