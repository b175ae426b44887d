"""Draw a results folder again, from its CSVs alone."""

from pathlib import Path
from typing import Literal

from studies.arguments import BadInputError
from studies.chapters import CHAPTERS


def command(folder: Path, /, *, suffix: Literal["png", "svg", "pdf"] = "png") -> int:
    """Draw the figures of a results folder again, from its CSVs alone.

    Parameters
    ----------
    folder
        Results of a study.
    suffix
        Format of the files.
    """
    from studies.figures import save_all

    drawn = [
        path
        for chapter in CHAPTERS
        if any(folder.glob(chapter.source))
        for path in save_all(chapter.pictures(folder), folder, f".{suffix}")
    ]
    if not drawn:
        tables = ", ".join(chapter.source for chapter in CHAPTERS)
        raise BadInputError(f"FOLDER is {str(folder)!r}; it must hold one of {tables}")
    print("\n".join(map(str, drawn)))
    return 0
