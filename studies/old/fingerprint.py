"""Which code makes something: found by following names, and hashed without comments.

A function depends on its own definition and on every one that it mentions, directly or by way of
others, in whichever module it stands and by whatever way it is imported. Statements that bind no
name run when their module is imported, and count with all that is taken from it. Annotations are
not followed, nor is text; what a name means only at run time is declared (`studies.old.identity`).
"""

import ast
import hashlib
import sys
from collections.abc import Callable, Collection, Iterable, Iterator
from dataclasses import dataclass, field
from functools import cache, partial
from pathlib import Path
from typing import Any

ROOT = Path(__file__).parents[__name__.count(".")]
"""The folder of the packages, wherever in them this module stands."""

PACKAGES = ("analytic", "engines", "studies")

OF_TYPES = ("annotation", "returns")
"""Parts of a syntax tree that are annotations."""

files_elsewhere: dict[str, str] = {}
"""Module -> its file, of modules that are loaded in another process, and not in this one."""

Name = tuple[str, str]
"""A module and what is defined at its top level; all of it where that is empty."""


@dataclass(slots=True)
class Piece:
    """A statement at the top level of a module.

    Attributes
    ----------
    digest : str
        Of the statement, without comments, docstrings, layout and annotations of functions.
    uses : set of str
        Names that it mentions, with their attributes, as in "np.pi".
    links : dict
        What it imports itself, as in `Module`.
    """

    digest: str = ""
    uses: set[str] = field(default_factory=set)
    links: dict[str, Name] = field(default_factory=dict)


@dataclass(slots=True)
class Module:
    """What a module consists of.

    Attributes
    ----------
    pieces : dict
        Name -> the statements that define it; "" -> those that bind no name.
    links : dict
        Name -> the module that it was imported from and its name there, "" for a whole module.
    """

    pieces: dict[str, list[Piece]] = field(default_factory=dict)
    links: dict[str, Name] = field(default_factory=dict)


def names_of(something: Callable[..., Any]) -> set[Name]:
    """Return the definition that a function stands in, and those of functions that it was given."""
    if kept := getattr(something, "definitions", None):
        return set(kept)  # of a function that is not loaded here
    given: set[Name] = set()
    while isinstance(something, partial):
        given = given.union(*(names_of(value) for value in something.args if callable(value)))
        something = something.func
    return {name_of(something), *given}


def name_of(something: Callable[..., Any]) -> Name:
    """Return the definition that a function, a class or a part of either stands in."""
    while isinstance(something, partial):
        something = something.func
    whole = getattr(something, "py_func", something)
    return whole.__module__, whole.__qualname__.partition(".")[0]


def reached(names: Iterable[Name], root: Path = ROOT, *, cut: Collection[Name] = ()) -> "Reached":
    """Return the code that some definitions depend on, their own among it.

    Parameters
    ----------
    names : iterable of (str, str)
        As `name_of` returns them. A package of another project that one of them stands in is
        followed, too, from where it was imported.
    root : Path, optional
        The folder of the packages.
    cut : collection of (str, str), optional
        Definitions that are not followed, nor counted.
    """
    names = list(names)
    found = Reached(root, {module.partition(".")[0] for module, _ in names}, cut)
    for name in names:
        found.take(*name)
    return found


def everything(root: Path = ROOT) -> str:
    """Return a hash of all code of the packages."""
    digest = hashlib.sha256()
    for package in PACKAGES:
        for path in sorted((root / package).rglob("*.py")):
            pieces = read(_dotted(path, root), path).pieces
            whole = [piece.digest for name in sorted(pieces) for piece in pieces[name]]
            digest.update(f"{path.relative_to(root)} {whole}\n".encode())
    return digest.hexdigest()[:12]


