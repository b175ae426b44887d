"""Draw a results folder again, from its CSVs alone."""

from pathlib import Path
from typing import Literal

from studies.kit.arguments import BadInputError
from studies.catalogue import CHAPTERS


def command(folder: Path, /, *, suffix: Literal["png", "svg", "pdf"] = "png") -> int:
    """Draw the figures of a results folder again, from its CSVs alone.

    Parameters
    ----------
    folder
        Results of a study.
    suffix
        Format of the files.
    """
    from studies.drawing.figures import save_all

    studies = {chapter.study: chapter for chapter in CHAPTERS if any(folder.glob(chapter.source))}
    if not studies:
        tables = ", ".join(dict.fromkeys(chapter.source for chapter in CHAPTERS))
        raise BadInputError(f"FOLDER is {str(folder)!r}; it must hold one of {tables}")
    drawn = []
    for chapter in studies.values():
        try:
            drawn += save_all(chapter.pictures(folder), folder, f".{suffix}")
        except (KeyError, ValueError, FileNotFoundError) as error:
            problem = f"its results of `rocking {chapter.study}` cannot be drawn ({error})"
            raise BadInputError(f"FOLDER is {str(folder)!r}; {problem}") from error
    print("\n".join(map(str, drawn)))
    return 0
