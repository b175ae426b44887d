"""What a command line may say: numbers in their ranges, words, paths; and options in groups."""

import errno
import math
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args

from cyclopts import Parameter, Token

from analytic.slide import SlidingBlock
from analytic.text import finite_number
from engines import ENGINES
from engines.scene import MOST_HALF_CYCLES, System
from engines.settings import perhaps
from studies.cases.refusal import BadInputError
from studies.sources import registry

T = TypeVar("T")
MOST, LARGEST = 10**9, sys.float_info.max
"""The largest whole number that an argument takes, and the largest number."""


@contextmanager
def as_bad_input(prefix: str = "--") -> Iterator[None]:
    """Make a ValueError whose message begins with the name of an argument the one line about it."""
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
            name = token.keyword or "FOLDER"  # only an option has a keyword
            beside = f", {error}" if str(error).startswith("0, or") else ""  # it underflows
            beside = ", with a decimal point" if "," in token.value and type_ is float else beside
            words = f"{name} is {token.value!r}; it must be {allowed}{beside}"
            raise BadInputError(words) from error

    return Parameter(converter=read, n_tokens=1, allow_leading_hyphen=True)


def _number(allowed: str, least: float, most: float = LARGEST) -> Any:
    def convert(type_: type, text: str) -> Any:
        if not least <= finite_number(text) <= most:
            raise ValueError(text)
        return type_(text)

    return _read(allowed, convert)


def _path(_: type, text: str) -> Path:
    if not text.strip() or text.startswith("-") or "\0" in text:
        raise ValueError(text)
    return Path(text)


def one_of(words: Any) -> Any:
    """Return what makes an argument take one of a Literal's words, and no other way to say none."""
    known = get_args(words)
    return _read(f"among {', '.join(known)}", lambda _, text: str(known[known.index(text)]))


def figures(help_: str, *known: int) -> Parameter:
    """Return what makes an argument take some of the paper's figures, separated by spaces."""
    words = [str(figure) for figure in known]
    one = _read(f"among {', '.join(words)}", lambda _, text: known[words.index(text)])
    return Parameter(
        converter=lambda type_, tokens: tuple(one.converter(type_, [token]) for token in tokens),
        validator=lambda _, values: refuse_repeats("--figure", values),
        consume_multiple=True,
        metavar="INT...",
        help=help_,
        show_default=_spaced,
    )


def _spaced(values: Iterable[Any] | None) -> str:
    return " ".join(str(value) for value in values or ("all",))


Positive = Annotated[float, _number("a positive finite number", math.ulp(0.0))]
NotNegative = Annotated[float, _number("a finite number, 0 or more", 0.0)]
Finite = Annotated[float, _number("a finite number", -LARGEST)]
Count = Annotated[int, _number(f"a positive whole number up to {MOST}", 1, MOST)]
TimeLimit = Annotated[float, _number("a positive number of seconds up to 1e9", math.ulp(0.0), 1e9)]
Step = Annotated[
    float, _number("a positive number of at least 1e-07: 1e+07 of them make up 1/p", 1e-7)
]
_CYCLES = (
    f"a positive whole number up to {MOST_HALF_CYCLES}, as the times of all are held in memory"
)
HalfCycles = Annotated[int, _number(_CYCLES, 1, MOST_HALF_CYCLES)]
Place = Annotated[Path, _read("a path; one that begins with a dash is written ./-name", _path)]
Out = Annotated[Place, Parameter(help="Folder for the results; made if there is none.")]
several = Parameter(consume_multiple=True, show_default=_spaced)
several_or_none = Parameter(consume_multiple=1)
"""Values separated by spaces; of the second at least one, and None where it is not given."""


def sources_option(first: str = "", *, default: bool = True) -> Parameter:
    """Return what makes an argument take sources; its help begins with `first`."""
    words = ", ".join(f'"{word}"' for word in registry.GROUPS)
    names, presets = " ".join(registry.SOURCES), " ".join(registry.all_presets())
    return Parameter(
        consume_multiple=True,
        show_default=" ".join if default else False,
        converter=lambda _, tokens: tuple(registry.expanded(token.value for token in tokens)),
        validator=_check_sources,
        help=(
            f"{first}{names}; an engine takes a preset after a colon: {presets}; {words} "
            "stand for the engines of the published studies and for all that are installed."
        ),
    )


def _check_sources(_: type, names: Sequence[str] | None) -> None:
    for name in names or ():
        with as_bad_input("--sources: "):
            registry.resolve(name)
    if names is not None:
        refuse_repeats("--sources", names, f"name at least one of {registry.allowed()}")


def _check_engines(_: type, names: Sequence[str] | None) -> None:
    for name in names or ():
        if name not in ENGINES:
            among = f"it must be among {', '.join(ENGINES)}"
            raise BadInputError(f"--engines is {name!r}{perhaps(name, list(ENGINES))}; {among}")
    if names is not None:
        refuse_repeats("--engines", names)


Sources = Annotated[tuple[str, ...], sources_option()]
Engines = Annotated[
    tuple[str, ...],
    several,
    Parameter(validator=_check_engines, help="Names of engines, without a preset."),
]


def refuse_repeats(
    argument: str, values: Iterable[Any], needed: str = "have at least one value"
) -> None:
    """Refuse an argument, named with its dashes, of which a value is given twice, or none."""
    values = list(values)
    if not values:
        raise BadInputError(f"{argument} is empty; it must {needed}")
    for number, value in enumerate(values):
        if value in values[:number]:
            shown = str(value) if isinstance(value, Path) else value
            raise BadInputError(f"{argument} names {shown!r} twice; each may be named once")


