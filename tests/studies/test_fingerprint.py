"""The code on which the rows of a study depend: all of it, found, and no comments."""

import shutil
import sys
from pathlib import Path

import pytest

from analytic.kernels.forces import watch_free
from engines.adapters.bullet import BulletWorld
from studies.__main__ import run
from studies.catalogue import CHAPTERS
from studies.contact import study as contact
from studies.contact.report import report as report_of_contact
from studies.ensemble import study as ensemble
from studies.free import study as free
from studies.kit import plan, runner
from studies.kit.fingerprint import PACKAGES, ROOT, fingerprint, reached
from studies.kit.jobs import summary
from studies.measures.energy import energy_drift
from studies.measures.verdicts import judge
from studies.overturning import study as overturning
from studies.overturning.figure import draw_map
from studies.precision import study as precision
from studies.sources.registry import resolve
from studies.sources.scipy_peers import solve_ivp_response
from studies.stability import study as stability
from studies.stability.largest_step import search
from studies.stability.remedies import answer
from studies.sweep import study as sweep
from studies.sweep.figure import draw_sweep
from studies.validity import study as validity

AT_ONCE = ("advise", "linearizations", "restitution", "symptoms")
DEAR = ("overturning", "precision")
"""Studies that take many seconds before their first row."""
RESUMABLE = [
    pytest.param(study, chapter, id=chapter.folder, marks=[pytest.mark.slow] * (study.name in DEAR))
    for study, chapter in CHAPTERS
    if study.name not in AT_ONCE
]


@pytest.fixture(scope="module")
def original(tmp_path_factory):
    root = tmp_path_factory.mktemp("original")
    for name in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__", "published")
        shutil.copytree(ROOT / name, root / name, ignore=ignored)
    return root


@pytest.fixture
def copy(original, tmp_path):
    return Path(shutil.copytree(original, tmp_path / "copy"))


def file_of(something, root):
    return root / Path(sys.modules[something.__module__].__file__).relative_to(ROOT)


@pytest.mark.parametrize(
    ("study", "part"),
    [
        (sweep, summary),
        (sweep, solve_ivp_response),
        (sweep, watch_free),
        (sweep, BulletWorld),
        (sweep, runner.run_jobs),
        (contact, energy_drift),
        (precision, energy_drift),
        (free, free.reduce),
        (stability, answer),
        (stability, judge),
        (stability, search),
        (overturning, sys.modules[overturning.edge_jobs.__module__].reduce),
        (validity, validity.reference_map),
        (ensemble, ensemble.read_record),
    ],
    ids=lambda part: getattr(part, "__module__", getattr(part, "__name__", "")),
)
def test_an_edit_of_any_module_on_the_way_of_a_row_is_another_code(study, part, original, copy):
    file = file_of(part, copy)
    file.write_text(file.read_text() + "\n\nEDITED = True\n")
    assert fingerprint(study.__name__, copy) != fingerprint(study.__name__, original)


@pytest.mark.parametrize(
    ("study", "part"),
    [(sweep, draw_sweep), (overturning, draw_map), (contact, report_of_contact), (sweep, judge)],
    ids=["figures", "map", "report", "elsewhere"],
)
def test_pictures_reports_and_what_is_not_imported_do_not_count(study, part, original, copy):
    file = file_of(part, copy)
    file.write_text(file.read_text() + "\n\nEDITED = True\n")
    assert fingerprint(study.__name__, copy) == fingerprint(study.__name__, original)


class Seen(BaseException):
    """Raised when the functions that a few rows run through were seen."""


def look(jobs, *, executor, reduce, journal):
    """Stand in for `run_jobs`: run a job of each source and collect the files that are run."""
    called = set()
    for job in {job.source: job for job in jobs}.values():
        source = resolve(job.source)
        sys.setprofile(lambda frame, event, argument: called.add(frame.f_code.co_filename))
        try:
            reduce(job, executor.ask(job, source))
        finally:
            sys.setprofile(None)
    raise Seen(called)


