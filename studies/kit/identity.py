"""What made a row: the versions of what computes, and the files whose code it runs through."""
# A row of a model depends on `analytic`, one of an engine on what engines share and on its own
# files, and both on the file that measured it and what that imports of `studies`.

import ast
import hashlib
import platform
import re
from collections.abc import Callable, Iterable, Mapping
from functools import cache
from importlib import import_module, metadata
from inspect import getsourcefile, unwrap
from pathlib import Path
from typing import Any

import engines
from engines.registry import OWN
from studies.sources.registry import Source

ENGINES_AT = Path(engines.__file__).parent
ROOT = ENGINES_AT.parent
COMPUTING = ("numpy", "scipy", "numba")
"""Packages that a number may depend on."""
NOT_INSTALLED = "not installed"
COUNTING = re.compile(r"studies\.(?!(kit|drawing|page)\b)")
"""Modules of `studies` that a number may depend on."""
ANSWER = ROOT / "studies" / "kit" / "jobs.py"
SOURCES = ROOT / "studies" / "sources"

Maker = Mapping[str, str]
"""What made a row: what it depends on -> its version, or a digest of its code."""


def version_of(package: str) -> str:
    """Return the version of an installed package, `NOT_INSTALLED` without it."""
    try:
        return metadata.version(package)
    except metadata.PackageNotFoundError:
        return NOT_INSTALLED


@cache
def code_in(*paths: Path) -> str:
    """Return a digest of the modules in some files and folders, without comments and docstrings."""
    files = [file for path in paths for file in ([path] if path.is_file() else path.rglob("*.py"))]
    bare = [f"{file.name} {_bare(file)}" for file in sorted(set(files))]
    return hashlib.sha256("\n".join(bare).encode()).hexdigest()[:12]


@cache
def _bare(file: Path) -> str:
    tree = ast.parse(file.read_bytes())
    for node in ast.walk(tree):
        if isinstance(body := getattr(node, "body", None), list):
            node.body = [each for each in body if not _is_text(each)]  # type: ignore[attr-defined]
    return hashlib.sha256(ast.dump(tree).encode()).hexdigest()


def _is_text(node: ast.AST) -> bool:
    value = getattr(node, "value", None)
    return isinstance(node, ast.Expr) and isinstance(getattr(value, "value", None), str)


@cache
def files_of(module: str) -> frozenset[Path]:
    """Return the file of a module of `studies` and of those of `studies` that it imports."""
    found: set[Path] = set()
    pending = [module]
    while pending:
        path = ROOT / pending.pop().replace(".", "/")
        for file in {path.with_suffix(".py"), path / "__init__.py"} - found:
            if not file.is_file():
                continue
            found.add(file)
            for node in ast.parse(file.read_bytes()).body:
                if isinstance(node, ast.ImportFrom) and COUNTING.match(name := node.module or ""):
                    pending += [name, *(f"{name}.{each.name}" for each in node.names)]
    return frozenset(found)


def _code_of(module: str) -> Path:
    """Return the folder or file of an engine by the module of its builder."""
    package, _, rest = module.partition(".")
    if package == ENGINES_AT.name:
        place = ENGINES_AT / rest.partition(".")[0]
        return place if place.is_dir() else place.with_suffix(".py")
    file = Path(getsourcefile(import_module(package)) or "")
    return file.parent if file.name == "__init__.py" else file


@cache
def maker_of(source: Source, measure: Callable[..., Any]) -> Maker:
    """Return what makes the rows of a source that a function measures."""
    measured = files_of(unwrap(measure).__module__) | {ANSWER}
    packages = (*COMPUTING, *(source.declared.packages if source.engine else ()))
    made = {
        "Python": ".".join(platform.python_version_tuple()[:2]),
        **{name: version_of(name) for name in packages},
    }
    reference = code_in(*(ROOT / "analytic").rglob("*.py"))
    if not source.engine:
        made["analytic"] = reference
        return {**made, "studies": code_in(*measured, SOURCES)}
    describing = ("block", "checks", "frame", "slide", "motion", "record", "response")
    known = (ROOT / "analytic" / f"{name}.py" for name in describing)
    # what a study measures may take the exact solution beside the engine's answer
    made["analytic"] = code_in(*known) if measured == {ANSWER} else reference
    shared = [*ENGINES_AT.glob("*.py"), *(ENGINES_AT / "run").glob("*.py")]
    made["engines"] = code_in(*(file for file in shared if file.stem not in (*OWN, "export")))
    made["studies"] = code_in(*measured, SOURCES / "registry.py")
    return {**made, f"code of {source.engine}": code_in(_code_of(source.declared.build.__module__))}


def changed(then: Maker, now: Maker) -> list[str]:
    """Return what made a row and would make another one now."""
    # a version counts only where there is one: what was made elsewhere cannot be made anew here
    return [
        name
        for name in {**now, **then}
        if then.get(name) != now.get(name) and now.get(name) != NOT_INSTALLED
    ]


def why(stale: Iterable[tuple[str, Maker, Maker]]) -> str:
    """Say of rows that are computed again whose they are, and what made them that differs now."""
    reasons = {source: ", ".join(changed(then, now)[:3]) for source, then, now in stale}
    return "; ".join(f"{source}: other {names}" for source, names in reasons.items())
