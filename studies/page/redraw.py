"""Draw a results folder again, from its CSVs alone."""

from pathlib import Path
from typing import Literal

from studies.catalogue import STUDIES
from studies.kit.arguments import BadInputError
from studies.kit.jobs import one_line


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

    kept = [study for study in STUDIES if study.table]
    found = [study for study in kept if any(folder.glob(study.table))]
    if not found:
        tables = ", ".join(study.table for study in kept)
        raise BadInputError(f"FOLDER is {str(folder)!r}; it must hold one of {tables}")
    drawn = []
    for study in found:
        try:
            drawn += save_all(study.load().pictures(folder), folder, f".{suffix}")
        except Exception as error:
            # whatever a table that was edited holds, or no longer holds
            problem = f"its results of `rocking {study.name}` cannot be drawn"
            problem += f" ({one_line(error)})"
            raise BadInputError(f"FOLDER is {str(folder)!r}; {problem}") from error
    print("\n".join(map(str, drawn)))
    return 0
