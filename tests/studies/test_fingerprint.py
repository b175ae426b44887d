"""Which code is found by following names, on packages that are made up; and its digest."""

import pytest

from studies.old.fingerprint import everything, reached

MADE_UP = {
    "analytic/__init__.py": "from .inner.deep import root",
    "analytic/inner/__init__.py": "",
    "analytic/inner/deep.py": """
from ..forces import push
from typing import TYPE_CHECKING
if TYPE_CHECKING:
    from analytic.types import Vector

def root(x: "Vector") -> "Vector":
    return push(x)

def other(x):
    return pull(x)
""",
    "analytic/forces.py": "LEAST = 2\n\ndef push(x):\n    return x + LEAST\n\ndef pull(x): ...",
    "analytic/shown.py": """
from functools import singledispatch

@singledispatch
def shown(x):
    return ""

@shown.register
def _(x: int):
    return number(x)

def number(x): ...
""",
    "engines/__init__.py": "",
    "engines/settings.py": "import engines.parts\nengines.parts.prepare()\n\nclass Settings: ...",
    "engines/parts.py": "def prepare(): ...\n\ndef unused(): ...",
    "studies/__init__.py": "",
    "studies/old.py": "import analytic as a\nfrom engines import settings\n\nKEPT = a.root",
    "studies/swing.py": """
from studies import kit as k

def late():
    from studies.old import settings
    return settings.Settings()

def early():
    'a docstring'
    return (k.KEPT +
        2)  # three

@property
def both():
    return early() or late()

def run():
    from analytic.shown import shown
    return shown
""",
}


def laid_out(root, **changed):
    for name, text in (MADE_UP | changed).items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def found(name, root, **options):
    names = reached([("studies.swing", name)], laid_out(root), **options).names
    return {f"{module}.{name}" for module, name in names if name}


ROOTED = {"analytic.root", "analytic.inner.deep.root", "analytic.inner.deep.push"} | {
    "analytic.forces.push",
    "analytic.forces.LEAST",
}
EARLY = ROOTED | {"studies.swing.early", "studies.swing.k", "studies.old.KEPT", "studies.old.a"}
LATE = {"studies.swing.late", "studies.old.settings", "engines.settings.Settings"} | {
    "engines.settings.engines",
    "engines.parts.prepare",
}


@pytest.mark.parametrize(
    ("name", "expected"),
    [
        ("early", EARLY),
        ("late", LATE),
        ("both", EARLY | LATE | {"studies.swing.both"}),
        (
            "run",
            {"studies.swing.run", "analytic.shown.singledispatch"}
            | {f"analytic.shown.{name}" for name in ("shown", "number")},
        ),
    ],
)
def test_names_are_followed_wherever_they_lead(name, expected, tmp_path):
    assert found(name, tmp_path) == expected


def test_what_is_cut_is_not_followed(tmp_path):
    cut = {("studies.old", "KEPT")}
    assert found("early", tmp_path, cut=cut) == {"studies.swing.early", "studies.swing.k"}


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ('# new\ndef find():\n    """Other words."""\n\n    return 1 + 2', True),
        ("def find() -> int:\n    return 1 + 2", True),
        ("def find():\n    return 1 + 2\n\ndef unused(): ...", True),
        ("def find():\n    return 1 + 3", False),
        ("def find():\n    return 2 + 1", False),
        ("def find(x=1):\n    return 1 + 2", False),
        ("def find():\n    return 1 + 2\n\nfind()", False),
        ("def find():\n    return '1 + 2'", False),
    ],
)
def test_comments_docstrings_and_layout_do_not_count(text, same, tmp_path):
    place = [("studies.old", "find")]
    before = laid_out(tmp_path / "a", **{"studies/old.py": "def find():\n    return 1 + 2"})
    after = laid_out(tmp_path / "b", **{"studies/old.py": text})
    assert (reached(place, before).digests() == reached(place, after).digests()) is same


def test_everything_is_all_code(tmp_path):
    before = everything(laid_out(tmp_path / "a"))
    after = {"analytic/forces.py": MADE_UP["analytic/forces.py"].replace("2", "3")}
    assert everything(laid_out(tmp_path / "b", **after)) != before
    assert everything(laid_out(tmp_path / "c")) == before
