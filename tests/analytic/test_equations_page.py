"""The page of equations says the numbers that the code has."""

import re
from pathlib import Path

import pytest

import analytic
from analytic.conditioning import MOVES
from analytic.kernels import forces, polynomial, rest, taylor
from studies.measures import halving

PAGE = Path(analytic.__file__).parent / "EQUATIONS.md"
TEXT = PAGE.read_text(encoding="utf-8")
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
    (found,) = re.findall(words, " ".join(TEXT.split()))
    assert float(found) == pytest.approx(SAID[words], rel=1e-12)
