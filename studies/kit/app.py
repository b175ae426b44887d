"""The command line: what runs a command, and what a user sees when it cannot be run."""

import itertools
import os
import signal
import sys
from collections.abc import Sequence

from cyclopts import App, CycloptsError, Parameter

from studies.kit.arguments import BadInputError
from studies.kit.journal import FolderError
from studies.kit.study import Study


def make_app(studies: Sequence[Study]) -> App:
    """Return the command line with these commands, each loaded when it is asked for."""
    app = App(
        name="rocking",
        help="A rocking block: the exact solution, its linearizations, PyBullet and MuJoCo.",
        help_format="markdown",
        help_formatter="default",
        version=_version,
        default_parameter=Parameter(negative=()),
        suppress_keyboard_interrupt=False,
    )
    for study in studies:
        app.command(f"{study.module}:command", name=study.name, help=study.help)
    return app


def _version() -> str:
    from studies.kit.provenance import project_version

    return project_version()


def run(studies: Sequence[Study], arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    for name, value in itertools.pairwise(["", *arguments]):
        if not value:
            return _refuse(f"{name} is empty; it must be given")
    try:
        code = make_app(studies)(
            arguments,
            exit_on_error=False,
            print_error=False,
            verbose=False,
            result_action="return_value",
        )
        sys.stdout.flush()
    except (CycloptsError, BadInputError, FolderError) as error:
        return _refuse(str(error))
    except KeyboardInterrupt as stop:
        print(f"rocking: interrupted; {stop}".rstrip("; "), file=sys.stderr)
        return 128 + signal.SIGINT
    except BrokenPipeError:
        # whoever read the output has gone: nothing more can be said there, not even on exit
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        return 128 + signal.SIGPIPE
    except OSError as error:
        return _refuse(str(error))
    return code if isinstance(code, int) else 0


def _refuse(message: str) -> int:
    print(f"rocking: {' '.join(message.split())}", file=sys.stderr)
    return 2
