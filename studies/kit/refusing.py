"""A refusal as a user sees it: one line, whatever it repeats."""

from studies.kit import streams

LONGEST_WORD, LONGEST_LINE = 255, 1000
"""Letters of a refusal beyond which the middle of a word, and of the line, is left out."""


def refuse(message: str) -> int:
    """Say why a command cannot be run; return the exit code."""
    streams.say(f"rocking: {brief(message)}")
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


def _shortened(text: str, longest: int) -> str:
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]}…{text[-half:]}"
