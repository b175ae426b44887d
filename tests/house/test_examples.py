"""What a user imports has an example that gives what it prints; what is cited stands there."""

import doctest
import importlib
import inspect
import re
from enum import Enum

import pytest
from commanding import ROOT

TOLD = {"History", "Impact", "Modes", "Response", "Motion", "Rocker"}
"""What is answered, and what an argument must have: nobody makes these."""

NAMES = [
    (package, name)
    for package in ("analytic", "engines", "studies")
    for name, value in inspect.getmembers(importlib.import_module(package))
    if name in importlib.import_module(package).__all__ and name not in TOLD
    if inspect.isfunction(value) or (inspect.isclass(value) and not issubclass(value, Enum))
]


@pytest.mark.parametrize(("package", "name"), NAMES, ids=lambda word: word)
def test_an_example_gives_what_it_prints(package, name):
    module = importlib.import_module(package)
    found = doctest.DocTestFinder(recurse=False).find(
        getattr(module, name), name, globs=dict(vars(module))
    )
    assert found and found[0].examples
    assert doctest.DocTestRunner().run(found[0]).failed == 0


def test_every_heading_that_is_cited_exists():
    page = (ROOT / "analytic/EQUATIONS.md").read_text()
    headings = set(re.findall(r"^(?:## |\*\*)([^*\n]+?)\.?(?:\*\*|$)", page, re.MULTILINE))
    sources = [path for name in ("analytic", "engines") for path in (ROOT / name).rglob("*.py")]
    named = re.compile(r'EQUATIONS\.md(?:,\s+"([^"]+)")?')
    cited = {heading for path in sources for heading in named.findall(path.read_text())}
    assert cited and {" ".join(heading.split()) for heading in cited} <= headings
