"""What an import costs: nothing is compiled, and no engine, table or plot is loaded."""

import subprocess
import sys

import pytest

HEAVY = ("scipy.integrate", "pandas", "matplotlib", "pybullet", "mujoco")
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
