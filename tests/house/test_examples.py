"""What a user imports has an example, and the examples give what they print."""

import doctest
import importlib
import inspect
from enum import Enum

import pytest

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
