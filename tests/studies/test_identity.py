"""On what code a row depends: all of it, found by its names, and no more; and no comments."""

import shutil
import sys
from dataclasses import replace
from functools import cache, partial
from pathlib import Path

import pandas as pd
import pytest

from analytic import Record, RigidBlock, SinePulse
from analytic.response import Outcome, Response
from studies.__main__ import run
from studies.catalogue import CHAPTERS
from studies.contact import study as contact
from studies.histories import study as histories
from studies.old import fingerprint, identity, plan
from studies.old.fingerprint import PACKAGES, ROOT, read
from studies.old.identity import FOUND_BY_NAME, Makers, changed
from studies.old.jobs import Job, ask, summary
from studies.old.provenance import record_of
from studies.old.study import Study
from studies.sources.registry import Source
from studies.stability import study as stability

AT_ONCE = ("advise", "linearizations", "restitution", "symptoms")
DEAR = ("overturning", "precision", "scenes")
"""Studies that take many seconds before their first row, or for one of each source."""
RESUMABLE = [
    pytest.param(study, chapter, id=chapter.folder, marks=[pytest.mark.slow] * (study.name in DEAR))
    for study, chapter in CHAPTERS
    if study.name not in AT_ONCE
]
SOURCES = ("exact", "rk45", "mujoco", "mujoco:naive", "pybullet", "box2d", "newton:fixed")
ENGINE = set(SOURCES) - {"exact", "rk45"}
MUJOCO = {"mujoco", "mujoco:naive"}


LOOKUPS = FOUND_BY_NAME | {
    ("engines.registry", "Engines"),
    ("engines.scene", "one_of"),
    ("studies.old.jobs", "Job"),
    ("studies.sources.registry", "Source"),
}
"""What poses a question or refuses it, and finds by its name whom it is put to."""


def job(source):
    motion = SinePulse(amplitude=3.0, omega=6.0)
    return Job(labels={}, block=RigidBlock(width=0.5, height=1.5), motion=motion, source=source)


def made(reduce, root=ROOT):
    makers = Makers(ask, reduce, root)
    return {source: makers.of(job(source)) for source in SOURCES}


made_here = cache(made)
EDITED = {}
"""File of the copied code -> its text."""


def stale(reduce, root):
    """Return the sources whose rows were made by other code than that in a folder."""
    now = made(reduce, root)
    return {name for name, then in made_here(reduce).items() if changed(then, now[name])}


