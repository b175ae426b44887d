"""How a command is told which sources it asks: names and words for several, listed in its help."""

from collections.abc import Iterable, Sequence

from cyclopts import Parameter, Token

from engines import ENGINES
from studies.sources.groups import GROUPS, expanded
from studies.sources.registry import SOURCES, all_presets


def _expanded(type_: type, tokens: Sequence[Token]) -> tuple[str, ...]:
    return tuple(expanded(token.value for token in tokens))


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
        converter=_expanded,
        help=(
            f"{first}{' '.join(names)}; an engine takes a preset after a colon: "
            f"{' '.join(all_presets())}; {words} stand for those of the published studies, for all "
            "that are installed, and for those of these that step another one's models."
        ),
    )


several_sources = sources_option()
"""Names of any sources."""

several_engines = sources_option("Engines: ", ENGINES)
"""Names of engines."""