@pytest.mark.parametrize(("study", "chapter"), RESUMABLE)
def test_what_a_row_runs_through_was_found(study, chapter, monkeypatch, tmp_path):
    monkeypatch.setattr(plan, "run_jobs", look)
    with pytest.raises(Seen) as seen:
        run(study.command_line(chapter, tmp_path, full=False))
    ours = {
        ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
        for path in map(Path, seen.value.args[0])
        if path.is_relative_to(ROOT) and path.relative_to(ROOT).parts[0] in PACKAGES
    }
    assert len(ours) > 8
    assert ours <= set(reached(study.module))


MADE_UP = {
    "analytic/__init__.py": "from .inner.deep import root",
    "analytic/inner/__init__.py": "",
    "analytic/inner/deep.py": "from ..forces import push\n\ndef root(x):\n    return push(x)",
    "analytic/forces.py": "def push(x):\n    return x",
    "analytic/unused.py": "",
    "engines/__init__.py": "",
    "engines/adapters/__init__.py": "",
    "engines/adapters/one.py": "from engines.parts import box",
    "engines/adapters/two.py": "",
    "engines/parts/__init__.py": "",
    "engines/parts/box.py": "",
    "engines/registry.py": 'ENGINES = {"one": "engines.adapters.one:build"}',
    "engines/other.py": 'from importlib import import_module\nimport_module(f"engines.parts.{1}")',
    "studies/__init__.py": "",
    "studies/kit/runner.py": "import engines.registry as r",
    "studies/drawing/style.py": "from matplotlib import cm\nfrom studies.drawing import colours",
    "studies/drawing/colours.py": "",
    "studies/swing/__init__.py": "",
    "studies/swing/study.py": """
from typing import TYPE_CHECKING
from .report import report
from . import measure as m
from studies.kit import plan, runner

if TYPE_CHECKING:
    from studies.swing import types

def command():
    from studies.swing.late import find
    from studies.drawing.style import line

    return find()
""",
    "studies/swing/report.py": "",
    "studies/swing/measure.py": "import analytic",
    "studies/swing/late.py": "def find():\n    'a docstring'\n    return (1 +\n        2)  # three",
    "studies/swing/types.py": "",
}


def laid_out(root, **changed):
    for name, text in (MADE_UP | changed).items():
        path = root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
    return root


def test_imports_are_followed_in_any_layout(tmp_path):
    found = set(reached("studies.swing.study", laid_out(tmp_path)))
    assert found == {
        *("analytic", "analytic.inner", "analytic.inner.deep", "analytic.forces"),
        *("engines", "engines.registry", "engines.adapters", "engines.adapters.one"),
        *("engines.parts", "engines.parts.box"),
        *("studies", "studies.kit.runner", "studies.swing", "studies.swing.study"),
        *("studies.swing.measure", "studies.swing.late"),
    }


def test_a_name_that_is_put_together_stands_for_the_whole_package(tmp_path):
    found = set(reached("engines.other", laid_out(tmp_path)))
    assert found == {"engines", "engines.other", "engines.parts", "engines.parts.box"}


@pytest.mark.parametrize(
    ("text", "same"),
    [
        ('# new\ndef find():\n    """Other words."""\n\n    return 1 + 2', True),
        ("def find():\n    return 1 + 3", False),
        ("def find():\n    return 2 + 1", False),
        ("def find() -> int:\n    return 1 + 2", False),
        ("def find():\n    return 1 + 2\n\nfind()", False),
        ("def find():\n    return '1 + 2'", False),
    ],
)
def test_comments_docstrings_and_layout_do_not_count(text, same, tmp_path):
    before = laid_out(tmp_path / "before")
    after = laid_out(tmp_path / "after", **{"studies/swing/late.py": text})
    study = "studies.swing.study"
    assert (fingerprint(study, before) == fingerprint(study, after)) is same


def test_a_new_name_for_the_same_code_is_another_code(tmp_path):
    before = laid_out(tmp_path / "before")
    moved = {"engines/registry.py": 'ENGINES = {"one": "engines.adapters.two:build"}'}
    after = laid_out(tmp_path / "after", **moved)
    assert fingerprint("engines.registry", before) != fingerprint("engines.registry", after)