@pytest.fixture(scope="module")
def copied(tmp_path_factory):
    """The code in another folder; what was not edited there is parsed once for all tests."""
    folder, kept = tmp_path_factory.mktemp("copied"), {}
    for name in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__", "published")
        shutil.copytree(ROOT / name, folder / name, ignore=ignored)

    @cache
    def unedited(name, path):
        return read(name, ROOT / path.relative_to(folder) if folder in path.parents else path)

    def read_once(name, path):
        if path not in EDITED:
            return unedited(name, path)
        key = path, EDITED[path]
        if key not in kept:
            kept[key] = read.__wrapped__(name, path)
        return kept[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(fingerprint, "read", read_once)
        yield folder


@pytest.fixture
def copy(copied):
    """The same, in which what a test edits is taken back."""
    yield copied
    while EDITED:
        path, _ = EDITED.popitem()
        shutil.copy(ROOT / path.relative_to(copied), path)


def edit(root, file, old, new):
    path = root / file
    text = path.read_text()
    assert old in text
    EDITED[path] = text.replace(old, new, 1)
    path.write_text(EDITED[path])


ASKED = []


def answered(job, source):
    """Answer at once, but for the tenth question, at which the user has enough."""
    ASKED.append(job.source)
    if len(ASKED) == 10:
        raise KeyboardInterrupt
    return Response(outcome=Outcome.ROCKED, peak_ratio=0.5)


def test_a_run_that_is_taken_up_computes_again_what_an_edit_made_stale(
    copy, tmp_path, monkeypatch, capsys
):
    """The question before the first of each source only loads it: 4 and 3 rows are kept."""
    monkeypatch.setattr(plan, "Makers", partial(Makers, root=copy))
    names = ("exact", "pymunk", "box2d")
    jobs = [replace(job(name), labels={"case": n}) for name in names for n in range(4)]
    study = Study(name="made-up", module="", help="", tables=("made-up.csv",))

    def go_on():
        plan.fill(study, plan.Plan(jobs=jobs, ask=answered), tmp_path / "out")
        assert list(pd.read_csv(tmp_path / "out" / "made-up.csv")["case"]) == [0, 1, 2, 3] * 3
        return capsys.readouterr().err, record_of(tmp_path / "out")["runs"][-1]["computed"]

    with pytest.raises(KeyboardInterrupt, match="7 of 12 rows are kept"):
        go_on()
    adapter, added = "engines/pymunk/settings.py", "added = 1\n\n    def __post_init__(self)"
    edit(copy, adapter, "def __post_init__(self)", added)
    said = f"4 of 12 rows are kept; computed again: pymunk: 3 rows made by another {adapter}\n"
    assert go_on() == (said, 8)
    edit(copy, adapter, "added = 1", "# a comment\n    added = 1")
    assert go_on() == ("", 0)
    edit(copy, "engines/box2d/build.py", "return ", "return 0 or ")
    said, computed = go_on()
    assert "computed again: box2d: 4 rows" in said
    assert computed == 4


EDITS = {
    "an engine's build": ("engines/mujoco/build.py", "import_module(", "id(", MUJOCO),
    "an engine's loop": (
        "engines/mujoco/loop.py",
        "return taken",
        "return 2 + taken",
        MUJOCO,
    ),
    "an engine's settings": (
        *("engines/box2d/settings.py", "def __post_init__(self) -> None:"),
        *("def __post_init__(self) -> None:\n        print()", {"box2d"}),
    ),
    "the run": ("engines/run/drive.py", "LOOK_AROUND = 256", "LOOK_AROUND = 257", ENGINE),
    "steps that land": ("engines/run/landing.py", "return ", "return 1 + ", ENGINE),
    "what is watched": ("engines/watching/observe.py", "return ", "return 1 + ", ENGINE),
    "a kernel": ("analytic/kernels/notes.py", "return n + 1", "return n + 2", {"exact"}),
    "a peer": ("studies/sources/scipy_peers.py", "return ", "return 1 + ", {"rk45"}),
    "the reduction": ("studies/old/jobs.py", '"outcome": r', '"outcome": 1 * r', set(SOURCES)),
    "a registry's line": (
        *("engines/registry.py", "OWN = {", 'OWN = {"ninth": "engines.ninth:ENGINE",'),
        set(),
    ),
    "the registry": ("engines/registry.py", "return own | ", "return own | own | ", set()),
    "a script": ("engines/mujoco/script.py", "return ", "return 1 + ", set()),
    "what a script is filled by": ("engines/parts/script.py", "return ", "return 1 + ", set()),
    "a script beside its build": (
        *("engines/box2d/build.py", '"import Box2D",', '"import Box2D", "",'),
        set(),
    ),
    "a build beside its script": (
        *("engines/box2d/build.py", "world = Box2D.b2World(", "world = dict("),
        {"box2d"},
    ),
    "another study": ("studies/restitution/strike.py", "return ", "return 1 + ", set()),
    "words": ("studies/measures/words.py", "return ", "return 1 + ", set()),
    "a figure": ("studies/sweep/figure.py", "return ", "return 1 + ", set()),
    "a command": ("studies/sweep/study.py", "return ", "return 1 + ", set()),
    "the command line": ("studies/old/arguments.py", "return ", "return 1 + ", set()),
    "a tabulation": ("studies/old/tables.py", "return ", "return 1 + ", set()),
    "a comment": ("engines/run/drive.py", "LOOK_AROUND = 256", "# 256\nLOOK_AROUND = 256", set()),
    "a docstring": ("engines/run/drive.py", '"""Steps between', '"""How many steps between', set()),
}


@pytest.mark.parametrize(("file", "old", "new", "sources"), EDITS.values(), ids=EDITS)
def test_an_edit_makes_stale_what_runs_through_it(file, old, new, sources, copy):
    edit(copy, file, old, new)
    assert stale(summary, copy) == sources


@pytest.mark.parametrize(
    ("file", "part"),
    [
        ("accelerograms/at2.py", False),
        ("accelerograms/units.py", False),
        ("accelerograms/__init__.py", False),
        ("record.py", True),
    ],
)
def test_how_a_record_was_read_is_no_part_of_its_rows(file, part, copy):
    """Its samples are: they are in the key of the job."""
    asked = replace(job("exact"), motion=Record(dt=0.1, samples=[0.0, 1.0, 0.0]))
    edit(copy, f"analytic/{file}", "return ", "return 1 + ")
    before = Makers(ask, summary).of(asked)
    assert (Makers(ask, summary, copy).of(asked) != before) == part


def test_the_reference_that_a_study_compares_with_is_in_its_rows(copy):
    edit(copy, "analytic/kernels/notes.py", "return n + 1", "return n + 2")
    assert stale(stability.reduce, copy) == set(SOURCES)
    assert stale(contact.reduce, copy) == {"exact"}


@pytest.mark.parametrize(
    ("file", "old", "new", "tables", "rows"),
    [
        (
            "studies/histories/study.py",
            'if row["samples"]:',
            'if len(row["samples"]):',
            True,
            set(),
        ),
        ("studies/old/plan.py", "return {name", "return {str(name)", False, set()),
        ("studies/histories/study.py", "report(", "repr(", False, set()),
        ("engines/box2d/build.py", "return ", "return 0 or ", False, {"box2d"}),
        ("studies/old/jobs.py", '"outcome": r', '"outcome": 1 * r', False, set(SOURCES)),
    ],
)
def test_a_table_is_of_its_rows_and_its_tabulation(file, old, new, tables, rows, copy):
    def made(root):
        jobs = [job(source) for source in SOURCES]
        return Makers(ask, summary, root).of_tables(jobs, histories.tabulate)

    before = made(ROOT)
    edit(copy, file, old, new)
    after = made(copy)
    assert (after["tabulation"] != before["tabulation"]) == tables
    assert {name for name in SOURCES if after["rows"][name] != before["rows"][name]} == rows


@pytest.mark.parametrize(
    ("change", "sources"),
    [
        ({"settings": {"friction": 0.9}}, {"mujoco:naive"}),
        ({"frame": "base"}, {"mujoco:naive"}),
        ({"title": "another", "documented": ()}, set()),
    ],
)
def test_a_number_that_an_engine_declares_is_in_its_rows(change, sources, monkeypatch):
    before, whole = made_here(summary), Source.used.fget

    def used(source):
        preset = whole(source)
        if (source.engine, source.preset) != ("mujoco", "naive"):
            return preset
        inside = {"settings": replace(preset.settings, **change.get("settings", {}))}
        return replace(preset, **(change | inside))

    monkeypatch.setattr(Source, "used", property(used))
    assert {name for name, maker in made(summary).items() if maker != before[name]} == sources


@pytest.mark.parametrize(
    ("package", "sources"), [("mujoco", MUJOCO), ("scipy", set(SOURCES)), ("pandas", set())]
)
def test_a_version_is_in_the_rows_of_what_computes_with_it(package, sources, monkeypatch):
    before, whole = made_here(summary), identity.version_of
    monkeypatch.setattr(identity, "version_of", lambda n: "9" if n == package else whole(n))
    assert {name for name, maker in made(summary).items() if maker != before[name]} == sources


class Seen(BaseException):
    """Raised when the functions that a few rows run through were seen."""


def look(jobs, *, executor, reduce, journal, makers):
    """Stand in for `run_jobs`: run a job of each source and kind of body, and compare what runs
    with what counts."""
    missed, count = set(), 0
    for job in {(job.source, type(job.block)): job for job in jobs}.values():
        ours = places_in(lambda job=job: reduce(job, executor.ask(job, job.asked)))
        missed |= ours - makers.reached(job).names
        count = max(count, len(ours))
    raise Seen(missed, count)


def places_in(run_it):
    """Return the definitions that a call runs through."""
    called = set()
    sys.setprofile(lambda frame, event, argument: called.add(frame.f_code))
    try:
        run_it()
    finally:
        sys.setprofile(None)
    return {place for code in called if (place := place_of(code))}


def place_of(code):
    """Return the module and the definition that a piece of code stands in, where it is ours."""
    path, name = Path(code.co_filename), code.co_qualname.partition(".")[0]
    if not path.is_relative_to(ROOT) or path.relative_to(ROOT).parts[0] not in PACKAGES:
        return None
    dotted = ".".join(path.relative_to(ROOT).with_suffix("").parts).removesuffix(".__init__")
    # what is registered under no name of its own is a part of that by which it is called
    return None if name.startswith("<") or name == "_" else (dotted, name)


@pytest.mark.parametrize(("study", "chapter"), RESUMABLE)
def test_what_a_row_runs_through_was_found(study, chapter, monkeypatch, tmp_path):
    monkeypatch.setattr(plan, "run_jobs", look)
    with pytest.raises(Seen) as seen:
        run(study.command_line(chapter, tmp_path, full=False))
    missed, count = seen.value.args
    assert count > 8
    assert missed - {("studies.old.plan", "fill"), *LOOKUPS} == set()
