"""Where this project keeps one full run of every study."""

from collections.abc import Sequence
from pathlib import Path

from studies.kit.arguments import BadInputError
from studies.kit.digests import check

PUBLISHED = Path(__file__).parents[1] / "published"
"""The folder of the published tables, one folder inside for each chapter."""


def published_in(folder: Path | None, names: Sequence[str]) -> Path:
    """Return the folder of published tables that --published gives, by default PUBLISHED.

    Raises
    ------
    BadInputError
        If it lacks one of these tables.
    FolderError
        If one was edited.
    """
    found = folder or PUBLISHED
    if missing := [name for name in names if not (found / name).is_file()]:
        raise BadInputError(f"--published is {str(found)!r}; it must hold {missing[0]}")
    check(found, names, "--published")
    return found