class Reached:
    """Definitions that were reached so far, and those that they mention.

    Parameters
    ----------
    root : Path
        The folder of the packages.
    further : collection of str
        Packages that are followed besides.
    cut : collection of (str, str)
        Definitions that are left out.

    Attributes
    ----------
    names : set of (str, str)
    """

    def __init__(self, root: Path, further: Collection[str], cut: Collection[Name]) -> None:
        self.names: set[Name] = set()
        self._root = root
        self._further = frozenset(further)
        self._cut = frozenset(cut)
        self._pending: list[Name] = []

    def take(self, module: str, name: str) -> None:
        """Take in a definition and all that it depends on."""
        self._reach(module, [name] if name else [])
        while self._pending:
            module, name = self._pending.pop()
            known = self._module(module)
            for piece in known.pieces.get(name, ()) if known else ():
                for use in piece.uses:
                    first, *rest = use.split(".")
                    link = piece.links.get(first)
                    if link:
                        self._follow(link, rest)
                    else:
                        self._reach(module, [first])
                        self._through(module, first, rest)
                for link in piece.links.values():
                    self._follow(link, [])

    def digests(self) -> dict[str, str]:
        """Return the file of each module that was reached -> a hash of what of it was."""
        parts: dict[str, list[str]] = {}
        for module, name in sorted(self.names):
            known = self._module(module)
            if known and name in known.pieces:
                lines = [f"{name} {piece.digest}" for piece in known.pieces[name]]
                parts.setdefault(module, []).extend(lines)
        return {
            self._shown(module): hashlib.sha256("\n".join(lines).encode()).hexdigest()[:12]
            for module, lines in parts.items()
        }

    def _through(self, module: str, name: str, rest: list[str]) -> None:
        """Follow the attributes of a name that a module imported."""
        known = self._module(module)
        if rest and known and name in known.links:
            self._follow(known.links[name], rest)

    def _follow(self, link: Name, rest: list[str]) -> None:
        """Follow what was imported, and its attributes as far as they lead to modules."""
        module, name = link
        path = [name, *rest] if name else rest
        while path and not self._binds(module, path[0]) and self._file(f"{module}.{path[0]}"):
            module, path = f"{module}.{path[0]}", path[1:]
        if path:
            self._reach(module, path[:1])
            self._through(module, path[0], path[1:])

    def _binds(self, module: str, name: str) -> bool:
        """Return whether a module itself has a name, which then is not one inside its package."""
        known = self._module(module)
        return known is not None and (name in known.pieces or name in known.links)

    def _reach(self, module: str, names: list[str]) -> None:
        """Reach a definition by a name in a module, or, without one, all of the module's."""
        known = self._module(module)
        if known is None:
            return
        for name in names or known.pieces:
            if (module, name) in self._cut or (module, name) in self.names:
                continue
            if name in known.pieces:
                self.names.add((module, name))
                self._pending.append((module, name))
                self._import(module)
            elif name in known.links:
                self.names.add((module, name))
                self._import(module)
                self._follow(known.links[name], [])

    def _import(self, module: str) -> None:
        """Count what runs when a module is imported, and the packages around it."""
        parts = module.split(".")
        for count in range(len(parts), 0, -1):
            around = (".".join(parts[:count]), "")
            if around not in self.names:
                self.names.add(around)
                self._pending.append(around)

    def _module(self, name: str) -> Module | None:
        path = self._file(name)
        return None if path is None else read(name, path)

    def _file(self, name: str) -> Path | None:
        """Return the source of a module that is followed."""
        package = name.partition(".")[0]
        if package in PACKAGES:
            return _inside(name, self._root)
        loaded = getattr(sys.modules.get(name), "__file__", None) or files_elsewhere.get(name)
        path = Path(loaded) if loaded and package in self._further else None
        return path if path and path.suffix == ".py" else None

    def _shown(self, module: str) -> str:
        path = self._file(module)
        inside = path and path.is_relative_to(self._root)
        return path.relative_to(self._root).as_posix() if path and inside else f"{module}.py"


def _dotted(path: Path, root: Path) -> str:
    return ".".join(path.relative_to(root).with_suffix("").parts).removesuffix(".__init__")


@cache
def _inside(name: str, root: Path) -> Path | None:
    place = root.joinpath(*name.split("."))
    files = (place.with_name(f"{place.name}.py"), place / "__init__.py")
    return next((path for path in files if path.is_file()), None)