def refuse_given(options: Mapping[str, object], allowed: str) -> None:
    """Refuse options, given where not None or False, that may be given as `allowed` says."""
    if given := {name: it for name, it in options.items() if it is not None and it is not False}:
        raise BadInputError(f"{_shown(given)}; it may be given {allowed}")


def required(words: str, **given: T | None) -> tuple[T, ...]:
    """Return the values of options that are needed together, by what `words` say."""
    missing = [_option(name) for name, value in given.items() if value is None]
    if missing:
        raise BadInputError(f"{' and '.join(missing)} missing; {words}")
    return tuple(value for value in given.values() if value is not None)


def refuse_both(**given: float | str | None) -> None:
    """Refuse two options of which each says what the other does; None where it is not given."""
    if None not in given.values():
        raise BadInputError(f"{_shown(given)}; give one or the other")


def _shown(options: Mapping[str, object]) -> str:
    return " and ".join(
        f"{_option(name)} is {f'{value:g}' if isinstance(value, float) else value}"
        for name, value in options.items()
    )


def _option(name: str) -> str:
    return f"--{name.replace('_', '-')}"


def check_file(argument: str, path: Path, *ends: str) -> None:
    """Refuse a file of another ending, or that cannot be written; what is there stays as it is."""
    if path.suffix not in ends:
        allowed = f"{', '.join(ends[:-1])} or {ends[-1]}"
        raise BadInputError(f"{argument} is {str(path)!r}; it must end in {allowed}")
    try:
        if path.exists() and not path.is_file():
            raise OSError(errno.EINVAL, "it is no file")  # a pipe would be waited for
        with path.open("ab") as probe:
            fresh = probe.tell() == 0
        if fresh:
            path.unlink()
    except OSError as error:
        words = f"it must be a file that can be written ({error.strerror})"
        raise BadInputError(f"{argument} is {str(path)!r}; {words}") from error


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Computing:
    """Where jobs run, and for how long at most."""

    jobs: Count | None = None
    """Processes that run engines; by default one per core."""
    time_limit: TimeLimit = 600.0
    """Wall-clock time [s] after which a case of an engine fails."""
    cluster: str | None = None
    """Address of a Dask scheduler whose workers run all cases, such as tcp://127.0.0.1:8786."""

    def __post_init__(self) -> None:
        if self.cluster is not None:
            refuse_given({"jobs": self.jobs}, "only without --cluster")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Running(Computing):
    """Where a study's jobs run, and which of its rows there are already."""

    also: Annotated[tuple[Place, ...] | None, several_or_none] = None
    """Further folders of the same command's results, such as those of engines that are installed
    elsewhere; their rows are added."""


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class EffortOptions:
    """How finely the sources step that do."""

    p_dt: Step | None = None
    """Step of solvers and engines in units of 1/p; by default their own."""
    accuracy: Annotated[registry.Accuracy, one_of(registry.Accuracy)] | None = None
    """Accuracy of engines with landing steps; by default standard."""

    def options(self, name: str) -> dict[str, Any]:
        """Return the options that this means for a source."""
        source = registry.resolve(name)
        chosen: dict[str, Any] = {}
        if self.p_dt is not None and source.stepping:
            chosen["step"] = self.p_dt
        if self.accuracy is not None and source.accurate:
            chosen["accuracy"] = self.accuracy
        return chosen

    def refuse_idle(self, sources: Sequence[str]) -> None:
        """Refuse an option that none of the sources takes."""
        _refuse_idle(sources, "stepping", "a solver or an engine", p_dt=self.p_dt)
        _refuse_idle(
            sources, "accurate", "an engine that chooses its steps", accuracy=self.accuracy
        )


def _refuse_idle(sources: Sequence[str], taking: str, words: str, **given: Any) -> None:
    """Refuse a given option if none of the sources is what takes it."""
    if not any(getattr(registry.resolve(source), taking) for source in sources):
        refuse_given(given, f"only if --sources names {words}")


@Parameter(name="*")
@dataclass(frozen=True, kw_only=True)
class Yours:
    """What a reader's own simulation has."""

    friction: NotNegative | None = None
    """Coefficient of friction between block and base in engines; by default the preset's. Models do
    not slide: if the exact solution needs more friction, its row says so."""
    dt: Positive | None = None
    """Step [s] of solvers, and of engines whose preset takes equal steps."""

    def options(self, sources: Sequence[str], system: System) -> dict[str, dict[str, float]]:
        """Return the options that this means for each source: friction, and step, p dt."""
        if not isinstance(system, SlidingBlock):
            _refuse_idle(sources, "engine", "at least one engine", friction=self.friction)
        words = "a solver or an engine that takes equal steps"
        _refuse_idle(sources, "stepping", words, dt=self.dt)
        chosen: dict[str, dict[str, float]] = {name: {} for name in sources}
        for name, source in [(name, registry.resolve(name)) for name in sources]:
            if self.friction is not None and source.engine:
                chosen[name]["friction"] = self.friction
            if self.dt is not None and source.accurate:
                words = f"{name} takes {source.used.stepping.value}"
                raise BadInputError(f"--dt is {self.dt:g}; its steps must be equal, but {words}")
            if self.dt is not None and source.stepping:
                chosen[name]["step"] = self.dt * system.p
        return chosen
