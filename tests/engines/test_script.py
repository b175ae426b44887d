"""A function's source as a script, with values filled in: it does what the function does."""

import math
from types import SimpleNamespace

from engines.parts.script import defined, filled, settings_of


def weighed(body, mass):
    """Return a body with its mass.

    The rest is not in a script.
    """
    if mass is None:
        return [*body]
    return [*body, mass]


def held(floors, about, s):
    """Hold floors."""
    if s.heavy:
        about = 2.0 * about
    return [floor for floor in floors if floor * about >= s.friction]


def build(library, n, s):
    """Build something."""
    made = {"places": []}
    if s.friction is not None:
        made["friction"] = library.sqrt(s.friction)  # of a pair
    if not n.at_rest:
        made["speed"] = -n.speed
    elif s.friction is None:
        made["speed"] = "none"
    else:
        made["speed"] = "at rest"
    for number, x in enumerate((-n.x, n.x)):
        if s.heavy:
            made["places"].append(
                (number, 2.0 * x),
            )
        made["places"].append(getattr(library, s.root)(abs(x)))
    made.update(dict(**s.others), most=max(*n.sizes))
    with_mass = weighed(made, s.mass)
    if with_mass and s.heavy:
        with_mass = "heavy"
    elif with_mass:
        with_mass.append(s.root)
    return with_mass


N = SimpleNamespace(x=0.5, speed=0.0, at_rest=True, sizes=(1.0, 2))
S = SimpleNamespace(friction=1.3, heavy=False, root="sqrt", others={"a": 1, "b": 2.0}, mass=None)


def run(lines):
    known = {"library": math}
    exec("\n".join(line.text for line in lines), known)
    return known


def test_a_script_reads_as_if_it_had_been_written_by_hand():
    lines = filled(build, n=N, s=S)
    assert run([*defined(weighed), *lines])["with_mass"] == build(math, N, S)
    assert [line.text for line in lines] == [
        'made = {"places": []}',
        'made["friction"] = library.sqrt(1.3)  # of a pair',
        'made["speed"] = "at rest"',
        "for number, x in enumerate((-0.5, 0.5)):",
        '    made["places"].append(library.sqrt(abs(x)))',
        "made.update(dict(a=1, b=2.0), most=max(1.0, 2))",
        "with_mass = weighed(made, None)",
        "if with_mass and False:",
        '    with_mass = "heavy"',
        "else:",
        "    if with_mass:",
        "        with_mass.append('sqrt')",
    ]
    settings = (lines[number].text.strip() for number in (1, 2, 4, 5, 6, 11))
    assert settings_of(lines) == tuple(settings)


def test_a_function_is_written_with_its_first_sentence_and_what_it_returns():
    assert [line.text for line in defined(weighed)][2:-2] == [
        "def weighed(body, mass):",
        '    """Return a body with its mass."""',
        "    if mass is None:",
        "        return [*body]",
        "    return [*body, mass]",
    ]
    s = SimpleNamespace(friction=1.3, heavy=True)
    written = run(defined(held, s=s))["held"]
    assert written([0.5, 1.0, 2.0], 1.0) == held([0.5, 1.0, 2.0], 1.0, s) == [1.0, 2.0]
