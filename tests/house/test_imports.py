"""What an import costs: nothing is compiled, and no engine, table or plot is loaded."""

import json
import re
import shutil

import pytest
from commanding import CASE, ROOT, python

from studies.__main__ import COMMANDS

HEAVY = ("numba", "scipy.integrate", "pandas", "matplotlib", "pybullet", "mujoco")
PACKAGES = ("analytic", "engines", "studies")
SOON = ("cyclopts", "numpy", "numba", "pandas", "fcntl")


def loaded_by(statement):
    code = f"{statement}; import sys; print(*sys.modules)"
    done = python("-c", code, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize("module", ["analytic", "engines", "studies", "studies.__main__"])
def test_imports_are_light(module):
    loaded = loaded_by(f"import {module}")
    assert not loaded & set(HEAVY)
    if module.startswith("studies"):  # nothing before signals are dealt with
        assert not loaded & {*SOON, "engines"}


SCIENCE = "numba llvmlite scipy matplotlib pandas.core asyncio distributed"
LIBRARIES = "pybullet mujoco pymunk Box2D dartpy rapier3d pydrake warp jax sapien"
EACH = (*SCIENCE.split(), *LIBRARIES.split())
"""What no answer at once may load."""

ANSWERING = (
    "import sys, json; from studies.__main__ import run; seen = set(sys.modules)\n"
    "for arguments in json.loads(sys.argv[1]):\n"
    "    run(arguments); print('\\nLOADED', json.dumps([*(set(sys.modules) - seen)]))\n"
    "    seen |= set(sys.modules)"
)
"""Commands one after the other, and after each what it was the first to load."""


def told_by(*commands):
    done = python("-c", ANSWERING, json.dumps(commands), check=True)
    lists = re.findall("^LOADED (.*)$", done.stdout, re.MULTILINE)
    names = (words[0] for words in commands)
    return {name: set(json.loads(text)) for name, text in zip(names, lists, strict=True)}


@pytest.mark.parametrize(
    "arguments",
    [
        ["compare", *CASE, "--json", "--sources", "exact", "housner", "modified"],
        ["compare", *CASE, "--json", "--sources", "exact", "mujoco:tuned"],
        ["export", *CASE, "--engine", "mujoco", "--out", "scene"],
    ],
    ids=["models", "engine", "export"],
)
def test_an_answer_at_once_loads_nothing_that_it_does_not_need(arguments, tmp_path, monkeypatch):
    """An engine's library is loaded in a process of the engine's own, but to note what it does."""
    monkeypatch.chdir(tmp_path)
    noted = {"mujoco"} if arguments[0] == "export" else set()
    assert told_by(arguments)[arguments[0]] & set(EACH) == noted
    assert arguments[0] == "compare" or (tmp_path / "scene" / "block.py").is_file()


def test_no_help_loads_a_table_a_plot_or_an_engine():
    told = told_by(["--help"], *([name, "--help"] for name in COMMANDS))
    assert {name: loaded & set(EACH) for name, loaded in told.items() if loaded & set(EACH)} == {}


def test_a_run_of_an_engine_loads_its_library_alone():
    statement = (
        "from analytic import RigidBlock, SinePulse; from studies import respond;"
        "block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=3.9, omega=6.3);"
        "assert respond('mujoco', block, pulse).steps > 100"
    )
    assert loaded_by(statement) & set(EACH) == {"mujoco"}


ANSWERS = {
    "analytic.simulate": "from analytic import simulate",
    "analytic": "import analytic",
    "analytic.maps": "import analytic.maps as here, json",
    "analytic.conditioning": "from analytic import conditioning",
    "analytic.kernels.excursions": "from analytic.kernels.excursions import march",
    "analytic.kernels.forces": "from analytic.kernels import forces",
    "analytic.models": "def later():\n    from analytic.models import MODELS",
}
"""The modules that know the answer, and ways for an adapter to come to one."""
ALLOWED = (
    "from analytic import block, checks, motion, record\nfrom analytic.response import Response"
)


def test_an_adapter_that_would_see_the_answer_is_named(tmp_path):
    for name in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__", "published")
        shutil.copytree(ROOT / name, tmp_path / name, ignore=ignored)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    adapters = {f"forbidden_{n}": statement for n, statement in enumerate(ANSWERS.values())}
    for name, text in {"allowed": ALLOWED, **adapters}.items():
        (tmp_path / "engines" / f"{name}.py").write_text(text)
    lint = "from importlinter.cli import lint_imports as l; raise SystemExit(l(no_cache=True))"
    known = {"PYTHONPATH": str(tmp_path), "COLUMNS": "200"}
    done = python("-c", lint, cwd=tmp_path, env=known)
    assert done.returncode == 1, done.stderr
    named = re.findall(r"(engines\.forbidden_\S+) -> (analytic\S*) \(l", done.stdout)
    expected = [(f"engines.forbidden_{n}", module) for n, module in enumerate(ANSWERS)]
    assert sorted(named) == sorted(expected)
