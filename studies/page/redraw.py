"""Draw a results folder again, from its CSVs alone."""

from pathlib import Path
from typing import Literal

from studies.catalogue import STUDIES
from studies.kit import provenance
from studies.kit.arguments import BadInputError, Place
from studies.kit.provenance import check
from studies.kit.refusing import one_line
from studies.kit.study import Study


def command(folder: Place, /, *, suffix: Literal["png", "svg", "pdf"] = "png") -> int:
    """Draw the figures of a results folder again, from its CSVs alone.

    Parameters
    ----------
    folder
        Results of a study.
    suffix
        Format of the files.
    """
    kept = [study for study in STUDIES if study.table]
    left = _recorded(folder)
    found = [study for study in kept if any(folder.glob(study.table)) or study.name == left]
    if not found:
        tables = ", ".join(study.table for study in kept)
        raise BadInputError(f"FOLDER is {str(folder)!r}; it must hold one of {tables}")
    for study in found:
        check(folder, study.tables, "FOLDER")
    for study in found:
        drawn = [str(path) for path in draw(study, folder, f".{suffix}")]
        print(*(drawn or [f"{folder}: none of its tables has a picture"]), sep="\n")
    return 0


def _recorded(folder: Path) -> str:
    try:
        return str(provenance.record_of(folder)["study"])
    except (OSError, ValueError, KeyError, TypeError, RecursionError):
        return ""


def draw(study: Study, folder: Path, suffix: str) -> list[Path]:
    """Draw a study's figures from its tables; return the files.

    Raises
    ------
    BadInputError
        If a table is not what the study wrote: without rows or columns, or with other contents.
    """
    from studies.drawing.figures import save_all

    try:
        for table in folder.glob(study.table):
            if table.read_bytes().count(b"\n") < 2:
                raise ValueError(f"{table.name} has no rows")
        return save_all(study.pictures(folder), folder, suffix)
    except OSError:
        raise
    except Exception as error:
        # a table that was edited may break its drawing in any way
        problem = f"its results of `rocking {study.name}` cannot be drawn"
        raise BadInputError(f"FOLDER is {str(folder)!r}; {problem} ({one_line(error)})") from error
