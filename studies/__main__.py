"""The command line: `rocking`, and `python -m studies`."""

import io
import sys

from studies import page
from studies.catalogue import STUDIES
from studies.kit import app

COMMANDS = (*STUDIES, page.REPORT, page.REDRAW, page.README)
"""Every command."""


def run(arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    return app.run(COMMANDS, arguments)


def main() -> None:
    """Run the command that the arguments name, and exit."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # a terminal without Greek letters shows question marks instead
            stream.reconfigure(errors="replace")
    sys.exit(run(sys.argv[1:]))


if __name__ == "__main__":
    main()
