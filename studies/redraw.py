"""Draw a results folder again, from its CSVs alone."""

from pathlib import Path

from studies import histories, overturning_report, sweep
from studies.arguments import BadInputError
from studies.cases import HISTORIES


def command(folder: Path, /) -> int:
    """Draw the figures of a results folder again, from its CSVs alone.

    Parameters
    ----------
    folder
        Results of `rocking sweep`, `rocking histories` or `rocking overturning`.
    """
    drawn = sweep.redraw(folder) if (folder / "sweep.csv").is_file() else []
    drawn += [
        histories.redraw(folder, figure)
        for figure in HISTORIES
        if (folder / f"figure-{figure}.csv").is_file()
    ]
    if (folder / "map.csv").is_file():
        drawn += overturning_report.redraw(folder)
    if not drawn:
        raise BadInputError(
            f"FOLDER is {str(folder)!r}; it must hold a sweep.csv, a map.csv or the CSV of a figure"
        )
    print("\n".join(str(path) for path in drawn))
    return 0
