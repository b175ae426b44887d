"""What an import costs: nothing is compiled, and no engine, table or plot is loaded."""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

from studies.__main__ import COMMANDS

HEAVY = ("numba", "scipy.integrate", "pandas", "matplotlib", "pybullet", "mujoco")
ROOT = Path(__file__).parents[1]
PACKAGES = ("analytic", "engines", "studies")
SOON = ("cyclopts", "numpy", "numba", "pandas", "fcntl")


def loaded_by(statement):
    code = f"{statement}; import sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


@pytest.mark.parametrize("module", ["analytic", "engines", "studies", "studies.__main__"])
def test_imports_are_light(module):
    assert not loaded_by(f"import {module}") & set(HEAVY)


SCIENCE = "numba llvmlite scipy matplotlib pandas.core asyncio heyoka distributed"
LIBRARIES = "pybullet mujoco pymunk Box2D dartpy rapier3d pydrake warp sapien"
EACH = (*SCIENCE.split(), *LIBRARIES.split())
"""What no answer at once may load."""

ONE = "compare --width 0.5 --height 1.5 --amplitude 0.4 --omega 6.2832 --json --sources"


def told_by(*arguments):
    """Return what a command loads in its own process."""
    code = (
        "import sys, json; from studies.__main__ import run; run(sys.argv[1:]);"
        "print(); print(json.dumps([*sys.modules]))"
    )
    asked = [sys.executable, "-c", code, *arguments]
    done = subprocess.run(asked, capture_output=True, text=True, check=True)
    return set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize(
    "arguments",
    [
        ["--help"],
        [*ONE.split(), "exact", "housner", "modified"],
        [*ONE.split(), "exact", "mujoco:fixed"],
    ],
    ids=["help", "models", "engine"],
)
def test_an_answer_at_once_loads_nothing_that_it_does_not_need(arguments):
    """An engine's library is loaded in a process of the engine's own."""
    assert not told_by(*arguments) & set(EACH)


@pytest.mark.parametrize("command", [study.name for study in COMMANDS])
def test_help_loads_no_table_and_no_plot(command):
    assert not told_by(command, "--help") & set(EACH)


def test_a_run_of_an_engine_loads_its_library_alone():
    statement = (
        "from analytic import RigidBlock, SinePulse; from studies import respond;"
        "block, pulse = RigidBlock(width=0.5, height=1.5), SinePulse(amplitude=3.9, omega=6.3);"
        "assert respond('mujoco', block, pulse).steps > 100"
    )
    assert loaded_by(statement) & set(EACH) == {"mujoco"}


def test_nothing_is_loaded_before_signals_are_dealt_with():
    assert not loaded_by("import studies.__main__") & set(SOON)


FORBIDDEN = {
    "studies asks, engines simulates, analytic knows": ("analytic/block.py", "import engines"),
    "an adapter never sees the answer": ("engines/run/drive.py", "from analytic import simulate"),
    "the mathematics knows no engine, table or plot": ("analytic/maps.py", "import pandas"),
    "kernels know none of the friendly modules above them": (
        "analytic/kernels/taylor.py",
        "import analytic.block",
    ),
    "the floors of studies, and studies that do not know one another": (
        "studies/contact/report.py",
        "import studies.validity.report",
    ),
    "no study opens an engine's folder": (
        "studies/validity/study.py",
        "import engines.mujoco.settings",
    ),
    "no engine knows another": ("engines/dart/build.py", "import engines.rapier.settings"),
    "no package imports in a circle": (
        "studies/measures/words.py",
        "import studies.sweep.claims",
    ),
}
"""Contract -> a module, and an import that the contract forbids there."""


def test_every_contract_is_broken_by_what_it_forbids(tmp_path):
    for name in PACKAGES:
        ignored = shutil.ignore_patterns("__pycache__", "published")
        shutil.copytree(ROOT / name, tmp_path / name, ignore=ignored)
    settings = shutil.copy(ROOT / "pyproject.toml", tmp_path)
    assert Path(settings).read_text().count("[[tool.importlinter.contracts]]") == len(FORBIDDEN)
    for place, statement in FORBIDDEN.values():
        file = tmp_path / place
        file.write_text(f"{file.read_text()}\n{statement}\n")
    linter = "from importlinter.cli import lint_imports_command as lint; lint()"
    done = subprocess.run(
        [sys.executable, "-c", linter, "--no-cache"], cwd=tmp_path, capture_output=True, text=True
    )
    assert done.returncode == 1
    for contract in FORBIDDEN:
        assert f"{contract} BROKEN" in " ".join(done.stdout.split())
