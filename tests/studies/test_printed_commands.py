"""The commands that pages print: each is taken as printed, and asks who answers in its tables."""

import json
import os
import re
import shlex
import subprocess
import tomllib
import venv
from importlib import metadata

import pytest
from commanding import PROSE, ROOT, refused
from packaging.requirements import Requirement

from analytic import MODELS
from engines import ENGINES
from engines.registry import OWN
from studies.__main__ import COMMANDS, run
from studies.catalogue import CHAPTERS
from studies.old.app import make_app
from studies.measures.published import PUBLISHED
from studies.page import facts
from studies.sources.registry import expanded, grouped, resolve


def commands(name):
    """Return the commands that a page prints in its blocks, in their order."""
    blocks = re.findall(r"```sh\n(.*?)```", (ROOT / name).read_text(encoding="utf-8"), re.S)
    return [line for block in blocks for line in block.splitlines() if line.startswith("rocking ")]


def taken(arguments):
    """Let the command line take arguments, all of them, without running anything."""
    command, bound, ignored = make_app(COMMANDS).parse_args(arguments, exit_on_error=False)
    assert command.__module__.startswith("studies.") and bound.arguments and not ignored


PLACES = [place for place in CHAPTERS if facts.is_published(PUBLISHED, place[1])]


@pytest.mark.slow
@pytest.mark.parametrize("place", PLACES, ids=lambda place: place[1].folder)
def test_of_the_command_of_a_chapter_nothing_is_refused_but_the_folder(place, tmp_path, capsys):
    study, chapter = place
    words = facts.command_of(study, chapter, PUBLISHED / chapter.folder)
    file = tmp_path / "DIR"
    file.touch()
    refused(capsys, [file if word == "DIR" else word for word in words], str(file), "not a file")


@pytest.mark.parametrize("place", PLACES, ids=lambda place: place[1].folder)
def test_the_command_of_a_chapter_asks_who_answers_in_its_tables(place):
    study, chapter = place
    words = facts.command_of(study, chapter, PUBLISHED / chapter.folder)
    taken(words)
    record = json.loads((PUBLISHED / chapter.folder / "provenance.json").read_text())
    answered = {used(name) for name in record.get("made", {}).get("rows", {})}
    if "--sources" in words and answered:
        asked = map(used, expanded(words[words.index("--sources") + 1 :]))
        more = here(asked) ^ here(answered)
        assert not more or {"exact"} < dict(more).keys() <= MODELS.keys()  # maps have no rows
    if "--engines" in words and answered:
        asked = set(words[words.index("--engines") + 1 :])
        assert asked == {name for name, _ in answered if name in ENGINES}


def here(pairs):
    """Return those of models and of the published engines that are installed."""
    known = {name for name in OWN if ENGINES[name].installed} | MODELS.keys()
    return {pair for pair in pairs if pair[0] in known}


def used(name):
    """Return a source, and of an engine the preset for which it stands."""
    engine = name.partition(":")[0]
    return engine, resolve(name).preset or (ENGINES[engine].best.name if engine in ENGINES else "")


def test_names_of_all_engines_with_a_preset_are_one_word():
    fixed = [f"{name}:fixed" for name in OWN]
    assert [*grouped(["exact", *fixed, "mujoco"])] == ["exact", "engines:fixed", "mujoco"]
    assert [*grouped([*OWN, "rk4"])] == ["engines", "rk4"]
    assert [*grouped(fixed[1:])] == fixed[1:]


QUICK = ("symptoms", "advise", "export", "blocks", "compare")


@pytest.mark.parametrize("command", commands("README.md"))
def test_a_command_of_the_readme_works_as_printed(command, tmp_path, monkeypatch, capsys):
    """What takes a second is run; of the rest every argument is taken."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    _, *arguments = shlex.split(command)
    if arguments[0] in QUICK:
        assert run(arguments) == 0
        assert capsys.readouterr().out
    else:
        taken(arguments)


def needed(name, known):
    """Add to the known distributions those that one needs without its extras."""
    if name not in known:
        known[name] = metadata.distribution(name)
        for asked in map(Requirement, known[name].requires or ()):
            if asked.marker is None or asked.marker.evaluate({"extra": ""}):
                needed(asked.name, known)
    return known


def environment(folder):
    """Return the Python of an environment into which the packages of the project are linked."""
    venv.create(folder, symlinks=True)
    (site,) = folder.glob("lib/python*/site-packages")
    found = needed("rocking", {})
    del found["rocking"]
    for package in found.values():
        for top in {file.parts[0] for file in package.files} - {"..", "__pycache__"}:
            if not (site / top).exists():
                (site / top).symlink_to(package.locate_file(top))
    return folder / "bin" / "python"


@pytest.mark.slow
@pytest.mark.processes
@pytest.mark.parametrize("command", [it for it in commands("README.md") if "my_engine" not in it])
def test_a_command_of_the_readme_runs_to_its_end_with_the_core_packages_alone(command, tmp_path):
    """That of `score` is of pymunk; `test_score` runs it."""
    _, *arguments = shlex.split(command)
    interpreter = environment(tmp_path / "core")
    (tmp_path / "studies").symlink_to(ROOT / "studies")
    done = subprocess.run(
        [interpreter, "-m", "studies", *arguments],
        cwd=tmp_path,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
    )
    assert done.returncode in (0, 1) and "Traceback" not in done.stderr, done.stderr
    assert done.stdout
    assert arguments[0] != "report" or (tmp_path / "DIR" / "report.html").is_file()


@pytest.mark.parametrize("name", PROSE)
def test_a_command_within_a_page_is_taken(name):
    """Whole ones; of a command alone its name."""
    text = (ROOT / name).read_text(encoding="utf-8")
    known = {command.name for command in COMMANDS}
    inside = [" ".join(found.split()) for found in re.findall("`(rocking [^`]*)`", text)]
    for command in (*inside, *(commands(name) if name != "README.md" else ())):
        _, *arguments = shlex.split(command, comments=True)
        assert arguments[0] in known | {"COMMAND"}
        if len(arguments) > 1 and arguments[0] != "COMMAND":
            taken(arguments)
    extras = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"][
        "optional-dependencies"
    ]
    for named in re.findall(r"pip install [^`\n]*'\.\[([\w,]+)\]'", text):
        assert set(named.split(",")) <= set(extras)
