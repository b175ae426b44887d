"""What goes wrong in each library, and the smallest script that shows it with that library alone.

Each script prints a version, what is expected with its formula, what is found and the mechanism,
and ends with 0 while the trouble is there. Nothing that computes imports this.
"""

import ast
from dataclasses import dataclass
from pathlib import Path

from engines import ENGINES

OTHERS = {"mjx": ("MJX", "mujoco.mjx"), "warp": ("MuJoCo Warp", "mujoco_warp")}
"""Libraries that are no engine here -> what they are called, and the module to import."""


@dataclass(frozen=True, slots=True, kw_only=True)
class Trouble:
    """What a script shows, as its docstring says.

    Attributes
    ----------
    engine, called, library : str
        Name of the engine, what a reader sees, and the module that the script imports.
    script : str
        Name of the file.
    title, mechanism, kind : str
        What a user sees, by what it comes about, and which kind of mechanism that is.
    """

    engine: str
    called: str
    library: str
    script: str
    title: str
    mechanism: str
    kind: str


def _read(path: Path) -> Trouble:
    engine = path.name.partition("_")[0]
    called, library = OTHERS.get(engine) or (ENGINES[engine].title, ENGINES[engine].library)
    title, mechanism, kind = str(ast.get_docstring(ast.parse(path.read_text()))).split("\n\n")
    return Trouble(
        engine=engine,
        called=called,
        library=library,
        script=path.name,
        title=title,
        mechanism=" ".join(mechanism.split()),
        kind=kind.removeprefix("Kind: "),
    )


TROUBLES = tuple(_read(path) for path in sorted(Path(__file__).parent.glob("[a-z]*_*.py")))
"""Every trouble for which there is a script."""
