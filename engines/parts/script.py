"""A scene written out in a library's own words, for somebody who has that library alone.

What builds an engine's scene is a plain function of the library, the settings ``s`` and the numbers
``n`` of the scene. A run calls it; a script has its source, with the values filled in.

An engine's own ``script(scene, settings, dt_s)`` returns the `Script` of a scene, whose frame says
whether its base moves, with settings of the engine and ordinary steps dt_s [s], which the script
calls `DT`. ValueError, where a base would be moved in a way that no line stands for.
"""

import ast
import inspect
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from textwrap import dedent
from typing import Any, NamedTuple

from engines.scene import Scene
from engines.settings import one_of
from engines.world import Script

SETTINGS = "s"
"""The parameter of such a function that holds settings."""

GETATTR = re.compile(r"getattr\(([\w.]+), '(\w+)'\)")
"""A part of the library whose name was filled in."""

__all__ = ["Line", "Script", "defined", "filled", "moved", "settings_of"]


class Line(NamedTuple):
    """A line of a script, and whether a setting stands in it or decides that it is there."""

    text: str
    setting: bool


def settings_of(lines: Sequence[Line]) -> tuple[str, ...]:
    """Return the lines of settings, without what indents them or loops over them."""
    said = (line.text.strip() for line in lines if line.setting)
    return tuple(text for text in said if not text.endswith(":"))


def filled(function: Callable[..., Any], **values: Any) -> tuple[Line, ...]:
    """Return the body of a function as lines of a script, with values filled in.

    Parameters
    ----------
    function : callable
        Its docstring is left out, and what it returns in the end: its variables are the script's.
        So is an ``if`` that the values decide, with all but the branch that is taken; a ``for``
        over values is its body for each; comments stay that stand on a line with code.
    **values
        Its parameters whose attributes are filled in, by name. What is after ``*`` or ``**``
        becomes arguments, and ``getattr`` with a name an attribute.

    Returns
    -------
    tuple of Line
    """
    return tuple(_Filling(function, values).lines(returns=False))


def defined(function: Callable[..., Any], **values: Any) -> tuple[Line, ...]:
    """Return a function as lines of a script, with values in place of the parameters so called."""
    others = [name for name in inspect.signature(function).parameters if name not in values]
    said = (inspect.getdoc(function) or "").partition("\n")[0]
    head = f"def {function.__name__}({', '.join(others)}):", f'    """{said}"""'
    lines = _Filling(function, values).lines(returns=True)
    body = (Line(f"    {text}", setting) for text, setting in lines)
    apart = (Line("", False),) * 2
    return (*apart, *(Line(text, False) for text in head), *body, *apart)


def moved(scene: Scene, floor: str, unit: float, ways: Mapping[str, Sequence[str]]) -> list[str]:
    """Return the lines by which a script moves a base before a step; none where it is at rest.

    Parameters
    ----------
    scene : Scene
    floor : str
        How a base that moves is moved.
    unit : float
        Units of length in a metre.
    ways : mapping
        A floor -> its lines, with the place {x} and the velocity {v} of the base to be filled in.

    Raises
    ------
    ValueError
        If a base that moves cannot be moved so.
    """
    if scene.frame != "world":
        return []
    one_of("floor of a script", floor, tuple(ways))
    times = "" if unit == 1.0 else f" * {unit!r}"
    return [line.format(x=f"base_x{times}", v=f"base_velocity{times}") for line in ways[floor]]


class _Filling:
    """The source of a function, and what is filled in."""

    def __init__(self, function: Callable[..., Any], values: Mapping[str, Any]) -> None:
        text = dedent(inspect.getsource(function))
        self._source, self._values = text.splitlines(), dict(values)
        (definition,) = ast.parse(text).body
        assert isinstance(definition, ast.FunctionDef)
        self._body = definition.body[1:]  # after the docstring

    def lines(self, *, returns: bool) -> Iterator[Line]:
        """Yield the lines, without what is returned in the end or with it."""
        ends = not returns and isinstance(self._body[-1], ast.Return)
        yield from self._block(self._body[:-1] if ends else self._body, "", False)

    def _block(self, body: Sequence[ast.stmt], indent: str, setting: bool) -> Iterator[Line]:
        for statement in body:
            if isinstance(statement, ast.If) and self._decided(statement.test):
                branch = statement.body if self._value(statement.test) else statement.orelse
                yield from self._block(branch, indent, setting or self._sets(statement.test))
            elif isinstance(statement, ast.For) and self._decided(statement.iter):
                assert isinstance(statement.target, ast.Name)
                for item in self._value(statement.iter):
                    self._values[statement.target.id] = item
                    yield from self._block(statement.body, indent, setting)
            elif isinstance(statement, ast.For | ast.With | ast.If):
                first = statement.body[0].lineno - 1
                yield from self._written(statement, first, indent, setting)
                yield from self._block(statement.body, f"{indent}    ", setting)
                if not isinstance(statement, ast.With) and statement.orelse:
                    yield Line(f"{indent}else:", setting)
                    yield from self._block(statement.orelse, f"{indent}    ", setting)
            else:
                last = statement.end_lineno or statement.lineno
                yield from self._written(statement, last, indent, setting)

    def _written(
        self, statement: ast.stmt, last: int, indent: str, setting: bool
    ) -> Iterator[Line]:
        """Yield the lines of a statement up to one of the source, with values filled in."""
        lines = self._source[statement.lineno - 1 : last]
        places = [node for node in self._known(statement) if node.lineno <= last]
        for node in sorted(places, key=lambda node: (node.lineno, node.col_offset), reverse=True):
            row, start, end = node.lineno - statement.lineno, node.col_offset, node.end_col_offset
            before, after, value = lines[row][:start], lines[row][end:], self._value(node)
            if before.endswith("**"):
                given = ", ".join(f"{name}={part!r}" for name, part in value.items())
                lines[row] = f"{before.removesuffix('**')}{given}{after}"
            elif before.endswith("*"):
                lines[row] = f"{before.removesuffix('*')}{', '.join(map(repr, value))}{after}"
            else:
                lines[row] = f"{before}{value!r}{after}"
        own = setting or any(self._sets(node) for node in places)
        text = GETATTR.sub(r"\1.\2", dedent("\n".join(lines)))
        text = re.sub(r"\Aelif\b", "if", text)  # it stands below an else
        yield from (Line(f"{indent}{line}", own) for line in text.splitlines())

    def _known(self, statement: ast.stmt) -> list[ast.Attribute]:
        return [
            node
            for node in ast.walk(statement)
            if isinstance(node, ast.Attribute)
            and isinstance(node.value, ast.Name)
            and node.value.id in self._values
        ]

    def _decided(self, test: ast.expr) -> bool:
        """Return whether all names in a test are values."""
        names = {node.id for node in ast.walk(test) if isinstance(node, ast.Name)}
        return names <= self._values.keys()

    def _sets(self, node: ast.AST) -> bool:
        return any(isinstance(part, ast.Name) and part.id == SETTINGS for part in ast.walk(node))

    def _value(self, node: ast.expr) -> Any:
        code = compile(ast.Expression(node), "<values>", "eval")
        return eval(code, {"__builtins__": {}}, dict(self._values))
