"""What the command line accepts: numbers with their range, sources, paths; one line if not."""

import errno
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from cyclopts import Parameter, Token

from analytic.accelerograms.text import finite_number, underflows
from engines.scene import MOST_HALF_CYCLES
from studies.cases.refusal import BadInputError as BadInputError

T = TypeVar("T")

MOST = 10**9
"""The largest whole number that an argument takes."""

LARGEST = sys.float_info.max
"""The largest number."""


@contextmanager
def as_bad_input(prefix: str = "--") -> Iterator[None]:
    """Make a ValueError whose message begins with the name of an argument the one line about it.

    Raises
    ------
    BadInputError
    """
    try:
        yield
    except ValueError as error:
        name, blank, rest = str(error).partition(" ")
        raise BadInputError(f"{prefix}{name.replace('_', '-')}{blank}{rest}") from error


def _read(allowed: str, convert: Callable[[type, str], Any]) -> Any:
    """Return what makes an argument take one value, which `convert` refuses by a ValueError."""

    def read(type_: type, tokens: Sequence[Token]) -> Any:
        token = tokens[0]
        try:
            return convert(type_, token.value)
        except ValueError as error:
            # an argument that is not an option has no keyword
            name = token.keyword or "FOLDER"
            beside = ""
            if type_ is float and "," in token.value:
                beside = ", with a decimal point"
            elif type_ is float and underflows(token.value):
                beside = f", and no smaller than {math.ulp(0.0):g} unless 0"
            raise BadInputError(
                f"{name} is {token.value!r}; it must be {allowed}{beside}"
            ) from error

    return Parameter(converter=read, n_tokens=1, allow_leading_hyphen=True)


def _number(allowed: str, least: float, most: float = LARGEST) -> Any:
    """Return what makes an argument take a number from `least` to `most`."""

    def convert(type_: type, text: str) -> Any:
        if not least <= finite_number(text) <= most:
            raise ValueError(text)
        return type_(text)

    return _read(allowed, convert)


def _path(_: type, text: str) -> Path:
    if not text.strip() or text.startswith("-") or "\0" in text:
        raise ValueError(text)
    return Path(text)


Positive = Annotated[float, _number("a positive finite number", math.ulp(0.0))]
"""A positive finite number."""

NotNegative = Annotated[float, _number("a finite number, 0 or more", 0.0)]
"""A finite number that is not negative."""

Finite = Annotated[float, _number("a finite number", -LARGEST)]
"""A finite number of either sign."""

Count = Annotated[int, _number(f"a positive whole number up to {MOST}", 1, MOST)]
"""A positive whole number."""

TimeLimit = Annotated[float, _number("a positive number of seconds up to 1e9", math.ulp(0.0), 1e9)]
"""A time that clocks hold [s]."""

LEAST_STEP = 1e-7
"""The smallest step: ten million of them last as long as 1/p."""

_STEP = f"a positive number of at least {LEAST_STEP:g}: {1 / LEAST_STEP:g} of them make up 1/p"
_CYCLES = (
    f"a positive whole number up to {MOST_HALF_CYCLES}, as the times of all are held in memory"
)

Step = Annotated[float, _number(_STEP, LEAST_STEP)]
"""p dt of a solver or an engine."""

HalfCycles = Annotated[int, _number(_CYCLES, 1, MOST_HALF_CYCLES)]
"""Length of a pulse."""


def one_of(words: Any) -> Any:
    """Return what makes an argument take one of a Literal's words, and no other way to say none."""
    allowed = get_args(words)

    def convert(_: type, text: str) -> str:
        # of a tuple: its error is the one that is refused by
        return str(allowed[allowed.index(text)])

    return _read(f"among {', '.join(allowed)}", convert)


Place = Annotated[Path, _read("a path; one that begins with a dash is written ./-name", _path)]
"""A file or folder."""

Out = Annotated[Place, Parameter(help="Folder for the results; made if there is none.")]
"""Where a study leaves what it made."""

Yes = Annotated[bool, Parameter(help="Begin even what takes longer than a day.")]
"""Whether somebody has the time."""


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

several_or_none = Parameter(consume_multiple=1)
"""Values separated by spaces, at least one; None where the option is not given."""


def refuse_repeats(argument: str, values: Iterable[Any]) -> None:
    """Refuse an argument of which a value is given twice, or none.

    Parameters
    ----------
    argument : str
        As the user wrote it, with its dashes; a refusal begins with it.
    values : iterable
        What it was given; compared by ==.

    Raises
    ------
    BadInputError
    """
    values = list(values)
    if not values:
        raise BadInputError(f"{argument} is empty; it must have at least one value")
    seen: set[Any] = set()
    for value in values:
        if value in seen:
            shown = str(value) if isinstance(value, Path) else value
            raise BadInputError(f"{argument} names {shown!r} twice; each may be named once")
        seen.add(value)


def refuse_given(options: Mapping[str, object], allowed: str) -> None:
    """Refuse options that say nothing beside the others that were given.

    Parameters
    ----------
    options : mapping
        Name without dashes -> value, None where the option was not given.
    allowed : str
        When it may be given, as the refusal ends: "only without --records".

    Raises
    ------
    BadInputError
        That names all options which have a value.
    """
    given = [f"--{name} is {value}" for name, value in options.items() if value is not None]
    if given:
        raise BadInputError(f"{' and '.join(given)}; it may be given {allowed}")


def required(words: str, **given: T | None) -> tuple[T, ...]:
    """Return the values of options that are needed together.

    Parameters
    ----------
    words : str
        What needs them, as the refusal ends.
    **given
        Name -> value, None where the option was not given.

    Raises
    ------
    BadInputError
        That names all options which have no value.
    """
    missing = [_option(name) for name, value in given.items() if value is None]
    if missing:
        raise BadInputError(f"{' and '.join(missing)} missing; {words}")
    return tuple(value for value in given.values() if value is not None)


def refuse_both(**given: float | str | None) -> None:
    """Refuse two options of which each says what the other does; None where one was not given.

    Raises
    ------
    BadInputError
        That names both.
    """
    if None not in given.values():
        said = [f"{_option(name)} is {_shown(value)}" for name, value in given.items()]
        raise BadInputError(f"{' and '.join(said)}; give one or the other")


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def _shown(value: object) -> str:
    return f"{value:g}" if isinstance(value, float) else str(value)


def check_plot(path: Path | None) -> None:
    """Raise BadInputError if a figure cannot be written to `path`."""
    if path is None:
        return
    if path.suffix not in (".png", ".pdf", ".svg"):
        raise BadInputError(f"--plot is {str(path)!r}; it must end in .png, .pdf or .svg")
    check_writable("--plot", path)


def check_writable(argument: str, path: Path) -> None:
    """Refuse a file that cannot be written, before what takes time begins.

    Parameters
    ----------
    argument : str
        As the user wrote it, with its dashes.
    path : Path
        A file that is there stays as it is; of a new one nothing is left behind.

    Raises
    ------
    BadInputError
        Also if it is there and no file: a pipe would be waited for.
    """
    try:
        if path.exists() and not path.is_file():
            # a pipe would be waited for
            raise OSError(errno.EINVAL, "it is no file")
        with path.open("ab") as probe:
            fresh = probe.tell() == 0
        if fresh:
            path.unlink()
    except OSError as error:
        raise BadInputError(
            f"{argument} is {str(path)!r}; it must be a file that can be written ({error.strerror})"
        ) from error
