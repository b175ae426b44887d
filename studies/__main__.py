"""The command line: `rocking`, and `python -m studies`."""

import sys

from studies import page
from studies.catalogue import STUDIES
from studies.kit import app, signals, streams

COMMANDS = (*STUDIES, page.REPORT, page.REDRAW, page.README)
"""Every command."""


def run(arguments: list[str]) -> int:
    """Run one command; return its exit code: 0 usable, 1 some rows failed, 2 bad input."""
    return app.run(COMMANDS, arguments)


LONGEST_WORD, LONGEST_LINE = 80, 1000
"""Letters of a refusal beyond which the middle of a word, and of the line, is left out."""


def brief(message: str) -> str:
    """Return a message in one line that a terminal can show, whatever values it repeats."""
    words = (_shortened(word, LONGEST_WORD) for word in message.split())
    line = _shortened(" ".join(words), LONGEST_LINE)
    return "".join(letter if letter.isprintable() else ascii(letter)[1:-1] for letter in line)


def _shortened(text: str, longest: int) -> str:
    half = longest // 2
    return text if len(text) <= longest else f"{text[:half]}…{text[-half:]}"


def main() -> None:
    """Run the command that the arguments name, and exit."""
    signals.install()
    app.settle_environment()
    streams.prepare()
    code = run(sys.argv[1:])
    signals.ignore()
    streams.finish()
    sys.exit(code)


if __name__ == "__main__":
    main()
