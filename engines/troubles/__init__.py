"""What goes wrong in each library, and the smallest script that shows it with that library alone.

Each script prints a version, what is expected with its formula, what is found and the mechanism,
and ends with 0 while the trouble is there. Nothing that computes imports this.
"""

import ast
from pathlib import Path
from typing import NamedTuple

from engines import ENGINES


class Trouble(NamedTuple):
    """What a script shows, as its docstring says: a title, its mechanism, and the kind of that."""

    engine: str
    called: str
    script: str
    title: str
    mechanism: str
    kind: str


def _read(path: Path) -> Trouble:
    engine = path.name.partition("_")[0]
    title, mechanism, kind = str(ast.get_docstring(ast.parse(path.read_text()))).split("\n\n")
    words = title, " ".join(mechanism.split()), kind.removeprefix("Kind: ")
    return Trouble(engine, ENGINES[engine].title, path.name, *words)


TROUBLES = tuple(_read(path) for path in sorted(Path(__file__).parent.glob("[a-z]*_*.py")))
"""Every trouble for which there is a script."""
