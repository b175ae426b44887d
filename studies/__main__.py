"""The command line: `rocking`, and `python -m studies`."""

import gc
import sys

from studies import page
from studies.catalogue import STUDIES
from studies.kit import app, refusing, signals

COMMANDS = (*STUDIES, page.REPORT, page.README)
"""Every command."""


def run(arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    return app.run(COMMANDS, arguments)


def main() -> None:
    """Run the command that the arguments name, and exit."""
    signals.install()
    # by default a tenth of a short command's time goes into looking for garbage among its imports
    gc.set_threshold(10_000)
    app.settle_environment()
    refusing.prepare()
    code = run(sys.argv[1:])
    signals.ignore()
    refusing.finish()
    sys.exit(code)


if __name__ == "__main__":
    main()
