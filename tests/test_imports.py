"""What an import costs: nothing is compiled, and no engine, table or plot is loaded."""

import subprocess
import sys

import pytest

from analytic.kernels.compiled import forget_what_changed

HEAVY = ("scipy.integrate", "pandas", "matplotlib", "pybullet", "mujoco")


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


def test_the_command_line_starts_without_the_reference():
    assert "numba" not in loaded_by("import studies.__main__")


def test_compiled_kernels_are_forgotten_when_a_module_changes(tmp_path):
    module, cache = tmp_path / "module.py", tmp_path / "__pycache__"
    cache.mkdir()
    module.write_text("a = 1")
    for name in ("module.f-1.py311.nbi", "module.f-1.py311.1.nbc", "module.cpython-311.pyc"):
        (cache / name).touch()
    forget_what_changed(tmp_path)
    assert {path.name for path in cache.iterdir()} == {"kernels.txt", "module.cpython-311.pyc"}
    (cache / "module.f-1.py311.nbi").touch()
    forget_what_changed(tmp_path)
    assert (cache / "module.f-1.py311.nbi").exists()
    module.write_text("a = 2")
    forget_what_changed(tmp_path)
    assert not (cache / "module.f-1.py311.nbi").exists()
