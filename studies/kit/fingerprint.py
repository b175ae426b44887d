"""Which code makes a study's rows: found by its imports, and hashed without comments.

A row depends on every module that its study's own module imports, directly or by way of others, at
the top or inside functions. Two kinds are left out: modules that draw, which are known by importing
matplotlib, and what is imported only to read finished tables (`READERS`). All else counts, whether
or not a row comes of it: a row too many is computed again rather than one kept too long.
"""

import ast
import hashlib
import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

ROOT = Path(__file__).parents[__name__.count(".")]
"""The folder of the packages, wherever in them this module stands."""

PACKAGES = ("analytic", "engines", "studies")
EVERY_STUDY = PACKAGES[-1] + "."
"""What `fingerprint` takes for all studies at once."""

READERS = frozenset({"headline", "paragraph", "pictures", "report"})
"""Functions of a study that read the tables of a finished folder."""

_NAME = re.compile(rf"(?:{'|'.join(PACKAGES)})(?:\.\w+)*")
"""Text that may be the name of a module, by which something else imports it."""


@dataclass(frozen=True, slots=True)
class Code:
    """What a module consists of.

    Attributes
    ----------
    digest : str
        Of its statements, without comments, docstrings, layout and what is for type checkers.
    imports : frozenset of str
        The modules that it imports or names; one that ends in a dot stands for all inside.
    draws : bool
        Whether importing it imports matplotlib.
    """

    digest: str
    imports: frozenset[str]
    draws: bool


def fingerprint(module: str, root: Path = ROOT) -> str:
    """Return a hash of the code that makes the rows of a study.

    Parameters
    ----------
    module : str
        The study's own.
    root : Path, optional
        The folder of the packages.
    """
    digest = hashlib.sha256()
    for name, code in sorted(reached(module, root).items()):
        digest.update(f"{name} {code.digest}\n".encode())
    return digest.hexdigest()[:12]


def reached(module: str, root: Path = ROOT) -> dict[str, Code]:
    """Return the modules that the rows of a study depend on, by name, its own among them."""
    found: dict[str, Code] = {}
    looked_for: set[str] = set()
    pending = [module]
    while pending:
        for name in _with_parents(pending.pop(), root):
            if name in looked_for:
                continue
            looked_for.add(name)
            if (path := _file(name, root)) is None:
                continue
            code = read(name, path)
            if name == module or not code.draws:
                found[name] = code
                pending += code.imports
    return found


def _with_parents(name: str, root: Path) -> Iterator[str]:
    """Yield a module and the packages around it, whose code runs before; or all inside of one."""
    if name.endswith("."):
        inside = root.joinpath(*name[:-1].split("."))
        for path in inside.rglob("*.py"):
            yield ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")
    parts = name.strip(".").split(".")
    yield from (".".join(parts[:count]) for count in range(len(parts), 0, -1))


def _file(name: str, root: Path) -> Path | None:
    place = root.joinpath(*name.split("."))
    files = (place.with_name(f"{place.name}.py"), place / "__init__.py")
    return next((path for path in files if path.is_file()), None)


@cache
def read(name: str, path: Path) -> Code:
    """Return the code of a module."""
    reading = _Reading(name if path.name == "__init__.py" else name.rpartition(".")[0])
    reading.see(ast.parse(path.read_bytes()))
    digest = hashlib.sha256("\n".join(reading.shape).encode()).hexdigest()
    return Code(digest, frozenset(reading.imports), reading.draws)


class _Reading:
    """One pass over a module's syntax tree."""

    def __init__(self, package: str) -> None:
        self.package = package
        self.shape: list[str] = []
        self.imports: set[str] = set()
        self.draws = False
        self._functions = 0

    def see(self, node: ast.AST) -> None:
        """Take in a node and all below it."""
        if _is_comment(node):
            return
        if isinstance(node, ast.If) and _is_for_type_checkers(node.test):
            self._see_all(node.orelse)
            return
        if isinstance(node, ast.Import | ast.ImportFrom):
            self._import(node)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str):
            self._word(node.value)
        inside = isinstance(node, ast.FunctionDef | ast.AsyncFunctionDef | ast.Lambda)
        self._functions += inside
        self.shape.append(type(node).__name__)
        for field in node._fields:
            self._see_field(getattr(node, field, None))
        self._functions -= inside

    def _see_field(self, value: object) -> None:
        if isinstance(value, ast.AST):
            self.see(value)
        elif isinstance(value, list):
            self.shape.append("[")
            self._see_all(value)
            self.shape.append("]")
        else:
            self.shape.append(repr(value))

    def _see_all(self, values: Iterable[object]) -> None:
        for value in values:
            self._see_field(value)

    def _import(self, node: ast.Import | ast.ImportFrom) -> None:
        names = [alias.name for alias in node.names]
        if isinstance(node, ast.ImportFrom):
            if READERS.issuperset(names):
                return
            base = self._base(node)
            names = [base, *(f"{base}.{name}" for name in names)]
        self.imports.update(names)
        self.draws |= not self._functions and names[0].partition(".")[0] == "matplotlib"

    def _base(self, node: ast.ImportFrom) -> str:
        if not node.level:
            return node.module or ""
        parts = self.package.split(".")
        return ".".join([*parts[: len(parts) - node.level + 1], *filter(None, [node.module])])

    def _word(self, text: str) -> None:
        """Follow text that names a module, one with a member, or the beginning of some."""
        name = text.partition(":")[0]
        if "." in name and _NAME.fullmatch(name.removesuffix(".")):
            self.imports.add(name)


def _is_comment(node: ast.AST) -> bool:
    """Whether a statement is nothing but a string, as docstrings are."""
    return (
        isinstance(node, ast.Expr)
        and isinstance(node.value, ast.Constant)
        and isinstance(node.value.value, str)
    )


def _is_for_type_checkers(test: ast.expr) -> bool:
    name = test.attr if isinstance(test, ast.Attribute) else getattr(test, "id", "")
    return name == "TYPE_CHECKING"
