"""How a command is told whom it asks: sources and engines by name, and words for several.

A name that nobody has, or one given twice, is refused where the argument is read.
"""

from collections.abc import Iterable, Sequence
from typing import Annotated

from cyclopts import Parameter

from engines import ENGINES, core_engines
from engines.scene import perhaps
from studies.old.arguments import BadInputError, refuse_repeats
from studies.sources.registry import (
    GROUPS,
    SOURCES,
    UnknownSourceError,
    all_presets,
    allowed,
    expanded,
    resolve,
)

CORE = core_engines()
"""The engines that the published studies ask."""


def _check_sources(_: type, names: Sequence[str] | None) -> None:
    if names is None:  # they are not given
        return
    if not names:
        raise BadInputError(f"--sources is empty; it must name at least one of {allowed()}")
    for name in names:
        try:
            resolve(name)
        except UnknownSourceError as error:
            raise BadInputError(f"--sources: {error}") from error
    refuse_repeats("--sources", names)


def _check_engines(_: type, names: Sequence[str] | None) -> None:
    for name in names or ():
        if name not in ENGINES:
            among = f"it must be among {', '.join(ENGINES)}"
            raise BadInputError(f"--engines is {name!r}{perhaps(name, list(ENGINES))}; {among}")
    if names is not None:  # they are given
        refuse_repeats("--engines", names)


def sources_option(
    first: str = "", names: Iterable[str] = tuple(SOURCES), *, default: bool = True
) -> Parameter:
    """Return what makes an argument take names of sources.

    Parameters
    ----------
    first : str, optional
        What its help says first.
    names : iterable of str, optional
        Those that its help lists.
    default : bool, optional
        Whether it shows a default.
    """
    words = ", ".join(f'"{word}"' for word in GROUPS)
    return Parameter(
        consume_multiple=True,
        show_default=" ".join if default else False,
        converter=lambda _, tokens: tuple(expanded(token.value for token in tokens)),
        validator=_check_sources,
        help=(
            f"{first}{' '.join(names)}; an engine takes a preset after a colon: "
            f"{' '.join(all_presets())}; {words} stand for those of the published studies, for all "
            "that are installed, and for those of these that step another one's models."
        ),
    )


Sources = Annotated[tuple[str, ...], sources_option()]
"""Names of any sources."""

EngineSources = Annotated[tuple[str, ...], sources_option("Engines: ", ENGINES)]
"""Names of engines, each perhaps with a preset."""

Engines = Annotated[
    tuple[str, ...],
    Parameter(
        consume_multiple=True,
        show_default=lambda names: " ".join(names or ("all",)),
        validator=_check_engines,
    ),
]
"""Names of engines alone."""
