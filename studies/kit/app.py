"""The command line: what runs a command, and what a user sees when it cannot be run."""
# What takes time to import is imported inside functions, so that a signal meanwhile is dealt with.

from __future__ import annotations

import gc
import itertools
import os
import re
import shutil
import signal
import sys
import threading
from collections.abc import Mapping, Sequence
from importlib import import_module
from types import ModuleType
from typing import TYPE_CHECKING, Any, TypeAlias

from studies.kit import say

if TYPE_CHECKING:
    from cyclopts import App, UnknownOptionError

Groups: TypeAlias = Mapping[str, Mapping[str, str]]
"""Title of a group in the help -> its commands, each with its purpose."""
PLACES = {"report": "page.page", "readme": "page.readme"}
"""Command -> its module, where that has another name."""
REFUSAL = re.compile(r".+ (?:is|are) .+[;,] .*\bmust ")
"""A refusal of a value, whoever finds it: "width is 0; it must be positive"."""
ENDING = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def main(groups: Groups) -> None:
    """Run the command that the arguments name, and exit."""
    for number in ENDING:
        if signal.getsignal(number) != signal.SIG_IGN:
            signal.signal(number, _end)
    sys.unraisablehook = _on_lost
    gc.set_threshold(10_000)  # else a tenth of a short command's time goes into garbage collection
    settle_environment()
    say.prepare_streams()
    code = run(groups, sys.argv[1:])
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
    say.flush()
    sys.exit(code)


def settle_environment() -> None:
    """Take away what would stop a library, and widths in which help cannot be set."""
    for name in ("MPLBACKEND", "NUMBA_NUM_THREADS"):
        os.environ.pop(name, None)
    # in two columns or in ten million, help takes for ever
    os.environ["COLUMNS"] = str(min(max(shutil.get_terminal_size().columns, 40), 200))


ended: list[int] = []
"""Signals that came: compiled code may lose the exception of one, so a run looks here, too."""


def _end(number: int, _: Any) -> None:
    ended.append(number)
    raise KeyboardInterrupt(number)


def _on_lost(lost: sys.UnraisableHookArgs) -> None:
    """Raise again an interruption that a destructor or a callback of the compiler swallows."""
    if isinstance(lost.exc_value, KeyboardInterrupt):
        threading.Timer(0.02, os.kill, [os.getpid(), signal.SIGINT]).start()
    else:
        sys.__unraisablehook__(lost)


def run(groups: Groups, arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    try:
        code = _answer(groups, arguments)
        sys.stdout.flush()
    except KeyboardInterrupt as stop:
        kept = [each for each in stop.args if isinstance(each, str)]
        number = next((each for each in stop.args if isinstance(each, int)), signal.SIGINT)
        kind = "interrupted" if number == signal.SIGINT else signal.Signals(number).name
        say.say("; ".join([f"rocking: {kind}", *kept]))
        return 128 + number
    except (BrokenPipeError, SystemExit) as stop:
        # what sets the help makes another of it
        if BrokenPipeError not in (type(stop), type(stop.__context__)):
            raise
        say.give_up_output()  # whoever read the output has gone
        return 128 + signal.SIGPIPE
    except (OSError, ImportError) as error:
        return say.refuse(say.reason(error))
    except (ArithmeticError, MemoryError, ValueError) as error:
        if REFUSAL.match(str(error)):
            return say.refuse(str(error))
        domain = str(error) == "math domain error" or type(error).__name__ == "LinAlgError"
        if isinstance(error, ValueError) and not domain:
            raise  # an error of the program
        words = "the numbers given are too small, too large or too many to compute with"
        return say.refuse(f"{words} ({say.one_line(error)})")
    return code


class Postponed(ModuleType):
    """Stands for a module until an attribute is asked for; LazyLoader loads at a second import."""

    def __getattr__(self, attribute: str) -> Any:
        """Load the module, and return its attribute."""
        if sys.modules.get(self.__name__) is self:
            sys.modules.pop(self.__name__, None)
        loaded = import_module(self.__name__)
        self.__dict__.update(loaded.__dict__)
        return getattr(loaded, attribute)


def postpone(name: str) -> None:
    """Let imports of a module that is not loaded yet give one that loads it when it is used."""
    sys.modules.setdefault(name, Postponed(name))


def make_app(groups: Groups, chosen: str = "") -> App:
    """Return the command line; the chosen command is loaded, others when they are asked for."""
    from cyclopts import App, Group, Parameter

    def version() -> str:
        from studies.kit.store import project_version

        return project_version()

    app = App(
        name="rocking",
        help="A rocking block: the exact solution, its linearizations, physics engines.",
        help_format="markdown",
        help_formatter="default",
        version=version,
        default_parameter=Parameter(negative=()),
        suppress_keyboard_interrupt=False,
    )
    app.register_install_completion_command(add_to_startup=False)
    for place, (title, commands) in enumerate(groups.items()):
        group = Group(title, sort_key=place)
        for number, (name, purpose) in enumerate(commands.items()):
            module = f"studies.{PLACES.get(name, name)}"
            shown: Any = {"group": group, "sort_key": number}
            if name == chosen:
                app.command(import_module(module).command, name=name, **shown)
            else:
                app.command(f"{module}:command", name=name, help=purpose, **shown)
    return app


def _answer(groups: Groups, arguments: Sequence[str]) -> int:
    from cyclopts import CycloptsError, UnknownOptionError

    postpone("pandas")
    if "--version" in arguments and len(arguments) > 1:
        return say.refuse(f"--version is one of {len(arguments)} arguments; it must stand alone")
    for before, argument in itertools.pairwise(["COMMAND", *arguments]):
        name, equals, value = argument.partition("=")
        if not argument.strip() or (name.startswith("--") and equals and not value.strip()):
            return say.refuse(f"{name.strip() or before} is empty; it must be given")
    from studies.cases.refusal import BadInputError

    try:
        code = make_app(groups, arguments[0] if arguments else "")(
            arguments,
            exit_on_error=False,
            print_error=False,
            verbose=False,
            result_action="return_value",
        )
    except UnknownOptionError as error:
        return say.refuse(_unknown_option(error))
    except (CycloptsError, BadInputError) as error:
        return say.refuse(str(error))
    return code if isinstance(code, int) else 0


def _unknown_option(error: UnknownOptionError) -> str:
    """Return the refusal of an option that a command does not have, with the one it is like."""
    from engines.settings import perhaps

    given = (error.token.keyword or error.token.value).partition("=")[0]
    names = [name for each in error.argument_collection for name in each.names]
    options = [name for name in names if name.startswith("--")]
    command = " ".join(error.command_chain or ()) or "rocking"
    return (
        f"{given} is no option of {command}{perhaps(given, options)}; it takes {', '.join(options)}"
    )
