"""What a user is told beside the results: in one line, by streams that can be written to."""

import errno
import io
import os
import sys
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path

LONGEST_WORD, LONGEST_LINE = 255, 1000
"""Letters of a refusal beyond which the middle of a word, and of the line, is left out."""


def refuse(message: str) -> int:
    """Say why a command cannot be run; return the exit code."""
    say(f"rocking: {brief(message)}")
    return 2


def brief(message: str) -> str:
    """Return a message in one line that a terminal can show, whatever values it repeats."""
    words = (_shortened(word, LONGEST_WORD) for word in message.split())
    line = _shortened(" ".join(words), LONGEST_LINE)
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in line)


def one_line(error: BaseException) -> str:
    """Return an exception in one line, its kind first, whatever it does when it is printed."""
    kind = type(error).__name__
    try:
        return brief(f"{kind}: {error}".removesuffix(": "))
    except BaseException:
        return kind


def reason(error: Exception, arguments: Sequence[str]) -> str:
    """Return why a command could not go on; of a file or folder also the option that names it.

    Parameters
    ----------
    error : Exception
        Of the system, or one that was raised because of another.
    arguments : sequence of str
        Of the command line.
    """
    if not isinstance(error, OSError):
        while isinstance(error.__cause__, Exception):
            error = error.__cause__
        return one_line(error)
    if not error.filename:
        full = error.errno == errno.ENOSPC
        return f"the output cannot be written; {error.strerror}" if full else str(error)
    option, place = "", Path(os.fsdecode(error.filename))
    for word in arguments:
        option, _, value = word.partition("=") if word.startswith("--") else (option, "", word)
        if option and value and place.is_relative_to(value):
            inside = "" if place == Path(value) else f"{place.relative_to(value)}: "
            return f"{option} is {value!r}; {inside}{error.strerror}"
    return str(error)


def _shortened(text: str, longest: int) -> str:
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]}…{text[-half:]}"


def prepare() -> None:
    """Send what goes to a closed stream nowhere, and show what a terminal cannot as marks.

    A descriptor that stays free would be taken by the next file that is opened, and whatever an
    engine prints would go into it.
    """
    for number in range(3):
        try:
            os.fstat(number)
        except OSError:
            os.set_inheritable(os.open(os.devnull, os.O_RDWR), True)
    sys.stdout = sys.stdout or os.fdopen(1, "w", closefd=False)
    sys.stderr = sys.stderr or os.fdopen(2, "w", closefd=False)
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            # a terminal without Greek letters shows question marks instead
            stream.reconfigure(errors="replace")


def say(line: str) -> None:
    """Write a line to stderr, if somebody is there to read it."""
    with suppress(OSError):
        print(line, file=sys.stderr)


def finish() -> None:
    """Write what is waiting to be written, or give it up where that has failed before."""
    try:
        sys.stdout.flush()
    except OSError:
        give_up_output()


def give_up_output() -> None:
    """Send further output nowhere, what is waiting to be written included."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
