"""What a user imports has an example that gives what it prints; the page of equations holds."""

import doctest
import importlib
import inspect
import re
from enum import Enum

import pytest
from commanding import ROOT

from analytic.conditioning import MOVES
from analytic.kernels import forces, polynomial, rest, taylor
from studies.measures import halving

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


PAGE = (ROOT / "analytic/EQUATIONS.md").read_text(encoding="utf-8")


def test_every_heading_that_is_cited_exists():
    headings = set(re.findall(r"^(?:## |\*\*)([^*\n]+?)\.?(?:\*\*|$)", PAGE, re.MULTILINE))
    sources = [path for name in ("analytic", "engines") for path in (ROOT / name).rglob("*.py")]
    named = re.compile(r'EQUATIONS\.md(?:,\s+"([^"]+)")?')
    cited = {heading for path in sources for heading in named.findall(path.read_text())}
    assert cited and {" ".join(heading.split()) for heading in cited} <= headings


SAID = {
    r"Taylor series of degree (\d+)": taylor.accuracy(taylor.TOLERANCE).order,
    r"\| (1e-\d+) of the rotation that the step covers": taylor.TOLERANCE,
    r"at most (\d+)/p, and to the end": taylor.LONGEST_STEP,
    r"halved at most (\d+) times": polynomial.MAX_DEPTH,
    r"step is below (1e-\d+) of the root": polynomial.NEWTON_DONE,
    r"exceeds it by a part (1e-\d+) lifts": rest.EQUAL,
    r"where they last less than (1e-\d+)/p": rest.ZENO,
    r"until a part (1e-\d+) of the ratio": forces.REFINED,
    r"moved by ±(1e-\d+), ": max(MOVES),
    r"and ±(1e-\d+); infinite": min(map(abs, MOVES)),
    r"bounded (\d+) % of the errors": 100.0 * halving.BOUNDED,
}
"""What the page says, and what it is in the code."""


@pytest.mark.parametrize("words", SAID)
def test_a_number_of_the_page_is_that_of_the_code(words):
    (found,) = re.findall(words, " ".join(PAGE.split()))
    assert float(found) == pytest.approx(SAID[words], rel=1e-12)
