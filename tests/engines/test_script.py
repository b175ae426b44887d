"""A function's source as a script, with values filled in: it does what the function does."""

import math
import re
from types import SimpleNamespace

import pytest

from engines.parts.script import defined, filled, settings_of


def weighed(body, mass):
    """Return a body with its mass.

    The rest is not in a script.
    """
    if mass is None:
        return {**body}
    return {**body, "mass": mass}


def build(library, n, s):
    """Build something."""
    made = {"places": [], "roots": []}
    if s.friction is not None:
        made["friction"] = library.sqrt(s.friction)  # of a pair
    if not n.at_rest:
        made["speed"] = -n.speed
    elif s.friction is None:
        made["speed"] = "none"
    else:
        made["speed"] = "at rest"
    for number, x in enumerate((-n.x, n.x)):
        if s.doubled:
            made["places"].append(
                (number, 2.0 * x),
            )
        else:
            made["places"].append((number, x))
        made["roots"].append(getattr(library, s.root)(abs(x)))
    made.update(dict(**s.others), most=max(*n.sizes))
    with_mass = weighed(made, s.mass)
    if with_mass["places"] and s.doubled:
        with_mass["any"] = "doubled"
    elif with_mass["places"]:
        with_mass["any"] = s.root
    else:
        with_mass["any"] = None
    return with_mass


def numbers(**options):
    usual = {"x": 0.5, "speed": 0.0, "at_rest": True, "sizes": (1.0, 2)}
    return SimpleNamespace(**{**usual, **options})


CASES = [
    (
        numbers(speed=-0.25, at_rest=False, sizes=[2.0, 3.0]),
        {"friction": 0.5, "doubled": True},
    ),
    (numbers(x=1e-7), {"friction": None, "doubled": False}),
    (numbers(x=-0.0), {"friction": 0, "mass": 3.0}),
]


def values(**options):
    usual = {"friction": 1.3, "doubled": False, "root": "sqrt", "others": {}, "mass": None}
    return SimpleNamespace(**{**usual, **options})


def run(lines):
    known = {"library": math}
    exec("\n".join(line.text for line in lines), known)
    return known


@pytest.mark.parametrize(("n", "options"), CASES)
@pytest.mark.parametrize("others", [{}, {"a": 1, "b": (2.0, "c")}])
def test_a_script_makes_what_the_function_returns(n, options, others):
    s = values(**options, others=others)
    lines = (*defined(weighed), *filled(build, n=n, s=s))
    assert run(lines)["with_mass"] == build(math, n, s)
    assert not any(re.search(r"\b[ns]\.\w", line.text) for line in lines)


def test_a_script_reads_as_if_it_had_been_written_by_hand():
    n, s = (
        SimpleNamespace(x=0.5, speed=0.0, at_rest=True, sizes=(1.0, 2)),
        values(others={"a": 1, "b": 2.0}),
    )
    lines = filled(build, n=n, s=s)
    assert [line.text for line in lines] == [
        'made = {"places": [], "roots": []}',
        'made["friction"] = library.sqrt(1.3)  # of a pair',
        'made["speed"] = "at rest"',
        "for number, x in enumerate((-0.5, 0.5)):",
        '    made["places"].append((number, x))',
        '    made["roots"].append(library.sqrt(abs(x)))',
        "made.update(dict(a=1, b=2.0), most=max(1.0, 2))",
        "with_mass = weighed(made, None)",
        'if with_mass["places"] and False:',
        '    with_mass["any"] = "doubled"',
        "else:",
        '    if with_mass["places"]:',
        """        with_mass["any"] = 'sqrt'""",
        "    else:",
        '        with_mass["any"] = None',
    ]
    assert settings_of(lines) == (
        'made["friction"] = library.sqrt(1.3)  # of a pair',
        'made["speed"] = "at rest"',
        'made["places"].append((number, x))',
        'made["roots"].append(library.sqrt(abs(x)))',
        "made.update(dict(a=1, b=2.0), most=max(1.0, 2))",
        "with_mass = weighed(made, None)",
        """with_mass["any"] = 'sqrt'""",
    )


def held(floors, about, s):
    """Hold floors."""
    if s.doubled:
        about = 2.0 * about
    return [floor for floor in floors if floor * about >= s.friction]


def test_a_function_is_written_with_its_first_sentence_and_what_it_returns():
    assert [line.text for line in defined(weighed)][2:-2] == [
        "def weighed(body, mass):",
        '    """Return a body with its mass."""',
        "    if mass is None:",
        "        return {**body}",
        '    return {**body, "mass": mass}',
    ]
    s = values(doubled=True)
    written = run(defined(held, s=s))["held"]
    assert written([0.5, 1.0, 2.0], 1.0) == held([0.5, 1.0, 2.0], 1.0, s) == [1.0, 2.0]
