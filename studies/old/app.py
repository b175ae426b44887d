"""The command line: what runs a command, and what a user sees when it cannot be run.

What takes time to import is imported inside functions, so that a signal meanwhile is dealt with.
"""

from __future__ import annotations

import itertools
import os
import re
import shutil
import signal
import sys
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any

from studies.old import refusing, signals

if TYPE_CHECKING:
    from collections.abc import Sequence

    from cyclopts import App, UnknownOptionError

    from studies.old.study import Study


RETIRED = ("ensemble", "free", "harmonic", "literature", "redraw", "throughput", "versions")
"""Commands that answer for one release that they are gone."""


def make_app(studies: Sequence[Study]) -> App:
    """Return the command line with these commands, each loaded when it is asked for."""
    from cyclopts import App, Parameter

    app = App(
        name="rocking",
        help="A rocking block: the exact solution, its linearizations, physics engines.",
        help_format="markdown",
        help_formatter="default",
        version=_version,
        default_parameter=Parameter(negative=()),
        suppress_keyboard_interrupt=False,
    )
    for study in studies:
        app.command(f"{study.module}:command", name=study.name, help=study.about)
    return app


def _version() -> str:
    from studies.old.provenance import project_version

    return project_version()


def run(studies: Sequence[Study], arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    try:
        code = _answer(studies, arguments)
        sys.stdout.flush()
    except KeyboardInterrupt as stop:
        number = stop.number if isinstance(stop, signals.Ended) else signal.SIGINT
        kind = "interrupted" if number == signal.SIGINT else signal.Signals(number).name
        refusing.say(f"rocking: {kind}; {stop}".rstrip("; "))
        return 128 + number
    except (BrokenPipeError, SystemExit) as stop:
        # what sets the help makes another of it
        if BrokenPipeError not in (type(stop), type(stop.__context__)):
            raise
        # whoever read the output has gone: nothing more can be said there, not even on exit
        refusing.give_up_output()
        return 128 + signal.SIGPIPE
    except (OSError, ImportError) as error:
        return refusing.refuse(refusing.reason(error, arguments))
    except (ArithmeticError, MemoryError, ValueError) as error:
        if REFUSAL.match(str(error)):
            return refusing.refuse(str(error))
        domain = str(error) == "math domain error" or type(error).__name__ == "LinAlgError"
        if isinstance(error, ValueError) and not domain:
            raise  # an error of the program
        words = "the numbers given are too small, too large or too many to compute with"
        return refusing.refuse(f"{words} ({refusing.one_line(error)})")
    return code


REFUSAL = re.compile(r".+ (?:is|are) .+[;,] .*\bmust ")
"""A refusal of a value, whoever finds it: "width is 0; it must be positive"."""


def _answer(studies: Sequence[Study], arguments: list[str]) -> int:
    from cyclopts import CycloptsError, UnknownOptionError

    from studies.old import foreign
    from studies.old.arguments import BadInputError
    from studies.old.journal import FolderError

    sys.modules.setdefault("pandas", Postponed("pandas"))
    if "--version" in arguments and len(arguments) > 1:
        return refusing.refuse(
            f"--version is one of {len(arguments)} arguments; it must stand alone"
        )
    if arguments and arguments[0] in RETIRED:
        return refusing.refuse(f"{arguments[0]} was retired in 0.3, see the changelog")
    for before, argument in itertools.pairwise(["COMMAND", *arguments]):
        name, equals, value = argument.partition("=")
        if not argument.strip() or (name.startswith("--") and equals and not value.strip()):
            return refusing.refuse(f"{name.strip() or before} is empty; it must be given")
    try:
        with foreign.kept_out():
            code = make_app(studies)(
                arguments,
                exit_on_error=False,
                print_error=False,
                verbose=False,
                result_action="return_value",
            )
    except UnknownOptionError as error:
        return refusing.refuse(_unknown_option(error))
    except (CycloptsError, BadInputError, FolderError) as error:
        return refusing.refuse(str(error))
    return code if isinstance(code, int) else 0


def _unknown_option(error: UnknownOptionError) -> str:
    """Return the refusal of an option that a command does not have, with the one it is like."""
    from difflib import get_close_matches

    given = (error.token.keyword or error.token.value).partition("=")[0]
    options = [
        name for each in error.argument_collection for name in each.names if name[:2] == "--"
    ]
    words = {name.lstrip("-"): name for name in options}
    near = [words[word] for word in get_close_matches(given.lstrip("-"), words, 1, LIKENESS)]
    command = " ".join(error.command_chain or ())
    able = f"did you mean {near[0]}?" if near else f"it takes {', '.join(options)}"
    return f"{given} is no option of {command or 'rocking'}; {able}"


LIKENESS = 0.7
"""How like an option must be to be named as what was meant, its dashes left aside."""


class Postponed(ModuleType):
    """Stands for a module until an attribute of it is asked for.

    The loader that the standard library has for this loads a module where it is imported a second
    time.
    """

    def __getattr__(self, attribute: str) -> Any:
        """Load the module, and return its attribute."""
        name = self.__name__
        if sys.modules.get(name) is self:
            sys.modules.pop(name, None)
        loaded = import_module(name)
        self.__dict__.update(loaded.__dict__)
        return getattr(loaded, attribute)


NARROWEST, WIDEST = 40, 200
"""Columns of a terminal for which help is set; in two or in ten million it takes for ever."""


def settle_environment() -> None:
    """Take away from libraries what would stop them and has no part here.

    No figure opens a window, and no kernel uses numba's own threads.
    """
    for name in ("MPLBACKEND", "NUMBA_NUM_THREADS"):
        os.environ.pop(name, None)
    columns = shutil.get_terminal_size().columns
    os.environ["COLUMNS"] = str(min(max(columns, NARROWEST), WIDEST))
