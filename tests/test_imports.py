"""What an import costs: nothing is compiled, and no engine, table or plot is loaded."""

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

HEAVY = ("scipy.integrate", "pandas", "matplotlib", "pybullet", "mujoco")
ROOT = Path(__file__).parents[1]
PACKAGES = ("analytic", "engines", "studies")
SOON = ("cyclopts", "numpy", "numba", "pandas", "fcntl")


def loaded_by(statement):
    code = f"{statement}; import sys; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_importing_the_reference_compiles_nothing():
    code = (
        "import analytic, sys, types\n"
        "kernels = [f for name, m in list(sys.modules.items()) if name.startswith('analytic')\n"
        "           for f in vars(m).values() if hasattr(f, 'signatures')]\n"
        "assert len(kernels) > 10\n"
        "print(sum(len(kernel.signatures) for kernel in kernels))"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "0"


@pytest.mark.parametrize("module", ["analytic", "engines", "studies", "studies.__main__"])
def test_imports_are_light(module):
    assert not loaded_by(f"import {module}") & set(HEAVY)


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