@cache
def read(name: str, path: Path) -> Module:
    """Return the definitions of a module."""
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    found = Module()
    for statement in _Bare().visit(ast.parse(path.read_bytes())).body:
        if isinstance(statement, ast.Import | ast.ImportFrom):
            found.links |= _links(statement, package)
            continue
        piece = _piece(statement, package)
        for bound in set(_bound(statement, found)) or {""}:
            found.pieces.setdefault(bound, []).append(piece)
        if not isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
            found.links |= piece.links
    return found


class _Bare(ast.NodeTransformer):
    """Takes away what runs nowhere: docstrings, annotations, and what type checkers alone see."""

    def visit(self, node: ast.AST) -> Any:
        for name in OF_TYPES:
            if hasattr(node, name):
                setattr(node, name, None)
        return super().visit(node)

    def visit_Expr(self, node: ast.Expr) -> ast.AST | None:
        value = node.value
        is_text = isinstance(value, ast.Constant) and isinstance(value.value, str)
        return None if is_text else self.generic_visit(node)

    def visit_If(self, node: ast.If) -> ast.AST | list[ast.stmt]:
        self.generic_visit(node)
        name = node.test.attr if isinstance(node.test, ast.Attribute) else node.test
        name = name.id if isinstance(name, ast.Name) else name
        return node.orelse if name == "TYPE_CHECKING" else node


def _piece(statement: ast.stmt, package: str) -> Piece:
    """Return what a statement consists of."""
    piece = Piece()
    for node in ast.walk(statement):
        if isinstance(node, ast.Import | ast.ImportFrom):
            piece.links |= _links(node, package)
        elif isinstance(node, ast.Name | ast.Attribute) and (chain := _chain(node)):
            piece.uses.add(chain)
    shape: list[str] = []
    _add_shape(statement, shape)
    piece.digest = hashlib.sha256("\n".join(shape).encode()).hexdigest()[:16]
    return piece


def _add_shape(value: object, shape: list[str]) -> None:
    """Add to a shape that of a part of a syntax tree."""
    if isinstance(value, ast.AST):
        shape.append(type(value).__name__)
        for name in value._fields:
            if name not in OF_TYPES:
                _add_shape(getattr(value, name, None), shape)
    elif isinstance(value, list):
        shape.append("[")
        for inside in value:
            _add_shape(inside, shape)
        shape.append("]")
    else:
        shape.append(repr(value))


def _bound(statement: ast.AST, found: Module) -> Iterator[str]:
    """Yield the names that a statement defines, or adds to."""
    if isinstance(statement, ast.FunctionDef | ast.AsyncFunctionDef | ast.ClassDef):
        yield statement.name
        # as `@shown.register` adds to `shown`
        for decorator in statement.decorator_list:
            adding = decorator.func if isinstance(decorator, ast.Call) else decorator
            owner = adding.value if isinstance(adding, ast.Attribute) else None
            if isinstance(owner, ast.Name) and owner.id in found.pieces:
                yield owner.id
    elif isinstance(statement, ast.Name) and isinstance(statement.ctx, ast.Store):
        yield statement.id
    elif not isinstance(statement, ast.comprehension | ast.Lambda):
        for inside in ast.iter_child_nodes(statement):
            yield from _bound(inside, found)


def _links(node: ast.Import | ast.ImportFrom, package: str) -> dict[str, Name]:
    """Return what an import binds."""
    if isinstance(node, ast.Import):
        return {
            alias.asname or alias.name.partition(".")[0]: (
                (alias.name if alias.asname else alias.name.partition(".")[0]),
                "",
            )
            for alias in node.names
        }
    base = node.module or ""
    if node.level:
        parts = package.split(".")
        kept = parts[: len(parts) - node.level + 1]
        base = ".".join([*kept, *filter(None, [node.module])])
    return {alias.asname or alias.name: (base, alias.name) for alias in node.names}


def _chain(node: ast.Name | ast.Attribute) -> str:
    """Return a name with its attributes; an empty string if it begins with something else."""
    parts: list[str] = []
    inner: ast.expr = node
    while isinstance(inner, ast.Attribute):
        parts.append(inner.attr)
        inner = inner.value
    return ".".join([inner.id, *reversed(parts)]) if isinstance(inner, ast.Name) else ""
